"""A metric's statistic with its interval as dots, in rows for the values of one column, side by
side for those of another.

The shortest path is a line. A dot is hollow if not all of its runs are feasible, and a cross at the
edge stands for no feasible run.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from bezierplan.figures import seen, style
from bezierplan.figures.panels import Note, RunsPanel
from bezierplan.figures.panels.lines import OfMetric, axis_label, published, runs_note, summary
from bezierplan.schema.model import Column, Metric

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Metrics that the exact shortest length bounds from below.
_BOUNDED = ("length", "objective")

# The share of a row that its dots take.
_FILLED = 0.8

# Height of a row, and of each of its dots, as a share of the panel's width.
_ROW, _DOT = 0.035, 0.014

_NONE = style.mark("x", 3.5, style.BLACK)


class Options(OfMetric, RunsPanel):
    named_rows: ClassVar[bool] = True
    published_drawn: ClassVar[bool] = True

    metric: Metric = Field(description="the name of a metric")
    x: Column = Field(description="a column of the runs table: a row for each of its values")
    hue: Column = Field(
        description="a column of the runs table: a dot in each row for each of its values"
    )
    statistic: Literal["mean", "median", "share"] = Field(
        "mean", description="mean (left out: this), median or share"
    )


def data(results: Results, options: Options) -> pd.DataFrame:
    """One row per dot; columns: those of `lines.summary`, with x and hue by their own names, bound,
    and published.

    bound is the mean exact shortest length of the problems of a dot's feasible runs (those that
    count for a length), in units; empty for metrics that it does not bound. published is the number
    that the paper prints, if it prints one.

    Raises KeyError for an unknown metric or column.
    """
    import pandas as pd

    x, hue, metric, statistic = options.x, options.hue, options.metric, options.statistic
    frame = summary(results, [x, hue], metric, statistic)
    feasible = results.runs[results.runs["feasible"]].sort_values("id")
    bounds = (
        feasible.groupby([x, hue])["bound"].mean().rename("bound")
        if metric in _BOUNDED
        else pd.Series(dtype=float)
    )
    printed = {
        dot: next(iter(published(results, own, metric, statistic)), np.nan)
        for dot, own in results.runs.groupby([x, hue])
    }
    dots = list(zip(frame[x], frame[hue]))
    return frame.assign(
        bound=[bounds.get(dot, np.nan) for dot in dots], published=[printed[dot] for dot in dots]
    )


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`, the first one on top."""
    x, hue = options.x, options.hue
    rows, dots = style.in_order(frame[x], options.where), style.in_order(frame[hue], options.where)
    axes.set_xlabel(axis_label(options.metric, scene, options.statistic))
    style.name_rows(
        axes, [scene.labels.get(row, row) if isinstance(row, str) else f"{row:g}" for row in rows]
    )
    axes.set_box_aspect(0.1 + (_ROW + _DOT * len(dots)) * len(rows))
    style.separate_rows(axes, len(rows))
    for number, (dot, look) in enumerate(zip(dots, style.lines(dots, scene.looks))):
        own = frame[frame[hue] == dot]
        at = own[x].map(rows.index).to_numpy() + _FILLED * ((number + 0.5) / len(dots) - 0.5)
        _draw_dots(
            axes, own, at, look | {"label": style.printed(dot, hue, scene.labels), "linestyle": ""}
        )
    axes.autoscale_view(scaley=False)
    style.fit(
        axes.xaxis,
        itertools.chain(*(frame[end] for end in ("value", "low95", "high95", "published"))),
        frame.groupby(hue)["value"].median(),
        wide=options.metric in scene.wide,
    )
    if scene.milliseconds:
        style.in_milliseconds(axes.xaxis)
    bounds = frame[frame["bound"].notna()].groupby(x)["bound"].mean()
    for row, bound in bounds.items():
        ends = rows.index(row) - 0.45, rows.index(row) + 0.45
        axes.vlines(bound, *ends, label="exact shortest path", zorder=1.5, **style.BOUND)
    table = frame.pivot(index=x, columns=hue, values="value")
    names = [style.printed(value, hue, scene.labels) for value in table]
    metric = f"{options.statistic} {style.column_name(options.metric, scene.labels)}"
    told = runs_note(frame, options.statistic, "dot")
    return Note("", told, seen.mostly(metric, table.set_axis(names, axis=1)))


def _draw_dots(axes: Axes, frame: pd.DataFrame, at: np.ndarray, look: dict) -> None:
    """Dots at heights (n,) with their intervals, and the published numbers."""
    thin = {"color": look["color"], "linewidth": 0.8}
    axes.hlines(at, frame["low95"], frame["high95"], zorder=3, **thin)
    axes.plot([], [], **style.INTERVAL)
    whole = (frame["feasible_runs"] == frame["runs"]).to_numpy()
    axes.plot(frame["value"][whole], at[whole], zorder=4, **look)
    none = frame["value"].isna().to_numpy()
    if not (whole | none).all():
        hollow = look | {"markerfacecolor": style.FREE, "label": None}
        axes.plot(frame["value"][~whole], at[~whole], zorder=4, **hollow)
        axes.plot([], [], label="hollow: some runs are not feasible", **style.HOLLOW)
    if none.any():
        at_edge = {"transform": axes.get_yaxis_transform(), "clip_on": False, "zorder": 4}
        axes.plot(np.ones(none.sum()), at[none], **_NONE | at_edge | {"color": look["color"]})
        axes.plot([], [], label="no feasible run", **_NONE)
    if frame["published"].notna().any():
        axes.plot(frame["published"], at, label="published", zorder=5, **style.PUBLISHED_MARK)
