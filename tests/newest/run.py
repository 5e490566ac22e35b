"""Does a newer library change a bit? Makes the smoke subset with the locked and with the newest
versions, and says which one changes what.

    python tests/newest/run.py [FLAG ...]

FLAG: flags of `make lock` (default: --upgrade), such as `--upgrade-package numpy==2.4.0`. All work
is done in copies of the tree in .cache/newest, so neither the locks nor the environment of the tree
change. Exits with 1 if anything differs or a test fails.
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLACE = ROOT / ".cache" / "newest"
# Copies of the tree: with the locked versions, with the new ones, with some of these.
LOCKED, NEWEST, SOME = (PLACE / name for name in ("locked", "newest", "some"))
SMOKE, KERNELS = "results/smoke", ".cache/kernels"
# A compiled kernel depends on these alone.
COMPILERS = {"llvmlite", "numba", "numpy"}
# What the workflow and its tests run on; the other locks are those of environments of their own.
LOCKS = ("environment-build.txt", "environment.txt", "environment-dev.txt")
# What a copy does without at the top of the tree. It has what git keeps, for the test of the
# archive asks git.
LEFT_OUT = {".venv", ".cache", ".snakemake", "archive"}
# Flags of the make that runs this are not meant for the makes that this starts.
ENVIRONMENT = {
    name: value
    for name, value in os.environ.items()
    if name not in ("MAKEFLAGS", "MAKEOVERRIDES", "MFLAGS", "ARGS")
}
# Files that a line names.
SHOWN = 10

Moved = dict[str, tuple[str, str]]
"""The old and the new version of each library that moved."""
Digests = dict[tuple[str, str], str]
"""Hashes of results by kind and name."""


def pins(lock: str) -> dict[str, str]:
    """The version of each library in the text of a lock; of one that differs from Python to Python
    all versions, joined by `or`.
    """
    found: dict[str, str] = {}
    for name, version in re.findall(r"^([\w.-]+)==([^\s;]+)", lock, flags=re.M):
        found[name] = f"{found[name]} or {version}" if name in found else version
    return found


def moved(old: dict[str, str], new: dict[str, str]) -> Moved:
    """What differs between two locks' pins."""
    both = {
        name: (old.get(name, "none"), new.get(name, "none"))
        for name in sorted(old.keys() | new.keys())
    }
    return {name: versions for name, versions in both.items() if versions[0] != versions[1]}


def in_words(libraries: Moved) -> str:
    """Moved libraries in one line."""
    return ", ".join(f"{name} {old} -> {new}" for name, (old, new) in libraries.items())


def flags(libraries: Moved) -> list[str]:
    """What has `make lock` move these libraries to their new versions, and with them only what they
    need.
    """
    return [
        f"--upgrade-package={name}" + ("" if " " in new else f"=={new}")
        for name, (_, new) in libraries.items()
        if new != "none"
    ]


def digests(results: Path) -> Digests:
    """The digest of each run table, and a hash of each csv: tables, data of figures, claims and
    summaries.
    """
    # A process of its own: this one waits for an hour, and should not hold libraries and their
    # threads for so long.
    command = [sys.executable, "-m", "bezierplan", "digest", str(results)]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = {("run tables", name): value for value, name in map(str.split, told.splitlines())}
    for file in sorted(results.rglob("*.csv")):
        kind = (
            file.parent.name
            if file.parent.name in ("tables", "figures")
            else "claims and summaries"
        )
        found[kind, str(file.relative_to(results))] = hashlib.sha256(file.read_bytes()).hexdigest()
    return found


def difference(locked: Digests, other: Digests) -> str:
    """How many digests of each kind differ, with their names; empty if none does."""
    told = []
    for kind in dict.fromkeys(kind for kind, _ in locked):
        names = [name for each, name in locked if each == kind]
        differ = [name for name in names if other.get((kind, name)) != locked[kind, name]]
        if differ:
            more = f" and {len(differ) - SHOWN} more" if len(differ) > SHOWN else ""
            told.append(
                f"{len(differ)} of {len(names)} {kind} differ: {', '.join(differ[:SHOWN])}{more}"
            )
    return "; ".join(told)


def culprits(
    libraries: Sequence[str], differs: Callable[[tuple[str, ...]], object]
) -> list[tuple[str, ...]]:
    """The smallest groups of libraries that change something, found by halves; of a group of
    several, no half does so alone.
    """
    middle = len(libraries) // 2
    halves = [tuple(half) for half in (libraries[:middle], libraries[middle:]) if half]
    found = [half for half in halves if differs(half)] if len(halves) == 2 else []
    return [group for half in found for group in culprits(half, differs)] or [tuple(libraries)]


