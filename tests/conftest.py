"""What holds for every test: the tree's own source, one thread a process, and the same examples
every time.
"""

import gc
import os
import subprocess
import sys
from collections import Counter
from functools import partial
from pathlib import Path

# What is imported until the tests begin is no garbage: see `pytest_collection_finish`.
gc.disable()

ROOT = Path(__file__).resolve().parent.parent

# Flags of a make that runs the tests are not meant for the makes that tests start.
for name in ("MAKEFLAGS", "MAKEOVERRIDES", "MFLAGS", "ARGS"):
    os.environ.pop(name, None)

# Before numpy and numba are imported, which read these once. Processes that tests start inherit
# them.
for library in ("OMP", "OPENBLAS", "MKL", "NUMBA"):
    os.environ[f"{library}_NUM_THREADS"] = "1"

# A copy of the tree tests its own source, whatever the environment's path file says; so do the
# processes that tests start.
SOURCE = str(ROOT / "src")
sys.path[:0] = [SOURCE, str(ROOT / "docs")]
os.environ["PYTHONPATH"] = os.pathsep.join([SOURCE, *filter(None, [os.environ.get("PYTHONPATH")])])

from bezierplan.places import choose_machine_code  # noqa: E402

choose_machine_code()

import pytest  # noqa: E402
from hypothesis import configuration, settings  # noqa: E402

from bezierplan.analysis import study_code  # noqa: E402

# Tests of metrics need those of the papers, without their studies.
study_code.load_functions(
    f"bezierplan.papers.{file.parent.name}.metrics"
    for file in (ROOT / "src/bezierplan/papers").glob("*/metrics.py")
)

# No deadline: the first call of a compiled kernel takes longer than the usual 200 ms. Derandomized:
# a failure shows itself to everybody. Of the same examples every time, fifty say what hundreds do.
settings.register_profile(
    "bezierplan", deadline=None, derandomize=True, database=None, max_examples=50
)
settings.load_profile("bezierplan")
configuration.set_hypothesis_home_dir(ROOT / ".cache" / "hypothesis")

# Files that take longest, in that order: at the end, no process has a long file to itself while the
# others have nothing left.
LONGEST = (
    "test_verify.py",
    "test_workflow.py",
    "test_docs_site.py",
    "test_study_faults.py",
    "test_wheel.py",
    "test_cluster.py",
    "test_readme.py",
    "test_page_browser.py",
    "test_own_study.py",
    "test_contract.py",
    "test_truth.py",
    "test_planner_module.py",
    "test_claims_each_way.py",
    "test_claims.py",
    "test_forks.py",
    "test_sixth_paper.py",
    "test_figures.py",
    "test_module.py",
    "test_moving_studies.py",
    "test_bounds.py",
    "test_exact_properties.py",
    "test_archive.py",
)


@pytest.fixture
def planners_are_read_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files of planners are read without a process of their own first, which takes a second each;
    `test_guard` and `test_truth` have those.
    """
    from bezierplan.running.guard import interface, process

    answers = process.run_function

    def of_file_here(work: partial, *others: object) -> list:
        if work.func is interface.describe_in_process:
            return [*work(str)]
        return answers(work, *others)

    monkeypatch.setattr(process, "run_function", of_file_here)


@pytest.fixture
def workflows_are_forks(monkeypatch: pytest.MonkeyPatch) -> None:
    """The workflow that `verify` starts is one of `starts.snakemake`."""
    import starts

    run = subprocess.run

    def start(words: list, **options: object) -> subprocess.CompletedProcess:
        if words[1:3] != ["-m", "snakemake"]:
            return run(words, **options)
        return starts.snakemake(Path.cwd(), *words[3:])

    monkeypatch.setattr(subprocess, "run", start)


def pytest_xdist_auto_num_workers() -> int:
    """One process more than cores, for some tests wait most of the time: for Slurm, or for a
    process that was killed.
    """
    return (os.cpu_count() or 1) + 1


def pytest_collection_modifyitems(items: list) -> None:
    """The longest files first, the others in their order."""
    places = {name: place for place, name in enumerate(LONGEST)}
    items.sort(key=lambda item: places.get(item.path.name, len(LONGEST)))


def pytest_collection_finish() -> None:
    """What tests import is no garbage, and few of them leave any: to look for it as often as Python
    does takes a seventh of the time.
    """
    gc.freeze()
    gc.set_threshold(10_000, 20, 50)
    gc.enable()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Tests that are skipped for one reason are one line."""
    skipped = terminalreporter.stats.get("skipped", [])
    for reason, count in Counter(report.longrepr[2] for report in skipped).items():
        terminalreporter.write_line(f"{count} tests: {reason}")
