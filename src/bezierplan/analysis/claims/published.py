"""Published numbers of the same cells as our comparisons."""

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis.claims import effects
from bezierplan.analysis.claims.check import OfRuns
from bezierplan.analysis.results import list_key_columns

# Statistics for a check that names none: the first that is printed for every cell is used.
_ANY_STATISTIC = ("mean", "median", "unstated", "share", "count", "min", "max")


PrintedCell = dict[str, tuple[float, float]]
"""Printed numbers of one cell: statistic -> (value, number of runs)."""


def average_printed(
    check: OfRuns, rows_of_conditions: Sequence[Sequence[PrintedCell | None]]
) -> tuple[np.ndarray, int | None]:
    """Average the printed numbers of cells over conditions; return them (k,) and their number of
    runs, None if that is not printed.

    rows_of_conditions: for each condition and each cell, its numbers as from `find_cell`.

    All use one statistic: the check's own or an unstated one, for a median of seconds also another;
    if it names none, the first of `_ANY_STATISTIC` that is printed for every cell. NaN where a cell
    is not printed, or where two cells share a row (the paper does not distinguish them).
    """
    size = len(rows_of_conditions[0])
    cells = [cell for cell in itertools.chain(*rows_of_conditions) if cell]
    # Cells that share a row are one object.
    if len({*map(id, cells)}) == size * len(rows_of_conditions):
        for statistic in _list_statistics(check):
            if all(statistic in cell for cell in cells):
                values, runs = np.array([cell[statistic] for cell in cells]).T
                # Ours are shares, so a count becomes one.
                numbers = values / runs if statistic == "count" else values
                known = None if np.isnan(runs).all() else int(np.nanmin(runs))
                return effects.mark_events(check, numbers.reshape(-1, size).mean(axis=0)), known
    return np.full(size, np.nan), None


def _list_statistics(check: OfRuns) -> tuple[str, ...]:
    """List the printed statistics that serve a check, the best first.

    Medians of seconds are compared with printed means as well: papers print mean times; other
    programs disturb medians less.
    """
    named = check.statistic
    if named in (None, "rank"):
        return _ANY_STATISTIC
    return (named, "unstated", *(_ANY_STATISTIC if check.timed and named == "median" else ()))


class PrintedTable(NamedTuple):
    """The printed numbers of one metric in a table: its experiment; the columns that tell its cells
    apart; and the cells by their values there.
    """

    experiment: str
    keys: list[str]
    cells: dict[tuple, PrintedCell]


def select_metric(experiment: str, table: pd.DataFrame, metric: str) -> PrintedTable:
    """Select the numbers of a metric from a table of published numbers."""
    keys = list_key_columns(table)
    rows = table[table["metric"] == metric].dropna(subset=keys)
    cells: dict[tuple, PrintedCell] = {}
    for row in rows.to_dict("records"):
        cell = cells.setdefault(tuple(row[key] for key in keys), {})
        cell[row["statistic"]] = (float(row["value"]), float(row["n"]))
    return PrintedTable(experiment, keys, cells)


def find_cell(
    cell: list[dict], tables: list[PrintedTable], variant_of: dict[str, str]
) -> PrintedCell | None:
    """Find the printed numbers of a cell; None if no table has it, or if the cell matches several
    rows.

    cell: the values that distinguish its runs, by column. tables: the first with the cell is used.
    variant_of: method -> the method whose published numbers count.
    """
    experiments = {row["experiment"] for row in cell}
    for table in tables:
        if experiments != {table.experiment} or not set(table.keys) <= cell[0].keys():
            continue
        places = {tuple(row[key] for key in table.keys) for row in cell}
        # The cell pools several rows of this table.
        if len(places) != 1:
            continue
        place = tuple(
            variant_of.get(value, value) if key == "method" else value
            for key, value in zip(table.keys, places.pop())
        )
        if place in table.cells:
            return table.cells[place]
    return None
