"""Numbers made here compared with docs/outcome: is this installation sound? `make verify-outcome`
makes the tables first.

These are the tables that are compared with published numbers: minutes, where the whole outcome
takes hours.
"""

import sys
from argparse import ArgumentParser

import pandas as pd

from bezierplan.analysis import verification
from bezierplan.commands import outcome
from bezierplan.places import TREE
from bezierplan.schema.checked import Fault
from bezierplan.study import reading, targets
from bezierplan.study.definition import Study

KEPT = TREE / outcome.KEPT / outcome.NUMBERS_FULL
RESULTS = outcome.FULL
SHOWN = 10
"""Numbers of which a failure tells."""


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print how many numbers agree; exit code 1 if any differs by more than chance. Raises
    FileNotFoundError without tables.
    """
    parser.add_argument(
        "--targets",
        action="store_true",
        help="print the tables to be made first, as targets of snakemake",
    )
    given = parser.parse_args(words)
    studies = reading.load(reading.read_config({}))
    if given.targets:
        print(" ".join(f"{key}_{table}" for key, table in targets.published_tables(studies)))
        return
    found = verified(studies)
    told = verification.failed(found)
    print("\n".join(lines(found, told)))
    sys.exit(1 if len(told) else 0)


def verified(studies: dict[str, Study]) -> pd.DataFrame:
    """The numbers of all tables, made here and kept (`verification.compared`). Raises
    FileNotFoundError, and Fault if none are alike.
    """
    kept = verification.with_width(pd.read_csv(KEPT))
    compared = []
    for key, table in targets.published_tables(studies):
        file = RESULTS / key / "tables" / f"{table}.comparison.csv"
        if not file.is_file():
            raise FileNotFoundError(f"{file}: not there; make verify-outcome makes it")
        own = verification.with_width(pd.read_csv(file))
        pair = verification.compared(kept[(kept["study"] == key) & (kept["table"] == table)], own)
        if pair.empty:
            raise Fault(f"{file}: none of its numbers is kept in {KEPT.relative_to(TREE)}")
        names = pair[list(own.columns[: own.columns.get_loc("statistic") + 1])].itertuples(
            index=False
        )
        pair["number"] = [f"{key}/{table}/{'/'.join(name)}" for name in names]
        compared.append(pair[["number", "value_kept", "value_own", "p"]])
    numbers = (
        pd.concat(compared, ignore_index=True)
        if compared
        else pd.DataFrame(columns=["number", "p"])
    )
    if numbers["p"].notna().sum() == 0:
        raise Fault(
            f"{RESULTS}: no number of {KEPT.relative_to(TREE)} is here; expected tables of the "
            "configured studies"
        )
    return numbers


def lines(found: pd.DataFrame, failed: pd.DataFrame) -> list[str]:
    """The outcome of the verification, one line each."""
    tested = found[found["p"].notna()]
    equal = int((tested["value_kept"] == tested["value_own"]).sum())
    told = [
        f"{len(tested)} numbers compared, {equal} equal, "
        f"{len(failed)} different by more than chance"
    ]
    if failed.empty:
        return [
            *told,
            "sound: a sound installation fails with a probability of at most "
            f"{verification.ERROR_RATE:.0%}",
        ]
    for row in failed.head(SHOWN).itertuples():
        told.append(
            f"  {row.number}: {row.value_own:.6g} here, {row.value_kept:.6g} kept, p = {row.p:.2g}"
        )
    return [
        *told,
        "not sound: chance alone does this with a probability of at most "
        f"{verification.ERROR_RATE:.0%}",
    ]
