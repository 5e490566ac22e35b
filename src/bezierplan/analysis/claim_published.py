"""Published numbers that claims are judged on: of the same cells as our comparisons, and among themselves."""

import itertools
import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis import claim_effects
from bezierplan.analysis.claim_effects import Finding

# Statistics that may stand for a check which names none, the first that is printed of every cell.
_ANY_STATISTIC = ("mean", "median", "unstated", "share", "count", "min", "max")
# Columns of published files that tell no cells apart.
_NOT_KEYS = ("value", "n", "unit")


class Printed(NamedTuple):
    """Printed numbers of one cell: the number of their table, and statistic -> (row in it, value, how many runs it is of)."""

    table: int
    statistics: dict[str, tuple[int, float, float]]


def listed(value: Any) -> list:
    """A value, or a list of values, as a list."""
    return value if isinstance(value, list) else [value]


def printed(check: dict, found: Sequence[Sequence[Printed | None]]) -> tuple[np.ndarray, int | None]:
    """Printed numbers of cells (k,), averaged over conditions, and how many runs they are of, None if that is not printed.

    found: of each condition, of each cell, its rows as from `rows_of_cell`.

    All of one statistic: the check's own or an unstated one; where it names none, the first of `_ANY_STATISTIC` that is printed of every
    cell. Not a number where a cell is not printed, or where two cells would have the same row (the paper does not tell them apart).
    """
    cells = len(found[0])
    nothing = np.full(cells, np.nan), None
    found = list(itertools.chain.from_iterable(found))
    if None in found:
        return nothing
    rows = [(each.table, row) for each in found for row, _, _ in each.statistics.values()]
    if len(set(rows)) < len(rows):
        return nothing
    named = check.get("statistic", "rank")
    for statistic in _ANY_STATISTIC if named == "rank" else (named, "unstated"):
        if all(statistic in each.statistics for each in found):
            values, runs = np.array([each.statistics[statistic][1:] for each in found]).T
            numbers = (values / runs if statistic == "count" else values).reshape(-1, cells).mean(axis=0)
            return claim_effects.event(check, numbers), None if np.isnan(runs).all() else int(np.nanmin(runs))
    return nothing


def rows_of_cell(cell: pd.DataFrame, metric: str, tables: list[tuple[str, pd.DataFrame]], variant_of: dict[str, str]) -> Printed | None:
    """The printed numbers of a cell's metric; None if no table has it, or if the cell is several rows of it.

    cell: the columns that tell its runs apart. tables: experiment and published numbers; the first that has the cell serves.
    variant_of: method -> the method whose published numbers count.
    """
    for number, (experiment, table) in enumerate(tables):
        keys = table.columns[: table.columns.get_loc("metric")].to_list()
        if set(cell["experiment"]) != {experiment} or not set(keys) <= set(cell.columns):
            continue
        places = cell[keys].drop_duplicates()
        if len(places) != 1:
            continue
        rows = table[table["metric"] == metric]
        for key, value in places.iloc[0].items():
            rows = rows[rows[key] == (variant_of.get(value, value) if key == "method" else value)]
        if not rows.empty:
            values, runs = (rows[column].astype(float) for column in ("value", "n"))
            return Printed(number, dict(zip(rows["statistic"], zip(rows.index, values, runs))))
    return None


def arithmetic(check: dict, published: dict[str, pd.DataFrame]) -> list[tuple[str, Finding]]:
    """Do printed numbers fit each other? One finding for each cell of the first selector, with the cell's name.

    `difference`: the second less the first; `increase_percent`: of the second over the first; `equal`: the first alone. Cells of several
    selectors belong together where the columns that no selector names are equal; a lone cell belongs to every other. What is computed may
    differ from what is printed by half a unit of the last printed digit. Not a number where a cell is empty or missing.
    """
    selectors = [*check["of"], *([check["equals"]] if isinstance(check["equals"], dict) else [])]
    named = {column for selector in selectors for column in selector}
    cells = _selected(published, selectors[0])
    columns = ["value"]
    for number, selector in enumerate(selectors[1:], start=1):
        others = _selected(published, selector)
        columns.append(f"value{number}")
        common = [column for column in cells.columns.intersection(others.columns) if column not in {*named, *_NOT_KEYS}]
        others = others.rename(columns={"value": columns[-1]})
        if len(cells) == len(others) == 1:
            cells = cells.assign(**{columns[-1]: others[columns[-1]].iloc[0]})
        else:
            cells = cells.merge(others[[*common, columns[-1]]], how="left", on=common)
    keys = [column for column in cells.columns if column not in {*named, *_NOT_KEYS, *columns}]
    names = [", ".join(f"{key}={row[key]}" for key in keys if not pd.isna(row[key])) for _, row in cells.iterrows()]
    return [(name, _computed(check, row)) for name, row in zip(names, cells[columns].to_numpy(dtype=float).tolist())]


def _selected(published: dict[str, pd.DataFrame], selector: dict) -> pd.DataFrame:
    """The rows of one or several published files that a selector names."""
    rows = pd.concat([published[name] for name in listed(selector["table"])], ignore_index=True)
    for column, wanted in selector.items():
        if column != "table":
            rows = rows[rows[column].isin(listed(wanted))]
    return rows


def _computed(check: dict, numbers: list[float]) -> Finding:
    """One comparison of printed numbers: those of `of`, and that of `equals` if it is one."""
    if any(map(math.isnan, numbers)):
        return Finding(mark="?", reason="a printed cell is empty")
    wanted = numbers.pop() if isinstance(check["equals"], dict) else float(check["equals"])
    match check["form"]:
        case "difference":
            computed = numbers[1] - numbers[0]
        case "increase_percent":
            computed = 100 * (numbers[1] / numbers[0] - 1) if numbers[0] else math.nan
        case "equal":
            computed = numbers[0]
    # Of two printed numbers the one with more digits, because a last zero is not read.
    digits = max(map(_decimals, [wanted, computed] if check["form"] == "equal" else [wanted]))
    fits = abs(computed - wanted) <= 0.5 * 10.0**-digits * (1 + 1e-9)
    return Finding(computed, "printed", wanted, mark="+" if fits else "-")


def _decimals(number: float) -> int:
    """Digits behind the point of the shortest decimal that is this number."""
    text = np.format_float_positional(number, trim="-")
    return len(text.partition(".")[2])
