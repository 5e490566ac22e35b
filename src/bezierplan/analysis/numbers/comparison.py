"""Every published number of a table next to ours.

One row for each group of runs, metric and statistic; an empty cell means that there is no such
number. The key columns come first, columns of the runs table that identify the rows: those left of
`metric` in the published file, then the table's others. `columns.csv` has the columns after them.
"""

import math
from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from bezierplan.analysis import metrics, statistics
from bezierplan.analysis.audit import possible
from bezierplan.analysis.columns import COLUMNS_OF
from bezierplan.analysis.numbers import tables
from bezierplan.analysis.results import (
    Results,
    group_rows,
    list_key_columns,
    read_printed_numbers,
    select,
)
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.workspaces.seeds import generator

LEAST_REACH = 0.001
"""A range reaches at least this share of ours to each side: ours may all be equal."""

WIDE = 0.5
"""A range that holds this share of the other printed numbers is too wide to tell."""

PLACES = ["table_row", "table_column", "as_printed"]
"""Columns beside those of a comparison: the place of the number in the table's file, counted from 0
below its head and right of the names of rows, and its text.
"""

NO_RANGE = "no range"
RANGE = ["low95_predicted", "high95_predicted", "position"]

SIGNS = {"below": "▼", "inside": "●", "above": "▲"}
"""Position -> its sign in print, which stands in brackets if the range is too wide to tell."""
SIGNS_MEAN = (
    "First the printed number, then the range of ours (95 % of experiments of the paper's size): "
    "● inside, ▲ printed number above it, ▼ below it; in brackets where our range is too wide to "
    "tell, because it also holds at least half of the paper's other numbers of the same quantity "
    "and condition"
)

FITTED = "we fitted a detail to it"
ONE_DRAW = "one draw of a random map"
NO_MAP = "no exact map is printed"
UNDEFINED = "not defined in the paper"
"""Reasons why the position of a number proves nothing about the paper."""


def read_published(file: str, spec: Pivot) -> pd.DataFrame:
    """Read the published numbers of a table: key columns, metric, statistic, n, unit, value,
    as_printed (the value's text).
    """
    return assign_metrics(read_printed_numbers(file), spec.reads)


def assign_metrics(published: pd.DataFrame, reads: dict[str, str]) -> pd.DataFrame:
    """Assign to published numbers the metrics under which a table reads them. reads: metrics by the
    paper's word.
    """
    return published.assign(metric=published["metric"].replace(reads))


def compare(
    results: Results,
    spec: Pivot,
    published: pd.DataFrame,
    name: str,
    reconstructed: Collection[str],
    fitted: dict[str, dict],
) -> pd.DataFrame:
    """Compare the published numbers of a table with ours, in the order of the table; the columns
    are described above.

    published: as from `read_published`. name: `study/table`, which seeds each row's random draws.
    reconstructed: workspaces that the paper does not print. fitted: as in `find_reasons`.
    """
    key_columns = list_key_columns(published)
    keys = list(dict.fromkeys([*key_columns, *spec.key_columns, *spec.primary]))
    ours = tables.compute_cells(results, spec, keys)
    ours = tables.place_cells(ours, spec, results.problems)
    # Before the join, while all ranks of the printed table stand together.
    marked = published.assign(impossible=find_impossible_ranks(published, spec))
    both = _join_published(ours, marked, key_columns)
    # The published file has an order of its own.
    order = (
        tables.order_keys(both, spec, results.problems)
        .sort_values([*keys, "value", "metric", "statistic"])
        .index
    )
    both = both.loc[order].reset_index(drop=True)
    workspace_unit = next(iter(results.problems.values())).workspace.unit
    _refuse_lost(both, spec, name)
    both["unit"] = [metrics.find_unit(metric, workspace_unit) for metric in both["metric"]]
    described = pd.DataFrame([_compute_row(row, keys, name) for row in both.to_dict("records")])
    table = both.join(described).reindex(columns=keys + COLUMNS_OF["comparison"] + PLACES)
    table.loc[both["impossible"].eq(True), "possible"] = False
    table["wide"] = _find_wide(both.join(table[RANGE]), published, key_columns)
    of_ours = results.runs.loc[results.runs["workspace"].isin(reconstructed), "problem"].unique()
    table["reason"] = find_reasons(both, spec, of_ours, fitted)
    # Written as whole numbers and flags, also where cells are empty.
    whole = ["n_published", "n_ours", "n_asked", *PLACES[:2]]
    marks = ("wide", "possible")
    return table.astype(dict.fromkeys(whole, "Int64") | dict.fromkeys(marks, "boolean"))


