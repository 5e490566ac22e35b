"""Is an installation sound? Its numbers beside those of the kept outcome, by a test that a sound
one fails with a stated probability.

On the platform of the kept outcome the numbers are equal. On another the last bit of a library's
`sin` can differ, a search amplifies it, and a number is that of other runs of the same
distribution. Then two estimates differ by chance: each has a bootstrap interval, from which its
standard error follows, and Student's t with the degrees of freedom of the smaller sample judges
their difference. Bonferroni's correction over all numbers limits the probability that any of them
fails by chance.
"""

from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats

from bezierplan.places import TREE
from bezierplan.running.inputs import tree

OUTCOME = TREE / "docs" / "outcome" / "numbers_papers_size.csv"
SHOWN = 10
"""Numbers of which a failure tells."""
ERROR_RATE = 0.01
"""How often a sound installation fails, at most: equal seeds make its runs more alike than
independent ones.
"""
ALIKE = 1e-6
"""Relative difference of numbers that no chance decides, such as lengths of exact paths."""
TIMES = ("s", "ms")
"""Units of metrics that differ from machine to machine."""

_WIDTH = 2 * stats.norm.ppf(0.975)


def compared(outcome: pd.DataFrame, again: pd.DataFrame) -> pd.DataFrame:
    """The numbers of an installation's comparison beside those kept of the same table: the columns
    that name one, value_kept, value_own, p.

    p: probability of a difference as large by chance, 0 of a number that only one side has; nan
    where nothing can be said: times, numbers of fewer than two runs, extremes.
    """
    names = [*again.columns[: again.columns.get_loc("unit") + 1], "n_published", "value_published"]
    outcome, again = (
        frame.assign(**{name: _plain(frame[name]) for name in names}).drop_duplicates(names)
        for frame in (outcome, again)
    )
    both = outcome.merge(again, "outer", names, suffixes=("_kept", "_own"), indicator="sides")
    values, sizes, low, high = (
        [both[f"{name}_{side}"].to_numpy(dtype=float) for side in ("kept", "own")]
        for name in ("value_ours", "n_ours", "low95_ours", "high95_ours")
    )
    widths = [upper - lower for lower, upper in zip(low, high)]
    found = both[names].assign(
        value_kept=values[0], value_own=values[1], p=p_values(values, widths, sizes)
    )
    found["p"] = found["p"].where(~both["unit"].isin(TIMES))
    return found.assign(p=found["p"].where(both["sides"] == "both", 0.0))


def _plain(values: pd.Series) -> pd.Series:
    """Values as text, alike whether a column was read as whole numbers or, beside empty cells, as
    others.
    """
    numbers = pd.to_numeric(values, errors="coerce")
    return values.astype(str).where(numbers.isna(), numbers.map("{:.12g}".format))


def p_values(
    values: list[np.ndarray], widths: list[np.ndarray], sizes: list[np.ndarray]
) -> np.ndarray:
    """Two-sided p of the difference of pairs of estimates, from the widths of their 95 % bootstrap
    intervals and their numbers of runs.

    nan without an interval. A bootstrap's standard error is too small by sqrt(1 - 1/n).
    """
    least = np.minimum(*sizes)
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = [width / _WIDTH / np.sqrt(1 - 1 / size) for width, size in zip(widths, sizes)]
        difference = np.abs(values[0] - values[1])
        p = 2 * stats.t.sf(difference / np.hypot(*errors), np.maximum(least - 1, 1))
    alike = difference <= ALIKE * np.maximum(np.abs(values[0]), np.abs(values[1]))
    p = np.where(alike, 1.0, p)
    return np.where((least < 2) | np.isnan(widths[0]) | np.isnan(widths[1]), np.nan, p)


def failed(numbers: pd.DataFrame) -> pd.DataFrame:
    """The numbers that differ by more than chance, at `ERROR_RATE` for all together, the least
    probable first.
    """
    return numbers[numbers["p"] * numbers["p"].notna().sum() < ERROR_RATE].sort_values("p")


def against_outcome(folder: Path, tables: list[tuple[str, str]]) -> tuple[list[str], bool]:
    """What is to be said of numbers beside those of docs/outcome, and whether they are sound.
    tables: study and name of each. Raises FileNotFoundError for a table that is not there.
    """
    outcome = pd.read_csv(OUTCOME)
    pairs = []
    for study, table in tables:
        rows = outcome[(outcome["study"] == study) & (outcome["table"] == table)]
        file = folder / study / tree(table) / f"{table}.comparison.csv"
        if not file.is_file():
            raise FileNotFoundError(f"{file}: not there; make verify-outcome makes it")
        pair = compared(rows, pd.read_csv(file))
        pairs.append(pair.assign(table=f"{study}/{table}"))
    numbers = pd.concat(pairs, ignore_index=True)
    numbers["equal"] = numbers["value_kept"] == numbers["value_own"]
    tested, others = numbers[numbers["p"].notna()], numbers[numbers["p"].isna()]
    of_times, worst = others["unit"].isin(TIMES), failed(numbers)
    lines = [
        f"{len(tested)} numbers compared, {tested['equal'].sum()} equal, {len(worst)} different by "
        f"more than chance; not compared: {of_times.sum()} times and {(~of_times).sum()} without "
        f"an interval ({others.loc[~of_times, 'equal'].sum()} equal)"
    ]
    if len(worst):
        shown = worst.head(SHOWN).drop(columns="equal").dropna(axis=1, how="all")
        lines.append(shown.to_string(index=False))
    rate = f"with a probability of at most {100 * ERROR_RATE:g} %"
    if len(tested) and worst.empty:
        return [*lines, f"sound: a sound installation fails {rate}"], True
    return [*lines, f"not sound: chance alone does this {rate}"], False
