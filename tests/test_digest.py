"""Digests of code: what counts and what does not."""

import shutil
from pathlib import Path

import pytest
import starts

from bezierplan.machine import digest as digests

SOURCE = Path(__file__).parents[1] / "src"
SYNTAX = Path(__file__).parents[1] / ".cache" / "syntax"
ASK = "from bezierplan.machine.digest import source_digest; print(source_digest(*{modules!r}))"


@pytest.fixture
def tree(tmp_path):
    # As in a clone, so that caches lie beside it; to parse all modules takes longest.
    (tmp_path / "config" / "studies").mkdir(parents=True)
    if SYNTAX.exists():
        shutil.copytree(SYNTAX, tmp_path / ".cache" / "syntax")
    return Path(
        shutil.copytree(SOURCE, tmp_path / "src", ignore=shutil.ignore_patterns("__pycache__"))
    )


def digest(tree, *modules):
    return starts.python(ASK.format(modules=modules), tree, tree)


def append(file, text):
    file.write_text(file.read_text() + text)


def test_comment_and_layout_do_not_count(tree):
    before = digest(tree, "bezierplan.running.execution")
    append(tree / "bezierplan" / "running" / "execution.py", "\n\n# a comment\n")
    assert digest(tree, "bezierplan.running.execution") == before


def test_docstrings_do_not_count(tree):
    before = digest(tree, "bezierplan.running.execution")
    file = tree / "bezierplan" / "running" / "execution.py"
    text = file.read_text()
    assert '    """One row of the runs table' in text
    file.write_text(
        '"""New words.'
        + text.removeprefix('"""').replace('    """One row', '    """New words. One row')
    )
    assert digest(tree, "bezierplan.running.execution") == before


def test_code_of_a_module_that_is_imported_by_way_of_others_counts(tree):
    before = (
        digest(tree, "bezierplan.running.execution"),
        digest(tree, "bezierplan.analysis.statistics"),
    )
    append(tree / "bezierplan" / "workspaces" / "grid.py", "\nNEW = 1\n")
    assert digest(tree, "bezierplan.running.execution") != before[0]
    assert digest(tree, "bezierplan.analysis.statistics") == before[1]


def test_package_above_a_module_counts(tree):
    before = digest(tree, "bezierplan.planners.parts.genetic")
    append(tree / "bezierplan" / "planners" / "parts" / "__init__.py", "\nNEW = 1\n")
    assert digest(tree, "bezierplan.planners.parts.genetic") != before


def test_planner_is_named_to_it(tree):
    before = digest(tree, "bezierplan.running.execution")
    append(tree / "bezierplan" / "planners" / "binary_genetic.py", "\nNEW = 1\n")
    assert digest(tree, "bezierplan.running.execution") == before
    assert (
        digest(tree, "bezierplan.running.execution", "bezierplan.planners.binary_genetic") != before
    )


def test_own_planner_counts_with_what_it_imports(tree, tmp_path):
    planner = tmp_path / "mine.py"
    planner.write_text("from bezierplan.planners.parts import genetic\n")
    before = digest(tree, str(planner))
    append(tree / "bezierplan" / "planners" / "parts" / "genetic.py", "\nNEW = 1\n")
    after = digest(tree, str(planner))
    append(planner, "NEW = 1\n")
    assert len({before, after, digest(tree, str(planner))}) == 3


def test_modules_beside_an_own_planner_count(tree, tmp_path):
    planner = tmp_path / "mine.py"
    planner.write_text("import near\nfrom parts import step\n")
    (tmp_path / "parts").mkdir()
    files = [
        tmp_path / name
        for name in ("near.py", "parts/__init__.py", "parts/step.py", "parts/far.py")
    ]
    for file in files:
        file.write_text("")
    (tmp_path / "parts" / "step.py").write_text("from . import far\n")
    found = [digest(tree, str(planner))]
    for file in files:
        append(file, "# a comment\n")
        assert digest(tree, str(planner)) == found[-1]
        append(file, "NEW = 1\n")
        found.append(digest(tree, str(planner)))
    assert len(set(found)) == 5


def test_how_a_job_is_logged_does_not_count(tree):
    before = digest(tree, "bezierplan.running.execution")
    for name in ("running/jobs/log", "machine/digest", "machine/kernel_cache"):
        append(tree / "bezierplan" / f"{name}.py", "\nNEW = 1\n")
    assert digest(tree, "bezierplan.running.execution") == before


def test_syntax_that_was_kept_is_read_and_a_damaged_copy_is_made_anew(tree):
    module = "bezierplan.running.execution"
    shutil.rmtree(tree.parent / ".cache", ignore_errors=True)
    first = digest(tree, module)
    kept = sorted((tree.parent / ".cache" / "syntax").iterdir())
    contents = [file.read_bytes() for file in kept]
    for k, file in enumerate(kept):
        file.write_bytes(contents[k][: (k % 3) * 40])
    assert digest(tree, module) == first
    assert [file.read_bytes() for file in kept] == contents
    for file in kept:
        file.write_text('["another tree", []]')
    assert digest(tree, module) != first


KERNELS = """
import numpy as np
from bezierplan.planners.parts import genetic
genetic.complement_bit(np.arange(4), 5, 3)
stats = genetic.complement_bit.stats
print(sum(stats.cache_hits.values()), stats.cache_path)
"""


def kernel(tree):
    """Whether a kernel was found compiled, and the folder that it is kept in."""
    hits, folder = starts.python(KERNELS, tree, tree).split()
    return int(hits), folder


def test_a_kernel_outlives_an_edit_that_cannot_change_it(tree):
    first, folder = kernel(tree)
    assert (first, Path(folder).parent) == (0, tree.parent / ".cache" / "kernels")
    file = tree / "bezierplan" / "planners" / "parts" / "genetic.py"
    file.write_text("# a comment that moves all lines\n" + file.read_text())
    append(tree / "bezierplan" / "running" / "execution.py", "\nNEW = 1\n")
    assert kernel(tree) == (1, folder)
    append(file, "\nNEW = 1\n")
    again, other = kernel(tree)
    assert again == 0
    assert other != folder


def test_a_kernel_outlives_a_move(tree, tmp_path_factory):
    hits, folder = kernel(tree)
    assert hits == 0
    moved = shutil.copytree(tree.parent, tmp_path_factory.mktemp("moved") / "tree")
    assert kernel(moved / "src") == (1, str(moved / ".cache" / "kernels" / Path(folder).name))


def test_versions_of_the_libraries_that_compute_are_part_of_what_a_job_depends_on(monkeypatch):
    """A straight line needs no library of geometry, a table of runs needs pandas."""
    real = digests.library_version
    line, table = "bezierplan.planners.straight_line", "bezierplan.analysis.numbers.tables"
    before = {name: digests.versioned_digest(name) for name in (line, table)}
    monkeypatch.setattr(
        digests, "library_version", lambda name: "99" if name == "pandas" else real(name)
    )
    assert digests.versioned_digest(line) == before[line]
    assert digests.versioned_digest(table) != before[table]
    assert " pandas 99" in digests.versioned_digest(table)
    monkeypatch.setattr(
        digests, "library_version", lambda name: "99" if name == "numpy" else real(name)
    )
    assert digests.versioned_digest(line) != before[line]
    assert digests.versioned_digest(line).split()[0] == digests.source_digest(line)
