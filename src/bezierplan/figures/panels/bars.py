"""Grouped bars of a metric's statistic with its interval, the share or number of feasible runs below, and the shortest path as a line."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field

from bezierplan.figures import style
from bezierplan.figures.panels import RunsPanel
from bezierplan.figures.panels.lines import axis_label, summary
from bezierplan.schema.model import Column, Metric

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Metrics that the exact shortest length bounds from below.
_BOUNDED = ("length", "objective")

# Group names with more characters in total than this are broken at spaces, and before numbers.
_ONE_LINE = 40

# The share of a group's room that its bars take.
_FILLED = 0.84


class Options(RunsPanel):
    """Keys of a panel."""

    metric: Metric = Field(description="the name of a metric")
    x: Column = Field(description="a column of the runs table: a group of bars for each of its values")
    hue: Column = Field(description="a column of the runs table: a bar in each group for each of its values")
    statistic: Literal["mean", "median", "share"] = Field("mean", description="mean (left out: this), median or share")
    below: Literal["share", "count"] = Field(
        "share", description="of feasible runs, written below each bar: share (left out: this) or count"
    )


@Options.filled
def data(
    results: Results,
    *,
    x: str,
    hue: str,
    metric: str,
    statistic: Literal["mean", "median", "share"],
    below: Literal["share", "count"],
) -> pd.DataFrame:
    """One row per bar; columns: those of `lines.summary`, with x and hue by their own names, and bound.

    bound is the mean exact shortest length of the problems of a bar's feasible runs (those that count for a length), in units; empty for
    metrics that it does not bound.

    x: a column, with a group of bars for each of its values. hue: a column, with a bar in each group for each of its values. below: what is
    printed below a bar, the share or the number of feasible runs. Raises KeyError for an unknown metric or column.
    """
    import pandas as pd

    frame = summary(results, [x, hue], metric, statistic)
    feasible = results.runs[results.runs["feasible"]].sort_values("id")
    bounds = feasible.groupby([x, hue])["bound"].mean().rename("bound") if metric in _BOUNDED else pd.Series(dtype=float)
    return frame.assign(bound=[bounds.get(bar, np.nan) for bar in zip(frame[x], frame[hue])])


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, panel: dict) -> str:
    """Draw the rows of `data`; returns the note below the panel's title."""
    x, hue = panel["x"], panel["hue"]
    groups, bars = style.in_order(frame[x], panel), style.in_order(frame[hue], panel)
    width = _FILLED / len(bars)
    points = width / len(groups) * axes.get_window_extent().width * 72 / axes.figure.dpi
    lines = 1 if points >= style.SMALLEST_TEXT else 2  # under narrow bars every other number stands lower
    height = 9 if panel["below"] == "count" else 24
    for number, (bar, look) in enumerate(zip(bars, style.bars(len(bars)))):
        own = frame[frame[hue] == bar]
        at = own[x].map(groups.index).to_numpy() + (number - (len(bars) - 1) / 2) * width
        _draw_bars(axes, own, at, width, look | {"label": style.printed(bar, hue, scene.labels)})
        _write_below(axes, own, at, panel["below"], 2 + number % lines * height)
    axes.set_xlim(-0.5, len(groups) - 0.5)
    names = [scene.labels.get(group, group) if isinstance(group, str) else f"{group:g}" for group in groups]
    if sum(map(len, names)) > _ONE_LINE:
        names = [re.sub(r" |(?<=[a-z])(?=\d)", "\n", name) for name in names]
    axes.set_xticks(range(len(groups)), names)
    axes.tick_params(axis="x", length=0, pad=8 + lines * height)
    axes.set_xlabel(style.column_name(x, scene.labels))
    axes.set_ylabel(axis_label(panel["metric"], scene, panel["statistic"]))
    axes.grid(visible=True, axis="y")
    return f"below each bar: {panel['below']} of feasible runs"


def _draw_bars(axes: Axes, frame: pd.DataFrame, at: np.ndarray, width: float, look: dict) -> None:
    """Bars at places (n,) with their intervals."""
    axes.bar(at, frame["value"], width, zorder=2, **look)
    if frame["bound"].notna().any():
        ends = at - width / 2, at + width / 2
        axes.hlines(frame["bound"], *ends, label="exact shortest path", zorder=4, **style.BOUND)
    axes.vlines(at, frame["low95"], frame["high95"], color=style.BLACK, linewidth=0.8, zorder=3, label="95 % interval")


def _write_below(axes: Axes, frame: pd.DataFrame, at: np.ndarray, counted: str, distance: float) -> None:
    """Below each bar, at places (n,), the share or the count of feasible runs, at a distance in points."""
    for place, runs, feasible in zip(at, frame["runs"], frame["feasible_runs"]):
        below = {"xycoords": ("data", "axes fraction"), "xytext": (0, -distance), "textcoords": "offset points"}
        text = f"{feasible:g}" if counted == "count" else f"{100 * feasible / runs:.0f} %"
        axes.annotate(text, (place, 0), rotation=90, ha="center", va="top", **below)
