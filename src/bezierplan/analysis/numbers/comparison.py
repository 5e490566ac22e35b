"""Every published number of a table next to ours.

One row for each group of runs, metric and statistic; an empty cell means that there is no such
number. Columns:

- key columns: columns of the runs table that identify the rows: those left of `metric` in the
  published file, then the table's others
- metric: what is measured, a name of `metrics.METRICS`
- statistic: the statistic that the paper prints; `unstated` if it does not say, in which case ours
  is the median
- unit: unit of the metric; `-` for a number without one
- n_published: runs behind the published number, if the paper states it
- value_published: the published number; a variant of a published method is compared with that
  method's number
- n_ours: our runs that count: feasible ones for metrics of feasible paths, all for the others
- n_asked: runs among which these are: the others failed, or have no such value
- value_ours: the statistic of these runs
- value_ours_scaled: the same for n_published runs (`statistics.scaled`): counts and extremes depend
  on their number
- low95_ours, high95_ours: 95 % bootstrap interval of value_ours; empty below two runs, and for min,
  max and range
- low95_predicted, high95_predicted: 95 % prediction interval for the number printed by an
  experiment of n_published runs
- quantile_published: quantile of the published number in experiments of n_published runs; in our
  runs if n_published is empty
- in_range: whether it lies in the central 95 %. Ours are rounded like the printed one, ties count;
  empty for times, and below six runs
- power: share of the numbers that matter (`_rivals`), without those that no run can have, that
  would have been rejected instead of the published one
- identified: cells or moves of the paths whose length the published number is (`identified`), and
  the chance of a match
- verdict: on ours: disagrees; inconclusive; agrees
- why: why it is inconclusive: it decides nothing (`decides_nothing`), or the interval has no end
  there, or contains most of the numbers that matter
- possible: whether the metric can have the published value, and ranks add up. A length below the
  bound of our map is judged all the same
- share_feasible: share of all runs whose path the certified checker accepts
- bound: least length of the problem, of the metric's kind (`metrics.Metric`); for several problems,
  the median over the runs
- gap: median over the feasible runs of that kind of length / bound - 1
- primary: whether the row is of the default reading: no variant of a method, and what the
  table's `primary` names
"""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd

from bezierplan.analysis import metrics, statistics
from bezierplan.analysis.audit import identified, possible
from bezierplan.analysis.numbers import tables
from bezierplan.analysis.results import Results, groups, keys_of, printed_numbers, select
from bezierplan.analysis.table_kinds import Identify, Pivot
from bezierplan.schema.model import convert_to_list
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.seeds import generator

LEAST_POWER = 0.5
"""Share of the numbers that matter which an interval has to exclude before a number in it
agrees.
"""

MATTERS = 0.1
"""Where the paper prints too few numbers of other methods in a place, the number that differs from
ours by this share, on the side of the published one, is the one that matters.
"""

LEAST_RIVALS = 2
"""Numbers of other methods that a place needs to be those that matter: a power against a single one
is all or nothing.
"""

PLACES = ["table_row", "table_column", "as_printed"]
"""Columns beside those of a comparison, for a table of the paper's form: the place of the number in
the table's file, counted from 0 below its head and right of the names of rows, and its text.
"""

NO_END = "interval without an end on that side"
TOO_WIDE = "interval that contains most numbers of the competing methods"
OFF_OURS = f"interval that contains the number {100 * MATTERS:g} % off ours, or no run has it"
"""Why a number in the interval is inconclusive: the test could not have failed, or has no power
against printed numbers, or against ours.
"""

FITTED = "number to which something was fitted"
ONE_DRAW = "one draw of a random map"
NO_MAP = "map that the paper does not print"
UNDEFINED = "quantity that the paper does not define"
"""Why a number decides nothing, wherever it lies (`decides_nothing`)."""

COLUMNS = [
    "metric",
    "statistic",
    "unit",
    "n_published",
    "value_published",
    "n_ours",
    "n_asked",
    "value_ours",
    "value_ours_scaled",
    "low95_ours",
    "high95_ours",
    "low95_predicted",
    "high95_predicted",
    "quantile_published",
    "in_range",
    "power",
    "verdict",
    "why",
    "identified",
    "possible",
    "share_feasible",
    "bound",
    "gap",
    "primary",
]


