"""Check every stored path and bound of a scale's results again, in fresh processes, or its numbers
with docs/outcome.
"""

import sys
from pathlib import Path

import pandas as pd

from bezierplan.analysis import verification
from bezierplan.commands import cores
from bezierplan.places import TREE
from bezierplan.running.inputs import tree

OUTCOME = TREE / "docs" / "outcome" / "numbers_papers_size.csv"
SHOWN = 10
"""Numbers of which a failure tells."""


def main(folder: Path, *, cores: int = cores(), outcome: bool = False) -> None:
    """Print a line for each stored value that differs from what is computed again, and what was
    checked.

    Ends with status 1 if anything differs. Raises ValueError or FileNotFoundError for a folder
    without results or a file that cannot be read.

    Parameters
    ----------
    folder : Path
        the folder of a scale, such as results/full
    cores : int
        processes (default: all cores)
    outcome : bool
        only compare numbers of scale full with docs/outcome: is this installation sound?

    Examples
    --------
    verify results/full --cores 2
    verify results/full --outcome
    """
    if cores < 1:
        raise ValueError(f"cores: {cores}; expected a number of at least 1")
    lines, sound = against_outcome(folder) if outcome else from_points(folder, cores)
    print("\n".join(map(str, lines)))
    if not sound:
        sys.exit(1)


def from_points(folder: Path, processes: int) -> tuple[list[str], bool]:
    """What is to be said of results that are judged again, and whether they are sound."""
    from bezierplan.running.judge import recheck

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
        file = folder / study / tree(table) / f"{table}.comparison.csv"
        if not file.is_file():
            raise FileNotFoundError(f"{file}: not there; make verify-outcome makes it")
        pair = verification.compared(rows, pd.read_csv(file))
        pairs.append(pair.assign(table=f"{study}/{table}"))
    numbers = pd.concat(pairs, ignore_index=True)
    tested, failed = numbers[numbers["p"].notna()], verification.failed(numbers)
    equal = int((tested["value_kept"] == tested["value_own"]).sum())
    lines = [
        f"{len(tested)} numbers compared, {equal} equal, "
        f"{len(failed)} different by more than chance"
    ]
    if len(failed):
        lines.append(failed.head(SHOWN).dropna(axis=1).to_string(index=False))
    rate = f"with a probability of at most {verification.ERROR_RATE:.0%}"
    if len(tested) and failed.empty:
        return [*lines, f"sound: a sound installation fails {rate}"], True
    return [*lines, f"not sound: chance alone does this {rate}"], False