def find_reasons(
    numbers: pd.DataFrame, spec: Pivot, of_ours: Collection[str], fitted: dict[str, dict]
) -> pd.Series:
    """Find the reason why each number of a table proves nothing about the paper, wherever it lies;
    empty if it may prove something.

    Our definition or our map may be wrong, or something was fitted to the number. of_ours: problems
    on maps that the paper does not print. fitted: metric -> which numbers of the table are such
    (column -> value or list of values).
    """
    vague = {entry.metric for entry in spec.values if not entry.defined}
    was_fitted = pd.Series(False, numbers.index)
    for metric, where in fitted.items():
        was_fitted |= numbers.index.isin(select(numbers, where | {"metric": metric}).index)
    on_our_map = numbers["problems"].map(
        lambda names: not names.isdisjoint(of_ours), na_action="ignore"
    )
    reason_of = pd.Series("", numbers.index)
    # Of several reasons the last one is told.
    for reason, whose in (
        (FITTED, was_fitted),
        (ONE_DRAW, numbers["draws"].eq(1)),
        (NO_MAP, on_our_map.eq(True)),
        (UNDEFINED, numbers["metric"].isin(vague)),
    ):
        reason_of = reason_of.mask(whose, reason)
    return reason_of


def find_position(published: float, low: float, high: float) -> str:
    """Find the position of a published number beside our range: below, inside or above; no range if
    an end is NaN.
    """
    if published < low:
        return "below"
    if published > high:
        return "above"
    return "inside" if low <= published <= high else NO_RANGE


def _list_quantities(numbers: pd.DataFrame) -> Iterator[tuple[str, str]]:
    """Yield the metric of each number with the statistic to compare it with: the median if the
    paper states none.
    """
    return zip(numbers["metric"], numbers["statistic"].replace("unstated", "median"))


def _refuse_lost(both: pd.DataFrame, spec: Pivot, name: str) -> None:
    """Raise ValueError for a printed number that belongs into the table and has no cell there."""
    shown = {
        (entry.metric, each.replace("unstated", "median"))
        for entry in spec.values
        for each in entry.statistics
    }
    where = {column: values for column, values in spec.where.items() if column in both}
    own = select(both[both["table_row"].isna()], where)
    lost = own[[quantity in shown for quantity in _list_quantities(own)]]
    if len(lost):
        first = lost.iloc[0]
        place = ", ".join(
            f"{key} {first[key]}" for key in [*spec.key_columns, "metric", "statistic"]
        )
        raise ValueError(
            f"{name}: {len(lost)} printed numbers have no cell in the table, such as "
            f"{first['as_printed']} ({place})"
        )


def find_impossible_ranks(published: pd.DataFrame, spec: Pivot) -> np.ndarray:
    """Find which published numbers (n,) are mean ranks that no runs have, because those of all rows
    of the table do not add up.

    published: as from `read_published`.
    """
    impossible = np.zeros(len(published), dtype=bool)
    ranks = published[(published["metric"] == "rank") & (published["statistic"] == "mean")]
    for own in group_rows(ranks, [column for column in spec.across if column in published]):
        printed = own["value"].astype(str).map(possible.read_printed)
        if len(own) > 1 and not possible.can_be_ranks(printed):
            impossible |= published.index.isin(own.index)
    return impossible


def _join_published(
    ours: pd.DataFrame, published: pd.DataFrame, key_columns: list[str]
) -> pd.DataFrame:
    """Join published numbers with our cells, n_published and value_published, also where there are
    no runs; statistics are named as published.

    key_columns: the key columns of the published numbers.
    """
    theirs = published.rename(columns={"n": "n_published", "value": "value_published"})
    # Keys that are merged must have one type.
    theirs = theirs.drop(columns="unit").astype({key: ours[key].dtype for key in key_columns})
    # Our medians are named `unstated` where the paper does not state its statistic.
    names = dict(zip(_list_quantities(published), published["statistic"]))
    ours, theirs = (
        table.assign(statistic=[names.get(each, each[1]) for each in _list_quantities(table)])
        for table in (ours, theirs)
    )
    return ours.merge(theirs, how="right", on=[*key_columns, "metric", "statistic"])


def _find_wide(
    numbers: pd.DataFrame, published: pd.DataFrame, key_columns: list[str]
) -> list[bool | None]:
    """Find which ranges are too wide to tell: they hold at least half of the other printed numbers
    of the metric, statistic and condition, or in all conditions if their own has none. None without
    a range.

    numbers: with the columns of `RANGE`.
    """
    places = [key for key in key_columns if key != "method"]
    alike = dict([*published.groupby(["metric", "statistic"])])
    wide: list[bool | None] = []
    for row in numbers.to_dict("records"):
        if pd.isna(row["position"]) or row["position"] == NO_RANGE:
            wide.append(None)
            continue
        own = pd.Series({key: row[key] for key in key_columns})
        same = alike[row["metric"], row["statistic"]]
        others = same[(same[key_columns] != own).any(axis=1)]
        here = others[(others[places] == own[places]).all(axis=1)]
        values = (others if here.empty else here)["value"].astype(float)
        held = values.between(row["low95_predicted"], row["high95_predicted"])
        wide.append(bool(held.mean() >= WIDE))
    return wide