def read_published(file: str | None, spec: Pivot) -> pd.DataFrame:
    """The published numbers of a table: key columns, metric, statistic, n, unit, value, as_printed
    (the value's text). Without a file, empty, with the table's keys.
    """
    if file is None:
        columns = ("metric", "statistic", "n", "unit", "value", "as_printed")
        return pd.DataFrame(columns=[*spec.key_columns, *columns])
    return as_read(printed_numbers(file), spec.reads)


def as_read(published: pd.DataFrame, reads: dict[str, str]) -> pd.DataFrame:
    """Published numbers under the metrics that a table assigns to them. reads: the paper's word ->
    the metric.
    """
    return published.assign(metric=published["metric"].replace(reads))


def compare(
    results: Results,
    spec: Pivot,
    published: pd.DataFrame,
    variant_of: dict[str, str],
    baselines: list[str],
    name: str,
    reconstructed: bool = False,
    fitted: dict[str, dict] | None = None,
) -> pd.DataFrame:
    """The published numbers of a table next to ours, in the order of the table; the columns are
    described above.

    published: as from `read_published`. variant_of: method -> the
    method whose published numbers it is compared with. baselines: methods without a published
    number. Variants of the table's methods and baselines get rows, whether or not the table shows
    them. name: `study/table`, which seeds each row's random draws. reconstructed, fitted: as in
    `decides_nothing`.
    """
    key_columns = keys_of(published)
    keys = list(dict.fromkeys([*key_columns, *spec.key_columns, *spec.primary]))
    methods, beside = convert_to_list(spec.where.get("method", [])), []
    if methods and "method" in keys:
        variants = [variant for variant, method in variant_of.items() if method in methods]
        beside = [name for name in variants + baselines if name not in methods]
        spec = spec.but(where=spec.where | {"method": methods + beside})
    ours = tables.cells(results, spec, keys, beside)
    ours = tables.placed(ours, spec, list(results.problems))
    marked = published.assign(impossible=impossible_ranks(published, spec))
    both = _side_by_side(ours, marked, key_columns, variant_of)
    order = (
        tables.in_order(both, spec, list(results.problems))
        .sort_values([*keys, "value", "metric", "statistic"])
        .index
    )
    both = both.loc[order].reset_index(drop=True)
    workspace_unit = next(iter(results.problems.values())).workspace.unit
    if spec.printed:
        _refuse_lost(both, spec, name)
    both["unit"] = [metrics.unit(metric, workspace_unit) for metric in both["metric"]]
    printed = {
        column: published[column].to_numpy()
        for column in [*key_columns, "metric", "statistic", "value"]
    }
    rows = [
        _described(row, keys, name, _rivals(row, key_columns, printed))
        | {"identified": _identified(row, spec.identify, results.problems)}
        for row in both.to_dict("records")
    ]
    described = pd.DataFrame(rows, index=both.index)
    table = both.join(described).reindex(columns=keys + COLUMNS + PLACES * spec.printed)
    table.loc[both["impossible"].eq(True), "possible"] = False
    reasons = decides_nothing(both, spec, reconstructed, fitted or {})
    open_ones = (reasons != "") & table["in_range"].notna()
    table["verdict"] = table["verdict"].mask(open_ones, "inconclusive")
    table["why"] = table["why"].mask(open_ones, reasons)
    table["primary"] = table.index.isin(select(table, spec.primary).index)
    if "method" in table:
        table["primary"] &= ~table["method"].isin(variant_of)
    whole = ["n_published", "n_ours", "n_asked", *PLACES[:2] * spec.printed]
    marks = ("in_range", "possible")
    return table.astype(dict.fromkeys(whole, "Int64") | dict.fromkeys(marks, "boolean"))


def decides_nothing(
    numbers: pd.DataFrame, spec: Pivot, reconstructed: bool, fitted: dict[str, dict]
) -> pd.Series:
    """Why each number of a table neither agrees nor disagrees with ours, wherever it lies; empty if
    it may. The rule of evidence:

    - A quantity that the paper does not define, or a map that it does not print (`reconstructed`,
      or one draw of a random one), decides nothing: our definition or our map may be wrong. How
      near such numbers are is told, and a path that has such a length is named.
    - A number to which something was fitted confirms nothing. fitted: metric -> which numbers of
      the table are such (column -> value or list of values).
    """
    vague = {entry.metric for entry in spec.values if not entry.defined}
    printed = numbers.assign(method=numbers.get("printed_method"))
    was_fitted = pd.Series(False, numbers.index)
    for metric, where in fitted.items():
        was_fitted |= printed.index.isin(select(printed, where | {"metric": metric}).index)
    reasons = pd.Series("", numbers.index)
    for reason, whose in (
        (FITTED, was_fitted),
        (ONE_DRAW, numbers["draws"].eq(1)),
        (NO_MAP, pd.Series(reconstructed, numbers.index)),
        (UNDEFINED, numbers["metric"].isin(vague)),
    ):
        reasons = reasons.mask(whose, reason)
    return reasons


