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

from bezierplan.figures import glance, style
from bezierplan.figures.groups import by_problem, measured
from bezierplan.figures.panels import MetricPanel, Note
from bezierplan.schema.model import Metric

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


_LEVEL = 0.05

# Height of a row, as a share of the panel's width.
_ROW = 0.085


class Options(MetricPanel):
    fewest_methods: ClassVar[int] = 3

    metric: Metric = Field(
        "objective", description="what is ranked, the name of a metric; left out: objective"
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

    ranked = measured(results, options.metric)
    if options.unit == "problem":
        table = by_problem(ranked)
    else:
        table = ranked.runs.pivot(index=["condition", "repeat"], columns="method", values="value")
    units, methods = table.shape
    if methods < 3 or table.isna().any(axis=None):
        raise ValueError(
            f"mean ranks need at least three methods with a {options.metric} in every repeat; "
            f"found {methods} in {units}"
        )
    ranks = table.rank(axis=1).mean().sort_values(kind="stable")
    chi2, p_value = stats.friedmanchisquare(*table.to_numpy().T)
    quantile = stats.studentized_range.ppf(1 - _LEVEL, methods, np.inf)
    parts = [ranks.rename("value").reset_index().assign(part="rank")]
    if options.printed is not None and results.published is not None:
        theirs = results.published.query(
            "table == @options.printed and metric == 'rank' and method in @ranks.index"
        )
        parts.append(theirs[["method", "value"]].assign(part="published"))
    return pd.concat(parts, ignore_index=True)[["method", "part", "value"]].assign(
        methods=methods,
        units=units,
        chi2=chi2,
        p_value=p_value,
        difference=quantile * math.sqrt(methods * (methods + 1) / (12 * units)),
    )


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`, the best method on top."""
    test = frame.iloc[0]
    ranks = frame[frame["part"] == "rank"]
    methods, half = list(ranks["method"]), test["difference"] / 2
    bar = {"color": "0.6", "linewidth": 2.2, "zorder": 2, "label": "critical difference"}
    axes.hlines(range(len(methods)), ranks["value"] - half, ranks["value"] + half, **bar)
    for row, look in enumerate(style.lines(methods, scene.looks)):
        axes.plot(ranks["value"].iloc[row], row, zorder=3, **look)
    theirs = frame[frame["part"] == "published"]
    if len(theirs):
        label = "published mean rank"
        heights = theirs["method"].map(methods.index)
        axes.plot(theirs["value"], heights, label=label, zorder=4, **style.PUBLISHED_MARK)
    style.name_rows(axes, [scene.labels.get(method, method) for method in methods])
    axes.set_xticks(range(1, len(methods) + 1))
    axes.set_box_aspect(0.1 + _ROW * len(methods))
    axes.set_xlabel("mean rank (1 is best)")
    chance = f"p = {test['p_value']:.2g}" if test["p_value"] >= 1e-4 else "p below 0.0001"
    return Note(
        "",
        "methods whose bars overlap cannot be distinguished: "
        f"{test['units']:g} {options.unit}s, Friedman's chi-squared {test['chi2']:.1f}, {chance}; "
        f"critical difference {test['difference']:.2f}",
        glance.extremes("mean rank", ranks, "method", "value", scene.labels),
    )
