"""Mean ranks of methods, each in a bar as long as Nemenyi's critical difference: methods whose bars
overlap cannot be distinguished.

Friedman's and Nemenyi's tests as in Demsar (2006); two mean ranks differ by more than the critical
difference if and only if bars of that length about them do not overlap.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from bezierplan.analysis import metrics, running_time
from bezierplan.figures import seen, style
from bezierplan.figures.panels import MayPrint, Note, RunsPanel
from bezierplan.schema.model import Metric, PrintedTable

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


_LEVEL = 0.05

# Height of a row, as a share of the panel's width.
_ROW = 0.085


class Options(MayPrint, RunsPanel):
    named_rows: ClassVar[bool] = True
    fewest_methods: ClassVar[int] = 3

    metric: Metric = Field(
        "objective", description="what is ranked, the name of a metric; left out: objective"
    )
    printed: PrintedTable = Field(
        None, description="the name of a published table whose mean ranks are shown as well"
    )
    unit: Literal["repeat", "problem"] = Field(
        "repeat",
        description="in what methods are ranked: each repeat of a condition (left out: this), or "
        "each problem, by the median run",
    )


def data(results: Results, options: Options) -> pd.DataFrame:
    """One row per rank; columns: method, part, value, methods and units (counts), chi2, p_value,
    difference.

    Parts: rank (the mean rank of a method, 1 for the lowest values; ties share the mean of their
    ranks), published (that of the paper). In a unit every method is ranked: a repeat of a condition
    or, with `problem`, a condition, by the lower median of its repeats. chi2 and p_value:
    Friedman's test; difference: Nemenyi's critical difference at 5 %.

    Raises ValueError for fewer than three methods, and if a unit lacks one.
    """
    import pandas as pd
    from scipy import stats

    metric, printed = options.metric, options.printed
    runs = results.runs.assign(value=metrics.values(results.runs, metric, results.problems))
    if options.unit == "problem":
        table = running_time.by_problem(runs, runs["value"].to_numpy())
    else:
        table = runs.pivot_table(
            index=["condition", "repeat"], columns="method", values="value", dropna=False
        )
    units, methods = table.shape
    if methods < 3 or table.isna().any(axis=None):
        raise ValueError(
            f"mean ranks need at least three methods with a {metric} in every repeat; found "
            f"{methods} in {units}"
        )
    ranks = pd.Series(
        stats.rankdata(table.to_numpy(), axis=1).mean(axis=0), index=table.columns
    ).sort_values(kind="stable")
    difference = stats.studentized_range.ppf(1 - _LEVEL, methods, np.inf) * math.sqrt(
        methods * (methods + 1) / (12 * units)
    )
    chi2, p_value = stats.friedmanchisquare(*table.to_numpy().T)
    rows = [{"method": method, "part": "rank", "value": rank} for method, rank in ranks.items()]
    if printed is not None and results.published is not None:
        theirs = results.published.query(
            "table == @printed and metric == 'rank' and method in @ranks.index"
        )
        rows += [
            {"method": row.method, "part": "published", "value": row.value}
            for row in theirs.itertuples()
        ]
    columns = ["method", "part", "value"]
    return (
        pd.DataFrame(rows)
        .reindex(columns=columns)
        .assign(methods=methods, units=units, chi2=chi2, p_value=p_value, difference=difference)
    )


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`, the best method on top."""
    tested = frame.iloc[0]
    ranks, printed = (
        frame[frame["part"] == "rank"],
        frame[frame["part"] == "published"].set_index("method")["value"],
    )
    methods, half = list(ranks["method"]), tested["difference"] / 2
    names = [scene.labels.get(method, method) for method in methods]
    bar = {"color": "0.6", "linewidth": 2.2, "zorder": 2, "label": "critical difference"}
    for row, (rank, look) in enumerate(zip(ranks["value"], style.lines(methods, scene.looks))):
        axes.plot([rank - half, rank + half], [row, row], **bar)
        axes.plot(rank, row, zorder=3, **look | {"markersize": 4.5})
    if len(printed):
        heights = [methods.index(method) for method in printed.index]
        axes.plot(printed, heights, label="published mean rank", zorder=4, **style.PUBLISHED_MARK)
    style.name_rows(axes, names)
    axes.set_xticks(range(1, len(methods) + 1))
    axes.set_box_aspect(0.1 + _ROW * len(methods))
    axes.set_xlabel("mean rank (1 is best)")
    chance = f"p = {tested['p_value']:.2g}" if tested["p_value"] >= 1e-4 else "p below 0.0001"
    units = "problems" if options.unit == "problem" else "repeats"
    words = (
        f"methods whose bars overlap cannot be distinguished: {tested['units']:g} {units}, "
        f"Friedman's chi-squared {tested['chi2']:.1f}"
    )
    return Note(
        "",
        f"{words}, {chance}; critical difference {tested['difference']:.2f}",
        seen.extremes("mean rank", dict(zip(names, ranks["value"]))),
    )