def counted_as(numbers: pd.DataFrame) -> pd.Series:
    """The verdict by which each printed number counts: that a path has its length is a statement on
    that number alone, and goes before the verdict on ours.
    """
    return numbers["verdict"].mask(numbers["identified"].notna(), "identified")


def _quantities(numbers: pd.DataFrame) -> Iterator[tuple[str, str]]:
    """Metric of each number, and the statistic with which a printed one is compared: the median
    with one that the paper does not state.
    """
    return zip(numbers["metric"], numbers["statistic"].replace("unstated", "median"))


def _refuse_lost(both: pd.DataFrame, spec: Pivot, name: str) -> None:
    """Raise ValueError if a printed number that belongs into a table of the paper's form has no
    cell there.
    """
    shown = {
        (entry.metric, each.replace("unstated", "median"))
        for entry in spec.values
        for each in entry.statistics
    }
    where = {column: values for column, values in spec.where.items() if column in both}
    own = select(both[both["value_published"].notna() & both["table_row"].isna()], where)
    lost = own[[quantity in shown for quantity in _quantities(own)]]
    if len(lost):
        first = lost.iloc[0]
        place = ", ".join(
            f"{key} {first[key]}" for key in [*spec.key_columns, "metric", "statistic"]
        )
        raise ValueError(
            f"{name}: {len(lost)} printed numbers have no cell in the table, such as "
            f"{first['as_printed']} ({place})"
        )


def _identified(
    row: dict[str, Any], entries: list[Identify], problems: dict[str, Problem]
) -> str | None:
    """The paths whose length a published number is, in words; None if no enumeration that counts
    finds one, or chance may well have.
    """
    problem = problems.get(row.get("problem", row.get("workspace")))
    if pd.isna(row["value_published"]) or problem is None:
        return None
    for entry in entries:
        if entry.counts and identified.applies(entry, row):
            value, decimals = row["value_published"], int(row["decimals"])
            found = identified.sought(entry, problem, value, decimals)
            if found and found.paths and found.chance < identified.UNLIKELY:
                return identified.in_words(found)
    return None


def impossible_ranks(published: pd.DataFrame, spec: Pivot) -> np.ndarray:
    """Which published numbers (n,) are mean ranks that no runs have, for those of all rows of the
    table do not add up.

    published: as from `read_published`.
    """
    impossible = np.zeros(len(published), dtype=bool)
    ranks = published[(published["metric"] == "rank") & (published["statistic"] == "mean")]
    for own in groups(ranks, [column for column in spec.across if column in published]):
        printed = own["value"].astype(str).map(possible.printed)
        if len(own) > 1 and not possible.are_ranks(printed):
            impossible |= published.index.isin(own.index)
    return impossible


def _side_by_side(
    ours: pd.DataFrame, published: pd.DataFrame, key_columns: list[str], variant_of: dict[str, str]
) -> pd.DataFrame:
    """Our cells with n_published and value_published, plus published numbers without runs;
    statistics are named as published.

    key_columns: the key columns of the published numbers.
    """
    theirs = published.rename(columns={"n": "n_published", "value": "value_published"})
    theirs = theirs.drop(columns="unit").astype({key: ours[key].dtype for key in key_columns})
    names = dict(zip(_quantities(published), published["statistic"]))
    ours, theirs = (
        table.assign(statistic=[names.get(each, each[1]) for each in _quantities(table)])
        for table in (ours, theirs)
    )
    if "method" in key_columns:
        ours = ours.assign(own_method=ours["method"], method=ours["method"].replace(variant_of))
    both = ours.merge(theirs, how="outer", on=[*key_columns, "metric", "statistic"])
    if "method" in key_columns:
        both = both.assign(
            printed_method=both["method"], method=both["own_method"].fillna(both["method"])
        )
    return both