def left_out(folder: str, names: list[str]) -> list[str]:
    """What a copy of the tree does without: everything that was made in it."""
    if Path(folder) == ROOT / "results":
        return [name for name in names if name != "README.md"]
    return [
        name
        for name in names
        if name == "__pycache__" or (Path(folder) == ROOT and name in LEFT_OUT)
    ]


def copy(folder: Path) -> None:
    """Copy the tree. Its environment is ours until its locks change: then make removes the link and
    sets up another.
    """
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(ROOT, folder, ignore=left_out)
    (folder / ".venv").symlink_to(ROOT / ".venv")


def run(folder: Path, *command: str) -> str:
    """Run a command in a copy of the tree; what it says goes to a log in the copy. Returns why it
    failed, empty if it did not.
    """
    log = folder / "newest.log"
    with log.open("a", encoding="utf-8") as file:
        streams = {"stdin": subprocess.DEVNULL, "stdout": file, "stderr": subprocess.STDOUT}
        done = subprocess.run(command, cwd=folder, env=ENVIRONMENT, check=False, **streams)
    if done.returncode == 0:
        return ""
    return "\n  ".join(
        [
            f"failed: {' '.join(command)} ({log.relative_to(ROOT)})",
            *reasons(log.read_text(errors="replace")),
        ]
    )


def reasons(log: str) -> list[str]:
    """The lines of a log that say why a command failed: those of pytest or pip, or the last one
    before make's own.
    """
    lines = [line for line in log.splitlines() if line.strip() and not line.startswith("make")]
    return [line for line in lines if line.startswith(("FAILED ", "ERROR"))] or lines[-1:]


def renew(folder: Path, given: list[str]) -> Moved:
    """Copy the tree, renew the copy's locks, and say what moved; ends with one line if they cannot
    be renewed.
    """
    copy(folder)
    if failed := run(folder, "make", "lock", f"ARGS={' '.join(given)}"):
        sys.exit(failed)
    old, new = (
        pins("".join((tree / lock).read_text(encoding="utf-8") for lock in LOCKS))
        for tree in (ROOT, folder)
    )
    return moved(old, new)


def smoke(folder: Path, libraries: Moved) -> str:
    """Make the smoke subset in a copy; returns why it failed. CPU times never repeat, so copies
    share those of the locked versions.
    """
    kernels = next((tree / KERNELS for tree in (LOCKED, ROOT) if (tree / KERNELS).exists()), None)
    if kernels and not COMPILERS & libraries.keys():
        shutil.copytree(kernels, folder / KERNELS)
    failed = run(folder, "make", ".venv/ready-dev", f"PYTHON={Path(sys.executable).resolve()}")
    if libraries and not failed:
        failed = run(
            folder, ".venv/bin/python", "-m", "snakemake", "smoke", "--until", "runs", "drives"
        )
        for file in (folder / SMOKE).rglob("*.times.parquet"):
            shutil.copyfile(LOCKED / file.relative_to(folder), file)
    return failed or run(folder, "make", "smoke")


def say(*lines: str) -> None:
    """Print lines at once, for those who watch."""
    print(*lines, sep="\n", flush=True)


def main(given: list[str]) -> int:
    """Compare, test, and look for culprits; returns the exit status."""
    shutil.rmtree(PLACE, ignore_errors=True)
    libraries = renew(NEWEST, given)
    say(
        f"{len(libraries)} libraries have moved",
        *(f"  {in_words({name: libraries[name]})}" for name in libraries),
    )
    if not libraries:
        return 0
    say("the smoke subset with the locked versions")
    copy(LOCKED)
    if failed := smoke(LOCKED, {}):
        sys.exit(failed)
    expected = digests(LOCKED / SMOKE)

    def changed(folder: Path, some: Moved) -> str:
        return smoke(folder, some) or difference(expected, digests(folder / SMOKE))

    @cache
    def alone(names: tuple[str, ...]) -> tuple[Moved, str]:
        say(f"the smoke subset with new {', '.join(names)}")
        some = renew(SOME, flags({name: libraries[name] for name in names}))
        return some, changed(SOME, some) if some else ""

    say("the smoke subset with the new versions")
    found = changed(NEWEST, libraries)
    say(
        found
        or f"the same bits in all {len(expected)} run tables, "
        "tables, data of figures, claims and summaries"
    )
    say("the tests with the new versions")
    failed = run(NEWEST, ".venv/bin/python", "-m", "pytest", "-n", "auto", "--dist", "loadfile")
    say(failed or "all tests pass")
    for group in culprits(tuple(libraries), lambda names: alone(names)[1]) if found else []:
        some, words = alone(group) if len(group) < len(libraries) else (libraries, found)
        say(f"{in_words(some)}: {words}")
    return int(bool(found or failed))


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:] or ["--upgrade"]))
    except KeyboardInterrupt:
        sys.exit(130)
