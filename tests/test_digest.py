"""Digests of code: what counts and what does not; edits of words and of modules, which `verify`
has to tell apart as well, are in `test_account`.
"""

import ast
import copy
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import starts

from bezierplan.machine import digest as digests

SOURCE = Path(__file__).parents[1] / "src"
SYNTAX = Path(__file__).parents[1] / ".cache" / "syntax"
GENETIC = "bezierplan/planners/parts/genetic.py"
ASK = """
from bezierplan.machine.digest import compute_source_digest

print(compute_source_digest(*{modules!r}))
"""


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


def test_package_above_a_module_counts(tree):
    before = digest(tree, "bezierplan.planners.parts.genetic")
    append((tree / GENETIC).with_name("__init__.py"), "\nNEW = 1\n")
    assert digest(tree, "bezierplan.planners.parts.genetic") != before


def test_own_planner_counts_with_what_it_imports_of_the_package_and_beside_it(tree, tmp_path):
    planner = tmp_path / "mine.py"
    planner.write_text(
        "import near\nfrom parts import step\nfrom bezierplan.planners.parts import genetic\n"
    )
    (tmp_path / "parts").mkdir()
    files = [
        tmp_path / name
        for name in ("near.py", "parts/__init__.py", "parts/step.py", "parts/far.py")
    ]
    for file in files:
        file.write_text("")
    (tmp_path / "parts" / "step.py").write_text("from . import far\n")
    found = [digest(tree, str(planner))]
    for file in (*files, planner, tree / GENETIC):
        append(file, "# a comment\n")
        assert digest(tree, str(planner)) == found[-1]
        append(file, "NEW = 1\n")
        found.append(digest(tree, str(planner)))
    assert len(set(found)) == 7


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
        file.write_text('["another tree", [], ""]')
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
    caches = {"XDG_CACHE_HOME": str(tree.parent / "caches")}
    hits, folder = starts.python(KERNELS, tree, tree, **caches).split()
    return int(hits), folder


def test_a_kernel_outlives_an_edit_that_cannot_change_it(tree):
    first, folder = kernel(tree)
    assert first == 0
    assert Path(folder).is_relative_to(tree.parent / "caches" / "bezierplan")
    file = tree / GENETIC
    file.write_text("# a comment that moves all lines\n" + file.read_text())
    append(tree / "bezierplan/running/execution.py", "\nNEW = 1\n")
    assert kernel(tree) == (1, folder)
    append(file, "\nNEW = 1\n")
    again, other = kernel(tree)
    assert again == 0
    assert other != folder


def test_a_kernel_outlives_a_move(tree, tmp_path_factory):
    hits, folder = kernel(tree)
    assert hits == 0
    moved = shutil.copytree(tree.parent, tmp_path_factory.mktemp("moved") / "tree")
    again, place = kernel(moved / "src")
    assert (again, Path(place).name) == (1, Path(folder).name)


def test_versions_of_the_libraries_that_compute_are_part_of_what_a_job_depends_on(monkeypatch):
    """A straight line needs no library of geometry, a table of runs needs pandas."""
    line, table = "bezierplan.planners.straight_line", "bezierplan.analysis.numbers.tables"
    before = {name: digests.describe_code((), name) for name in (line, table)}
    assert {"code", "numpy"} <= before[line].keys()
    assert "pandas" not in before[line]
    assert "pandas" in before[table]
    digests.describe_code.cache_clear()
    monkeypatch.setattr(digests, "find_library_version", lambda name: f"99 of {name}")
    after = digests.describe_code((), table)
    digests.describe_code.cache_clear()
    assert after["code"] == before[table]["code"]
    assert after["pandas"] == "99 of pandas"


# Every kind of statement, some with parts that a newer Python has; text that tokens divide anew.
WORDS = """
import a.b as c
from . import d

class E(F, g=1): pass
@h
async def i(j, /, k: int = 1, *l, m=None, **n) -> None:
    "Words."
    async with o() as p, q: pass
    async for r in s: await t
    else: pass
    return [u for v in w if x async for y in z]
def _(*, a): yield; yield from a; global b; nonlocal_ = lambda: (c := 1)
f"{d!r:>{e}} {{f}} {g=} {h:%Y}" 'i' f'{j["k"]}' u"l" "" f""; b"m" b""; f"{n:}"
match n:
    case [1, *_, o] | {"p": q, **r} | S(t=2) as u if v: pass
try: w
except* x as y: raise z from None
while 1_000 < 0x1F <= 1e3 != 1j: a[b:c, ::d] = ~e ** -f @ g // h << ...; del i; assert j, "k"
"""


# By Python 3.11.7, 3.12.1 and 3.13.0.
DIGEST_OF_WORDS = "d8e82f637de75f13"


def test_a_digest_is_the_same_on_every_python(tmp_path):
    """Of a file with all syntax, and of what runs a chunk, on all that are installed here. Where
    there is one alone, the digest that others gave stands in for them.
    """
    file = tmp_path / "syntax.py"
    file.write_text(WORDS)
    assert digests.compute_source_digest(str(file)) == DIGEST_OF_WORDS
    code = ASK.format(modules=(str(file), "bezierplan.running.execution"))
    others = [f"python3.{minor}" for minor in (11, 12, 13) if minor != sys.version_info.minor]
    # Programs that install several Pythons (pyenv, uv, conda) put them next to each other.
    beside = [
        str(file) for name in others for file in Path(sys.base_prefix).parent.glob(f"*/bin/{name}")
    ]
    found = {}
    for name in (sys.executable, *filter(shutil.which, others), *beside):
        answer = subprocess.run(
            [name, "-c", code],
            env={
                "PATH": os.environ["PATH"],
                "PYTHONPATH": str(SOURCE),
                "XDG_CACHE_HOME": str(tmp_path),
            },
            capture_output=True,
            text=True,
        )
        if answer.returncode == 0 or name == sys.executable:
            found[name] = answer.stdout
    assert len(set(found.values())) == 1


def test_fields_that_are_empty_do_not_count():
    """A newer Python has more of them, such as the parameters of types."""
    (function,) = ast.parse("def a(b): return b").body
    with_more = copy.copy(function)
    with_more._fields = (*function._fields, "newer", "newest")
    with_more.newer, with_more.newest = [], None
    assert digests._nest(with_more) == digests._nest(function)
    with_more.newer = [ast.Constant(None)]
    assert digests._nest(with_more) != digests._nest(function)
    (text,) = ast.parse("f'{a:>{b}}'").body
    ended = copy.deepcopy(text)
    ended.value.values[0].format_spec.values.append(ast.Constant(""))
    assert digests._nest(ended) == digests._nest(text)
