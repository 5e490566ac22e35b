"""Judge results again from their own points: `python -m bezierplan verify results/full`; with
`--outcome`, compare their numbers with docs/outcome.
"""

import sys
from argparse import ArgumentParser
from pathlib import Path

import pandas as pd

from bezierplan.analysis import verification
from bezierplan.commands import cores
from bezierplan.places import TREE

OUTCOME = TREE / "docs" / "outcome" / "numbers_papers_size.csv"
SHOWN = 10
"""Numbers of which a failure tells."""


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print a line for each stored value that differs from what is computed again, and what was
    checked.

    Ends with status 1 if anything differs. Raises ValueError or FileNotFoundError for a folder
    without results or a file that cannot be read.
    """
    parser.add_argument("folder", type=Path, help="the folder of a scale, such as results/full")
    parser.add_argument(
        "--cores", type=int, default=cores(), metavar="N", help="processes (default: all cores)"
    )
    parser.add_argument(
        "--outcome",
        action="store_true",
        help="only compare numbers of scale full with docs/outcome: is this installation sound?",
    )
    arguments = parser.parse_args(words)
    if arguments.cores < 1:
        raise ValueError(f"--cores: {arguments.cores}; expected a number of at least 1")
    if arguments.outcome:
        lines, sound = against_outcome(arguments.folder)
    else:
        lines, sound = from_points(arguments.folder, arguments.cores)
    print("\n".join(map(str, lines)))
    if not sound:
        sys.exit(1)


def from_points(folder: Path, processes: int) -> tuple[list[str], bool]:
    """What is to be said of results that are judged again, and whether they are sound."""
    from bezierplan.running import recheck

    def progress(line: str) -> None:
        print(line, file=sys.stderr, flush=True)

    verdict = recheck.verify(recheck.tasks(folder), processes, progress)
    lines = [
        *verdict.faults,
        f"{verdict.runs} runs in {verdict.files} files: {verdict.paths} different paths judged "
        f"again, {verdict.bounds} bounds computed again",
    ]
    if verdict.undigested:
        lines.append(
            f"{verdict.undigested} files hold no digest of their rows, so what no path determines "
            "is not checked in them"
        )
    versions = (f"{name} {version}" for name, version in recheck.versions().items())
    lines.append(f"digest {verdict.digest}; {', '.join(versions)}")
    lines.append(f"{len(verdict.faults)} values differ" if verdict.faults else "sound")
    return lines, not verdict.faults


def against_outcome(folder: Path) -> tuple[list[str], bool]:
    """What is to be said of numbers beside those of docs/outcome, and whether they are sound.
    Raises FileNotFoundError for a table that is not there.
    """
    outcome = pd.read_csv(OUTCOME)
    pairs = []
    for (study, table), rows in outcome.groupby(["study", "table"], sort=False):
        file = folder / study / "tables" / f"{table}.comparison.csv"
        if not file.is_file():
            raise FileNotFoundError(f"{file}: not there; make verify-outcome makes it")
        own = pd.read_csv(file)
        pair = verification.compared(rows, own)
        names = pair[list(own.columns[: own.columns.get_loc("statistic") + 1])]
        pair["number"] = [f"{study}/{table}/{'/'.join(map(str, name))}" for name in names.values]
        pairs.append(pair[["number", "value_kept", "value_own", "p"]])
    numbers = pd.concat(pairs, ignore_index=True)
    tested, failed = numbers[numbers["p"].notna()], verification.failed(numbers)
    equal = int((tested["value_kept"] == tested["value_own"]).sum())
    lines = [
        f"{len(tested)} numbers compared, {equal} equal, "
        f"{len(failed)} different by more than chance",
        *(
            f"  {row.number}: {row.value_own:.6g} here, {row.value_kept:.6g} in docs/outcome, "
            f"p = {row.p:.2g}"
            for row in failed.head(SHOWN).itertuples()
        ),
    ]
    rate = f"with a probability of at most {verification.ERROR_RATE:.0%}"
    if len(tested) and failed.empty:
        return [*lines, f"sound: a sound installation fails {rate}"], True
    return [*lines, f"not sound: chance alone does this {rate}"], False