def _rivals(
    row: dict[str, Any], key_columns: list[str], printed: dict[str, np.ndarray]
) -> np.ndarray:
    """The paper's numbers (n,) for other methods that match a row in metric, statistic and keys.

    printed: the columns of all its numbers (m,), by name; key_columns: those that are keys.
    """
    if "method" not in key_columns or pd.isna(row["value_published"]):
        return np.empty(0)
    keys = [key for key in ("metric", "statistic", *key_columns) if key != "method"]
    same_place = np.logical_and.reduce([printed[key] == row[key] for key in keys])
    # A variant's own name is in no published row; its number is that of its published method.
    own = printed["method"] == row["printed_method"]
    return printed["value"][same_place & ~own].astype(float)


def _described(
    row: dict[str, Any], keys: list[str], name: str, rivals: np.ndarray
) -> dict[str, Any]:
    """Our side of one row, and the published number's position in it; empty for a published number
    without runs of ours.
    """
    if pd.isna(row["runs"]):
        return {"n_ours": 0, "n_asked": 0, "in_range": None, "possible": None}
    numbers = row["numbers"]
    statistic = row["statistic"]
    row_name = "/".join([name, *(f"{key}={row[key]}" for key in keys), row["metric"], statistic])
    within, units, of_units = row["groups"] or None, numbers, statistic
    if within:
        # Runs of one group are alike: the groups are the units whose mean is uncertain.
        units = np.array([statistics.statistic(statistic, group) for group in within])
        of_units = "mean"
    low, high = statistics.interval(of_units, units, generator(f"{row_name}/interval"))
    # The paper's number of runs, whatever share of ours failed.
    size = None if pd.isna(row["n_published"]) else int(row["n_published"])
    published, single = row["value_published"], (row["least"], row["most"])
    rng, decimals = generator(f"{row_name}/prediction"), row["decimals"]
    placed = statistics.prediction(
        statistic, numbers, published, size, decimals, rng, single, within
    )
    # Seconds of another machine are shown, not judged.
    in_range = None if row["unit"] == "s" else placed.in_range
    ours, predicted = statistics.statistic(statistic, numbers), (placed.low, placed.high)
    return {
        "n_ours": len(numbers),
        "n_asked": int(row["size"]),
        "value_ours": ours,
        "value_ours_scaled": statistics.scaled(statistic, numbers, int(row["size"]), size),
        "low95_ours": low,
        "high95_ours": high,
        "low95_predicted": placed.low,
        "high95_predicted": placed.high,
        "quantile_published": placed.quantile,
        "in_range": in_range,
        **_judged(row, in_range, ours, predicted, size, rivals),
    }


def _judged(
    row: dict[str, Any],
    in_range: bool | None,
    ours: float,
    prediction: tuple[float, float],
    size: int | None,
    rivals: np.ndarray,
) -> dict[str, Any]:
    """Whether the test of one row could have failed, its power, and its verdict; empty if it is not
    judged.
    """
    published = row["value_published"]
    if pd.isna(published):
        return {"possible": None}
    limits = _limits(row["statistic"], (row["least"], row["most"]), size)
    half = 0.0 if pd.isna(row["decimals"]) else 0.5 * 10.0 ** -row["decimals"]
    cell = {"possible": not (published < limits[0] - half or published > limits[1] + half)}
    if in_range is None:
        return cell
    ends = (prediction[0] - half, prediction[1] + half)
    # To exclude a number that no run can have, or one on the other side of ours, says nothing.
    least = row["bound"] if row["metric"] in metrics.AT_LEAST_A_LENGTH else -math.inf
    near = np.array([ours * (1 + math.copysign(MATTERS, (published - ours) * ours))])
    rivals, near = (
        numbers[~((numbers < max(limits[0], least) - half) | (numbers > limits[1] + half))]
        for numbers in (rivals, near)
    )
    enough = len(rivals) >= LEAST_RIVALS
    others = rivals if enough else near
    beyond = (others < ends[0]) | (others > ends[1])
    power = float(beyond.mean()) if len(others) else 0.0
    why = ""
    if in_range and not statistics.can_fail(published, ours, prediction, limits):
        why = NO_END
    elif in_range and power < LEAST_POWER:
        why = TOO_WIDE if enough else OFF_OURS
    verdict = "disagrees" if not in_range else "inconclusive" if why else "agrees"
    return cell | {"power": power, "verdict": verdict, "why": why}


def _limits(statistic: str, single: tuple[float, float], size: int | None) -> tuple[float, float]:
    """The range of a statistic of runs whose single values lie in a given range."""
    if statistic in ("std", "iqr", "range"):
        return 0.0, math.inf
    if statistic in ("count", "share"):
        return 0.0, 1.0 if statistic == "share" else size or math.inf
    return single
