"""Published numbers of the same cells as our comparisons."""

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis.claims import effects
from bezierplan.analysis.claims.check import OfRuns
from bezierplan.analysis.metrics import METRICS

# Statistics for a check that names none: the first that is printed for every cell is used.
_ANY_STATISTIC = ("mean", "median", "unstated", "share", "count", "min", "max")


class PrintedCell(NamedTuple):
    """Printed numbers of one cell: the number of their table, and statistic -> (row in it, value,
    number of runs).
    """

    table: int
    statistics: dict[str, tuple[int, float, float]]


def printed(
    check: OfRuns, rows_of_conditions: Sequence[Sequence[PrintedCell | None]]
) -> tuple[np.ndarray, int | None]:
    """Printed numbers of cells (k,), averaged over conditions, and their number of runs, None if
    that is not printed.

    rows_of_conditions: of each condition, of each cell, its rows as from `rows_of_cell`.

    All use one statistic: the check's own or an unstated one, for a median of seconds also another;
    if it names none, the first of `_ANY_STATISTIC` that is printed for every cell. NaN where a cell
    is not printed, or where two cells share a row (the paper does not distinguish them).
    """
    cells = len(rows_of_conditions[0])
    nothing = np.full(cells, np.nan), None
    rows_of_conditions = list(itertools.chain.from_iterable(rows_of_conditions))
    if None in rows_of_conditions:
        return nothing
    rows = [
        (each.table, row) for each in rows_of_conditions for row, _, _ in each.statistics.values()
    ]
    if len(set(rows)) < len(rows):
        return nothing
    for statistic in _wanted(check):
        if all(statistic in each.statistics for each in rows_of_conditions):
            values, runs = np.array(
                [each.statistics[statistic][1:] for each in rows_of_conditions]
            ).T
            numbers = (
                (values / runs if statistic == "count" else values).reshape(-1, cells).mean(axis=0)
            )
            return effects.event(check, numbers), None if np.isnan(runs).all() else int(
                np.nanmin(runs)
            )
    return nothing


def _wanted(check: OfRuns) -> tuple[str, ...]:
    """The printed statistics that serve a check, the best first. Papers print mean times; other
    programs disturb medians less.
    """
    named = check.statistic
    timed = check.metric in METRICS and METRICS[check.metric].unit == "s"
    if named in (None, "rank"):
        return _ANY_STATISTIC
    return (named, "unstated", *(_ANY_STATISTIC if timed and named == "median" else ()))


class PrintedTable(NamedTuple):
    """The printed numbers of one metric in a table: its experiment; the columns that tell its cells
    apart; and their values in a cell -> statistic -> (row in the table, value, number of runs).
    """

    experiment: str
    keys: list[str]
    cells: dict[tuple, dict[str, tuple[int, float, float]]]


def printed_table(experiment: str, table: pd.DataFrame, metric: str) -> PrintedTable:
    """The numbers of a metric in a table of published numbers."""
    keys = table.columns[: table.columns.get_loc("metric")].to_list()
    rows = table[table["metric"] == metric].dropna(subset=keys)
    cells: dict[tuple, dict] = {}
    for number, row in zip(rows.index, rows.to_dict("records")):
        cells.setdefault(tuple(row[key] for key in keys), {})[row["statistic"]] = (
            number,
            float(row["value"]),
            float(row["n"]),
        )
    return PrintedTable(experiment, keys, cells)


def rows_of_cell(
    cell: list[dict], tables: list[PrintedTable], variant_of: dict[str, str]
) -> PrintedCell | None:
    """The printed numbers of a cell; None if no table has it, or if the cell matches several rows.

    cell: the values that distinguish its runs, by column. tables: the first with the cell is used.
    variant_of: method -> the method whose published numbers count.
    """
    experiments = {row["experiment"] for row in cell}
    for number, table in enumerate(tables):
        if experiments != {table.experiment} or not set(table.keys) <= cell[0].keys():
            continue
        places = {tuple(row[key] for key in table.keys) for row in cell}
        if len(places) != 1:
            continue
        place = tuple(
            variant_of.get(value, value) if key == "method" else value
            for key, value in zip(table.keys, places.pop())
        )
        if place in table.cells:
            return PrintedCell(number, table.cells[place])
    return None
