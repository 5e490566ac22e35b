"""Does a newer library change a bit? Makes the smoke subset with the locked and with the newest
versions, compares their results, and runs the tests.

    python tests/newest/run.py [FLAG ...]

FLAG: flags of `make lock` (default: --upgrade), such as `--upgrade-package numpy==2.4.0`, by which
one library can be tried alone. All work is done in copies of the tree in .cache/newest. Exits with
1 if anything differs or a test fails.
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLACE = ROOT / ".cache" / "newest"
SMOKE = "results/smoke"
LOCKS = ("environment-build.txt", "environment.txt", "environment-dev.txt")
# What a copy does without at the top of the tree. It has what git keeps, for the test of the
# archive asks git.
LEFT_OUT = {".venv", ".cache", ".snakemake", "archive", "results"}
# Flags of the make that runs this are not meant for the makes that this starts.
MAKE = ("MAKEFLAGS", "MAKEOVERRIDES", "MFLAGS", "ARGS")


def pins(tree: Path) -> set[str]:
    """The versions in a tree's locks, such as `numpy==2.4.6`."""
    locks = "".join((tree / lock).read_text(encoding="utf-8") for lock in LOCKS)
    return set(re.findall(r"^[\w.-]+==[^\s;]+", locks, flags=re.MULTILINE))


def digests(results: Path) -> dict[str, str]:
    """The digest of each run table, and a hash of each csv: tables, data of figures, claims and
    summaries.
    """
    command = [sys.executable, "-m", "bezierplan", "digest", str(results)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = {name: value for value, name in map(str.split, printed.splitlines())}
    for file in sorted(results.rglob("*.csv")):
        content = hashlib.sha256(file.read_bytes()).hexdigest()
        found[str(file.relative_to(results))] = content
    return found


def copy(folder: Path) -> None:
    """Copy the tree without what was made in it."""

    def left_out(parent: str, names: list[str]) -> set[str]:
        top = LEFT_OUT if Path(parent) == ROOT else set()
        return {name for name in names if name == "__pycache__" or name in top}

    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(ROOT, folder, ignore=left_out)
    (folder / ".venv").symlink_to(ROOT / ".venv")  # ours until its locks change


def run(folder: Path, *command: str) -> None:
    """Run a command in a copy of the tree; ends with status 1 if it fails."""
    environment = {name: value for name, value in os.environ.items() if name not in MAKE}
    if subprocess.run(command, cwd=folder, env=environment, check=False).returncode:
        sys.exit(f"failed in {folder}: {' '.join(command)}")


def main(flags: list[str]) -> None:
    locked, newest = PLACE / "locked", PLACE / "newest"
    copy(newest)
    run(newest, "make", "lock", f"ARGS={' '.join(flags)}")
    moved = pins(newest) - pins(ROOT)
    print("libraries that have moved:", *sorted(moved), sep="\n  ", flush=True)
    if not moved:
        return
    copy(locked)
    run(locked, "make", "smoke")
    run(newest, "make", ".venv/ready-dev", f"PYTHON={Path(sys.executable).resolve()}")
    # CPU times never repeat, so both copies have those of the locked versions.
    run(newest, ".venv/bin/python", "-m", "snakemake", "smoke", "--until", "runs", "drives")
    for file in (newest / SMOKE).rglob("*.times.parquet"):
        shutil.copyfile(locked / file.relative_to(newest), file)
    run(newest, "make", "smoke")
    ours, theirs = digests(locked / SMOKE), digests(newest / SMOKE)
    differ = [name for name in ours if theirs.get(name) != ours[name]]
    print(f"{len(differ)} of {len(ours)} results differ", *differ, sep="\n  ", flush=True)
    run(newest, ".venv/bin/python", "-m", "pytest", "-n", "auto", "--dist", "loadfile")
    sys.exit(bool(differ))


if __name__ == "__main__":
    main(sys.argv[1:] or ["--upgrade"])