def _compute_row(row: dict[str, Any], keys: list[str], name: str) -> dict[str, Any]:
    """Compute our side of one row, and the published number's position in it; nothing for a
    published number without runs of ours.
    """
    if pd.isna(row["size"]):
        return {"n_ours": 0, "n_asked": 0, "position": NO_RANGE, "possible": None}
    numbers = row["numbers"]
    statistic = row["statistic"]
    row_name = "/".join([name, *(f"{key}={row[key]}" for key in keys), row["metric"], statistic])
    within, units, of_units = row["groups"] or None, numbers, statistic
    if within:
        # Runs of one group are alike: the groups are the units whose mean is uncertain.
        units = np.array([statistics.compute_statistic(statistic, group) for group in within])
        of_units = "mean"
    low, high = statistics.compute_interval(of_units, units, generator(f"{row_name}/interval"))
    # The paper's number of runs, whatever share of ours failed.
    size = None if pd.isna(row["n_published"]) else int(row["n_published"])
    scaled = statistics.scale_statistic(statistic, numbers, int(row["size"]), size)
    cell = {
        "n_ours": len(numbers),
        "n_asked": int(row["size"]),
        "value_ours": statistics.compute_statistic(statistic, numbers),
        "value_ours_scaled": scaled,
        "low95_ours": low,
        "high95_ours": high,
    }
    published, single = row["value_published"], (row["least"], row["most"])
    cell["possible"] = is_possible(row, size)
    if row["unit"] == "s":  # of another machine
        return cell | {"position": NO_RANGE}
    rng = generator(f"{row_name}/prediction")
    found = statistics.compute_prediction_interval(statistic, numbers, size, rng, single, within)
    low, high = round_range(found, scaled, row["decimals"])
    return cell | {
        "low95_predicted": low,
        "high95_predicted": high,
        "position": find_position(published, low, high),
    }


def round_range(
    ends: tuple[float, float], ours: float, decimals: int | None
) -> tuple[float, float]:
    """Round a range outwards to printed numbers: ends that lie in it by half a unit of their last
    digit. The range has the least reach; without decimals, it is not rounded.

    >>> round_range((14.6, 31.4), 20.0, 0), round_range((5.0, 5.0), 5.0, 3)
    ((15.0, 31.0), (4.995, 5.005))
    """
    reach = LEAST_REACH * abs(ours)
    low, high = min(ends[0], ours - reach), max(ends[1], ours + reach)
    if pd.isna(decimals) or math.isnan(low):
        return low, high
    unit = 10.0**-decimals
    ends = (
        end if math.isinf(end) else round(whole(end / unit + half) * unit, decimals)
        # Half a unit belongs to a printed number; 1e-9 of a unit is for rounding.
        for end, whole, half in (
            (low, math.ceil, -0.5 - 1e-9),
            (high, math.floor, 0.5 + 1e-9),
        )
    )
    return tuple(map(float, ends))


def describe_range(number: Mapping[str, Any]) -> str:
    """Describe a published number's sign and our range; empty without a range. number: a row, of
    which an empty cell is None, NaN or "".

    >>> ends = {"low95_predicted": 15, "high95_predicted": 32}
    >>> describe_range({"position": "above", "wide": False} | ends)
    '▲ ours 15 to 32'
    """
    if number["position"] not in SIGNS:
        return ""
    sign = SIGNS[number["position"]]
    return f"{f'({sign})' if str(number['wide']) == 'True' else sign} ours {format_range(number)}"


def format_range(number: Mapping[str, Any]) -> str:
    """Format our range in words; an end that our runs do not determine is left out."""
    ends = [number["low95_predicted"], number["high95_predicted"]]
    # An empty end is one that our runs do not determine.
    low, high = (math.inf if end in ("", None) else float(end) for end in ends)
    if not math.isfinite(low):
        return f"at most {high:.10g}" if math.isfinite(high) else "any"
    return f"{low:.10g} to {high:.10g}" if math.isfinite(high) else f"at least {low:.10g}"


def is_possible(row: Mapping[str, Any], size: int | None) -> bool:
    """Return whether runs can have the published number, up to half a unit of its last digit."""
    low, high, statistic = row["least"], row["most"], row["statistic"]
    if statistic in ("std", "iqr", "range"):
        low, high = 0.0, math.inf
    elif statistic in ("count", "share"):
        low, high = 0.0, 1.0 if statistic == "share" else size or math.inf
    half = 0.0 if pd.isna(row["decimals"]) else 0.5 * 10.0 ** -row["decimals"]
    return low - half <= row["value_published"] <= high + half
