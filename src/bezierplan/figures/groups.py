"""Groups of runs as rows of a table: all kinds of panel that compare groups use these functions."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from bezierplan.analysis import metrics, naming, statistics
from bezierplan.figures import style
from bezierplan.running.columns import Row
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results

# Reference lines: the exact shortest length, and the best known path of the methods' own kind.
LIMITS = {
    "reference": {**style.REFERENCE, "label": "best known path of the same kind"},
    "bound": {**style.BOUND, "label": "exact shortest path"},
}

# Columns of published numbers that do not distinguish runs.
_PRINTED = ["table", "metric", "statistic", "n", "unit", "value"]


def collect_rows(
    results: Results,
    keys: list[str],
    rows: Callable[[Results], Iterable[Row]],
) -> pd.DataFrame:
    """Return a table with the rows of each group of runs, in the order of the keys.

    keys: columns; runs with equal values in them form a group. rows: gives the rows of a group.
    Columns of `find_constants` come first, then the keys, the columns of `count_runs`, and the
    columns of the rows. Runs are sorted by id, so that no sum depends on the order in which chunks
    were read.
    """
    import pandas as pd

    # Chunks are read in any order, and the last bits of a sum depend on it.
    runs = results.runs.sort_values("id")
    return pd.DataFrame(
        find_constants(runs) | dict(zip(keys, key)) | count_runs(own) | row
        for key, own in runs.groupby(keys)
        for row in rows(results._replace(runs=own))
    )


def compute_summary(results: Results, keys: list[str], metric: str, statistic: str) -> pd.DataFrame:
    """Compute a statistic of a metric for each group of runs with equal keys.

    Columns of `collect_rows` come first, then n (runs that have the metric), value, low95 and
    high95 (ends of the 95 % bootstrap interval), in the metric's unit.
    """

    def build_row(group: Results) -> Iterable[Row]:
        numbers = list_values(group)
        key = [f"{column}={group.runs[column].iloc[0]}" for column in keys]
        rng = generator("/".join([metric, statistic, *key]))
        low, high = statistics.compute_interval(statistic, numbers, rng)
        value = statistics.compute_statistic(statistic, numbers)
        yield {"n": len(numbers), "value": value, "low95": low, "high95": high}

    return collect_rows(add_metric(results, metric), keys, build_row)


def add_metric(results: Results, metric: str) -> Results:
    """Return results whose runs have a metric in the column value. Raises KeyError for an unknown
    metric.
    """
    numbers = metrics.compute_values(results.runs, metric, results.problems)
    return results._replace(runs=results.runs.assign(value=numbers))


def list_values(group: Results) -> np.ndarray:
    """Return the sorted numbers (n,) of the runs that have the metric of `add_metric`."""
    return np.sort(group.runs["value"].dropna().to_numpy())


def find_constants(runs: pd.DataFrame) -> Row:
    """Return the problem and the method of runs, each if they share one."""
    return {
        column: runs[column].iloc[0]
        for column in ("problem", "method")
        if runs[column].nunique() == 1
    }


def count_runs(runs: pd.DataFrame) -> dict[str, int]:
    """Return how many runs there are, and how many of them are feasible."""
    return {"runs": len(runs), "feasible_runs": int(runs["feasible"].sum())}


def find_limits(runs: pd.DataFrame) -> dict[str, float]:
    """Return the values of `LIMITS` that all runs share, by name."""
    return {
        name: runs[name].iloc[0]
        for name in LIMITS
        if name in runs and runs[name].notna().all() and runs[name].nunique() == 1
    }


def find_published(
    results: Results, metric: str, table: str | None, statistic: str = "mean"
) -> list[float]:
    """Return the values of a metric's statistic that a published table has for runs.

    They belong to the same problem, method and settings. A key that is empty in the table matches
    all runs. A number for a part of the runs only, such as one of several problems, is left out. If
    there is no table, the list is empty.
    """
    numbers, runs = results.published, results.runs
    if numbers is None or table is None:
        return []
    # Keys of settings that print leaves empty hold for all runs.
    numbers = numbers.query("table == @table and metric == @metric and statistic == @statistic")
    for column in numbers.columns.difference(_PRINTED):
        own = runs[column].unique() if column in runs else []
        fits = numbers[column].isin(own if len(own) == 1 else [])
        numbers = numbers[numbers[column].isna() | fits]
    return sorted(numbers["value"].unique())


def describe_axis(column: str, scene: Any, statistic: str = "") -> str:
    """Return name and unit of the values of a column, the label of an axis.

    Only metrics have a unit here, since other columns have theirs in their labels. Lengths of time
    carry it in their numbers (`show_metric`).
    """
    unit = find_unit(column, scene)
    beside = "" if unit in ("-", "s", "") else f" ({unit})"
    return f"{statistic} {naming.name_column(column, scene.labels)}{beside}".lstrip()


def show_metric(
    axes: Axes, metric: str, scene: Any, statistic: str = "", scale: str = "linear"
) -> None:
    """Label the y axis with a metric and scale it (`style.scale_axis`)."""
    axes.set_ylabel(describe_axis(metric, scene, statistic))
    style.scale_axis(axes.yaxis, scale, find_unit(metric, scene))


def find_unit(column: str, scene: Any) -> str:
    """Return the unit of a metric, or an empty text for another column."""
    return metrics.find_unit(column, scene.unit) if column in metrics.METRICS else ""


def describe_runs(frame: pd.DataFrame, statistic: str, where: str) -> str:
    """Say how many runs a statistic rests on, and which share of them is feasible.

    frame: with the columns of `compute_summary`. where: the thing drawn for each group.
    """
    share = (100 * frame["feasible_runs"] / frame["runs"]).round()
    counted = _format_range(frame["runs"])
    if "n" in frame and (frame["n"] < frame["feasible_runs"]).any():
        counted = f"{_format_range(frame['n'])} of {counted}"
    runs = f"{statistic} of {counted} runs" if counted != "1" else "1 run"
    return f"{runs} per {where}, {_format_range(share)} % feasible"


def _format_range(numbers: pd.Series) -> str:
    """Return the range of whole numbers, such as "10 to 30", or the one number."""
    low, high = numbers.min(), numbers.max()
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"
