"""A metric's statistic as bars with intervals: a place for each value of one column, a bar at it
for each value of another, and the numbers that the paper prints.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field

from bezierplan.analysis.naming import list_in_order
from bezierplan.figures import style
from bezierplan.figures.groups import (
    compute_summary,
    describe_axis,
    describe_runs,
    find_published,
    show_metric,
)
from bezierplan.figures.panels import MetricPanel, Note
from bezierplan.schema.model import Column

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Metrics that the exact shortest length bounds from below.
_BOUNDED = ("length", "objective")

# Height of a panel, as a share of its width.
_HEIGHT = 0.45

# Width of all bars at a place, as a share of its room.
_WIDTH = 0.8

# This stands in the place of a bar.
_NO_PATH = "no free path"


class Options(MetricPanel):
    x: Column = Field(description="a column of the runs table: a place for each of its values")
    hue: Column = Field(
        description="a column of the runs table: a bar at each place for each of its values"
    )
    statistic: Literal["mean", "median", "share"] = Field(
        "mean", description="mean (left out: this), median or share"
    )


def data(results: Results, options: Options) -> pd.DataFrame:
    """Return one row per bar.

    Columns of `groups.compute_summary` come first, with x and hue by their own names, then bound
    and published. bound is the mean exact shortest length of the problems of a bar's feasible runs
    (those that count for a length), in units; it is empty for metrics that it does not bound.
    published is the printed number, if there is one.

    Raises KeyError for an unknown metric or column.
    """
    keys, metric, statistic = [options.x, options.hue], options.metric, options.statistic
    runs = results.runs.sort_values("id")
    bounds = runs[runs["feasible"] & (metric in _BOUNDED)].groupby(keys)["bound"].mean()
    theirs = [
        find_published(results._replace(runs=own), metric, options.printed, statistic)
        for _, own in runs.groupby(keys)
    ]
    frame = compute_summary(results, keys, metric, statistic).join(bounds, on=keys)
    return frame.assign(published=[next(iter(numbers), np.nan) for numbers in theirs])


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`, in the order of the panel's `where`."""
    x, hue, labels = options.x, options.hue, scene.labels
    places = list_in_order(frame[x], options.where)
    names = [labels.get(at, at) if isinstance(at, str) else f"{at:g}" for at in places]
    groups = style.list_groups(frame, hue, options, scene)
    width = _WIDTH / len(groups)
    for number, (_, rows, look) in enumerate(groups):
        at = rows[x].map(places.index) + width * (number + 0.5) - _WIDTH / 2
        if options.scale == "linear":
            axes.bar(at, rows["value"], width, color=look["color"], label=look["label"])
        else:  # the length of a bar would mean nothing
            axes.plot(at, rows["value"], zorder=3, **look | {"linestyle": ""})
        axes.vlines(at, rows["low95"], rows["high95"], color="0.1", linewidth=0.8, zorder=4)
        if rows["published"].notna().any():
            mark = style.PUBLISHED_MARK | {"markersize": 3.5, "zorder": 5}
            axes.plot(at, rows["published"], label="published", **mark)
        words = {"rotation": 90, "ha": "center", "va": "bottom", "color": look["color"]}
        for place in at[rows["value"].isna()]:
            axes.annotate(_NO_PATH, (place, 0.02), xycoords=("data", "axes fraction"), **words)
    axes.plot([], [], **style.INTERVAL)
    bounds = frame.groupby(x)["bound"].mean()[places].dropna()
    if options.context and len(bounds):
        middles = np.array([places.index(name) for name in bounds.index])
        label = "exact shortest path"
        axes.hlines(bounds, middles - 0.45, middles + 0.45, label=label, **style.BOUND)
    style.name_places(axes, names, describe_axis(x, scene))
    axes.set_xlim(-0.5, len(names) - 0.5)
    axes.set_box_aspect(_HEIGHT)
    show_metric(axes, options.metric, scene, options.statistic, options.scale)
    return Note("", describe_runs(frame, options.statistic, "bar"))
