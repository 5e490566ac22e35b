"""Plants each fault of mutants.yaml in a copy of the tree, and runs the test that must catch it
there.

    python tests/mutants/run.py [--jobs N] [WORD ...]

WORD: only faults whose description, file or test contains one of the words. Exits with 1 unless
every fault is caught.
"""

import argparse
import multiprocessing
import os
import queue
import shutil
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import NamedTuple

import yaml

ROOT = Path(__file__).resolve().parents[2]
FILE = Path(__file__).with_name("mutants.yaml")
# Seconds after which a test is ended.
TIME_LIMIT = 300
# Where a copy of the tree keeps what pytest says.
WORDS = "pytest.txt"
FORKS = multiprocessing.get_context("forkserver")
# What takes long to import: processes begin with it.
MODULES = [
    "numba",
    "pandas",
    "pyarrow.parquet",
    "scipy.stats",
    "scipy.interpolate",
    "matplotlib.figure",
    "shapely",
]
# The status that multiprocessing gives a process whose true one another thread has read: a start
# polls the children of all threads.
LOST = 255
# What no test of a fault needs; compiled kernels are copied, because most of them do not change.
LEFT_OUT = shutil.ignore_patterns(".git", ".venv", ".snakemake", "results", "__pycache__")


class Mutant(NamedTuple):
    """A mutant: its description, the file, the text that it replaces and the new text, and
    the test that must catch it.
    """

    fault: str
    file: str
    old: str
    new: str
    test: str


def load() -> list[Mutant]:
    """All mutants of mutants.yaml, in its order."""
    return [Mutant(**each) for each in yaml.safe_load(FILE.read_text(encoding="utf-8"))]


def planted(mutant: Mutant, tree: Path = ROOT) -> str:
    """The text of a mutant's file in a tree with the fault in it. Raises ValueError unless the old
    text stands there exactly once.
    """
    text = (tree / mutant.file).read_text(encoding="utf-8")
    if text.count(mutant.old) != 1:
        raise ValueError(
            f"{mutant.fault}: "
            f"{mutant.file} has the old text {text.count(mutant.old)} times; expected once"
        )
    return text.replace(mutant.old, mutant.new)


def run_tests(tree: Path, tests: list[str], *options: str) -> int | None:
    """Exit status of pytest on tests in a tree, in a process of its own; None after `TIME_LIMIT`
    seconds a test. Its words go to a file.
    """
    process = FORKS.Process(target=_pytest, args=(tree, [*options, *tests]))
    process.start()
    process.join(TIME_LIMIT * len(tests))
    if process.exitcode is None:
        process.kill()
        process.join()
        return None
    return process.exitcode


def _pytest(tree: Path, arguments: list[str]) -> None:
    import pytest

    os.chdir(tree)
    # A file that changes twice within a second could be mistaken for its own byte code.
    sys.dont_write_bytecode = True
    with (tree / WORDS).open("w") as words, redirect_stdout(words), redirect_stderr(words):
        status = pytest.main(["-q", *arguments])
    sys.exit(int(status))


def failing(tree: Path, mutants: list[Mutant]) -> set[str]:
    """Tests of mutants that fail without a fault. Raises RuntimeError if pytest cannot run them at
    all.
    """
    status = run_tests(tree, sorted({each.test for each in mutants}), "--tb=no")
    words = (tree / WORDS).read_text()
    found = {
        line.split()[1].partition("[")[0]
        for line in words.splitlines()
        if line.startswith(("FAILED ", "ERROR tests"))
    }
    if status and not found:
        raise RuntimeError(words)
    return found


def outcome(mutant: Mutant, trees: queue.Queue) -> str:
    """`caught`, `survived`, or why the test could not be run, with the fault planted in one of the
    trees.
    """
    tree = trees.get()
    file = tree / mutant.file
    clean = file.read_text(encoding="utf-8")
    try:
        file.write_text(planted(mutant, tree), encoding="utf-8")
        # A search that a fault makes endless is noticed as well.
        status = run_tests(tree, [mutant.test], "-x")
        if status == LOST:
            status = run_tests(tree, [mutant.test], "-x")
        return {0: "survived", 1: "caught", None: "caught"}.get(status, f"pytest: {status}")
    finally:
        file.write_text(clean, encoding="utf-8")
        trees.put(tree)


def main() -> int:
    """Run the mutants that the command line selects; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--jobs",
        type=int,
        default=os.cpu_count(),
        help="how many run at a time (default: one a core)",
    )
    parser.add_argument(
        "words",
        nargs="*",
        metavar="WORD",
        help="only faults whose description, file or test contains a word",
    )
    arguments = parser.parse_args()
    os.environ.update(
        dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
    )
    FORKS.set_forkserver_preload(MODULES)
    wanted = [
        each
        for each in load()
        if not arguments.words or any(word in " ".join(each) for word in arguments.words)
    ]
    with tempfile.TemporaryDirectory() as folder:
        trees: queue.Queue = queue.Queue()
        for number in range(max(1, min(arguments.jobs, len(wanted)))):
            trees.put(Path(shutil.copytree(ROOT, Path(folder) / str(number), ignore=LEFT_OUT)))
        broken = failing(trees.queue[0], wanted)

        def timed(mutant: Mutant) -> str:
            begin = time.perf_counter()
            found = "fails without it" if mutant.test in broken else outcome(mutant, trees)
            print(f"{found:10s}{time.perf_counter() - begin:6.0f} s  {mutant.fault}", flush=True)
            return found

        with ThreadPoolExecutor(max(1, arguments.jobs)) as pool:
            found = list(pool.map(timed, wanted))
    print(f"{found.count('caught')} of {len(found)} mutants caught")
    return int(found.count("caught") < len(found))


if __name__ == "__main__":
    sys.exit(main())
