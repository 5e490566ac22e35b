"""Judge results again from their own points: `python -m bezierplan verify results/full`."""

import sys
from argparse import ArgumentParser
from pathlib import Path

from bezierplan.commands import cores


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print a line for each stored value that differs from what is computed again, and what was
    checked.

    Ends with status 1 if anything differs. Raises ValueError or FileNotFoundError for a folder
    without results or a file that cannot be read.
    """
    from bezierplan.running import recheck

    parser.add_argument("folder", type=Path, help="the folder of a scale, such as results/full")
    parser.add_argument(
        "--cores",
        type=int,
        default=cores(),
        metavar="N",
        help="processes (default: all cores)",
    )
    given = parser.parse_args(words)
    if given.cores < 1:
        raise ValueError(f"--cores: {given.cores}; expected a number of at least 1")
    verdict = recheck.verify(
        recheck.tasks(given.folder),
        given.cores,
        lambda line: print(line, file=sys.stderr, flush=True),
    )
    for fault in verdict.faults:
        print(fault)
    judged = f"{verdict.paths} different paths judged again, {verdict.bounds} bounds computed again"
    print(f"{verdict.runs} runs in {verdict.files} files: {judged}")
    if verdict.undigested:
        print(
            f"{verdict.undigested} files hold no digest of their rows, so what no path determines "
            "is not checked in them"
        )
    print(
        f"digest {verdict.digest}; "
        + ", ".join(f"{name} {version}" for name, version in recheck.versions().items())
    )
    print("sound" if not verdict.faults else f"{len(verdict.faults)} values differ")
    if verdict.faults:
        sys.exit(1)
