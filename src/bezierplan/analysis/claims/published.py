"""Published numbers of the same cells as our comparisons."""

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis.claims import effects
from bezierplan.analysis.claims.kinds import option

# Statistics for a check that names none: the first that is printed for every cell is used.
_ANY_STATISTIC = ("mean", "median", "unstated", "share", "count", "min", "max")


class Printed(NamedTuple):
    """Printed numbers of one cell: the number of their table, and statistic -> (row in it, value, number of runs)."""

    table: int
    statistics: dict[str, tuple[int, float, float]]


def printed(check: dict, found: Sequence[Sequence[Printed | None]]) -> tuple[np.ndarray, int | None]:
    """Printed numbers of cells (k,), averaged over conditions, and their number of runs, None if that is not printed.

    found: of each condition, of each cell, its rows as from `rows_of_cell`.

    All use one statistic: the check's own or an unstated one; if it names none, the first of `_ANY_STATISTIC` that is printed for every
    cell. NaN where a cell is not printed, or where two cells share a row (the paper does not distinguish them).
    """
    cells = len(found[0])
    nothing = np.full(cells, np.nan), None
    found = list(itertools.chain.from_iterable(found))
    if None in found:
        return nothing
    rows = [(each.table, row) for each in found for row, _, _ in each.statistics.values()]
    if len(set(rows)) < len(rows):
        return nothing
    named = option(check, "statistic")
    for statistic in _ANY_STATISTIC if named in (None, "rank") else (named, "unstated"):
        if all(statistic in each.statistics for each in found):
            values, runs = np.array([each.statistics[statistic][1:] for each in found]).T
            numbers = (values / runs if statistic == "count" else values).reshape(-1, cells).mean(axis=0)
            return effects.event(check, numbers), None if np.isnan(runs).all() else int(np.nanmin(runs))
    return nothing


def rows_of_cell(cell: pd.DataFrame, metric: str, tables: list[tuple[str, pd.DataFrame]], variant_of: dict[str, str]) -> Printed | None:
    """The printed numbers of a cell's metric; None if no table has it, or if the cell matches several rows.

    cell: the columns that distinguish its runs. tables: experiment and published numbers; the first with the cell is used.
    variant_of: method -> the method whose published numbers count.
    """
    for number, (experiment, table) in enumerate(tables):
        keys = table.columns[: table.columns.get_loc("metric")].to_list()
        if set(cell["experiment"]) != {experiment} or not set(keys) <= set(cell.columns):
            continue
        places = cell[keys].drop_duplicates()
        if len(places) != 1:
            continue
        place = dict(places.iloc[0]) | {"metric": metric}
        if "method" in place:
            place["method"] = variant_of.get(place["method"], place["method"])
        rows = table[np.logical_and.reduce([table[key] == value for key, value in place.items()])]
        if not rows.empty:
            values, runs = (rows[column].astype(float) for column in ("value", "n"))
            return Printed(number, dict(zip(rows["statistic"], zip(rows.index, values, runs))))
    return None
