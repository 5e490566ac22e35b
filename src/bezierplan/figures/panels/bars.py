"""A metric's statistic as bars with intervals, for the values of one column, side by side for those
of another; with the numbers that the paper prints.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field

from bezierplan.figures import glance, style
from bezierplan.figures.groups import axis_label, published, runs_note, summary, unit_of
from bezierplan.figures.panels import MetricPanel, Note
from bezierplan.schema.model import Column

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Metrics that the exact shortest length bounds from below.
_BOUNDED = ("length", "objective")

# Of a panel, as a share of its width.
_HEIGHT = 0.45

# Of the bars at a place, as a share of its room.
_WIDTH = 0.8


class Options(MetricPanel):
    x: Column = Field(description="a column of the runs table: a place for each of its values")
    hue: Column = Field(
        description="a column of the runs table: a bar at each place for each of its values"
    )
    statistic: Literal["mean", "median", "share"] = Field(
        "mean", description="mean (left out: this), median or share"
    )


def data(results: Results, options: Options) -> pd.DataFrame:
    """One row per bar; columns: those of `groups.summary`, with x and hue by their own names,
    bound, and published.

    bound is the mean exact shortest length of the problems of a bar's feasible runs (those that
    count for a length), in units; empty for metrics that it does not bound. published is the number
    that the paper prints, if it prints one.

    Raises KeyError for an unknown metric or column.
    """
    keys, metric, statistic = [options.x, options.hue], options.metric, options.statistic
    frame = summary(results, keys, metric, statistic)
    runs = results.runs.sort_values("id")
    groups = dict(iter(runs.groupby(keys)))
    bounds = runs[runs["feasible"]].groupby(keys)["bound"].mean() if metric in _BOUNDED else {}
    bars = list(zip(frame[options.x], frame[options.hue]))
    theirs = [
        published(results._replace(runs=groups[bar]), metric, options.printed, statistic)
        for bar in bars
    ]
    return frame.assign(
        bound=[bounds.get(bar, np.nan) for bar in bars],
        published=[next(iter(numbers), np.nan) for numbers in theirs],
    )


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`, in the order of the panel's `where`."""
    import seaborn as sns

    x, hue, labels = options.x, options.hue, scene.labels
    places = style.in_order(frame[x], options.where)
    names = [labels.get(at, at) if isinstance(at, str) else f"{at:g}" for at in places]
    groups = style.groups(frame, hue, options.where, scene)
    # By their printed names: as numbers, seaborn would not find them again.
    named = frame.assign(
        x=frame[x].map(dict(zip(places, names))),
        hue=frame[hue].map({value: look["label"] for value, _, look in groups}),
    )
    colours = {look["label"]: look["color"] for _, _, look in groups}
    layout = {"x": "x", "hue": "hue", "order": names, "hue_order": list(colours), "ax": axes}
    layout["legend"] = False
    # Each statistic with the ends of its interval: their median and their range.
    long = named.melt(["x", "hue"], ["value", "low95", "high95"], value_name="end")
    error = {"errorbar": ("pi", 100), "err_kws": {"linewidth": 0.8, "color": "0.1"}}
    if options.scale == "linear":
        sns.barplot(
            long, y="end", estimator="median", palette=colours, saturation=1, **layout, **error
        )
        for label, colour in colours.items():
            axes.bar(0, 0, color=colour, label=label)
    else:  # the length of a bar would mean nothing
        marks = [look["marker"] for _, _, look in groups]
        dodge = _WIDTH * (1 - 1 / len(groups))
        sns.pointplot(
            long,
            y="end",
            estimator="median",
            palette=colours,
            linestyle="none",
            markers=marks,
            markersize=4,
            dodge=dodge,
            **layout,
            **error,
        )
        for label, mark in zip(colours, marks):
            axes.plot([], [], **style.mark(mark, 4, colours[label], label=label))
    for place, bar in named[named["value"].isna()][["x", "hue"]].itertuples(index=False):
        shift = (list(colours).index(bar) + 0.5) / len(colours) - 0.5
        axes.text(
            names.index(place) + _WIDTH * shift,
            0.02,
            "no free path",
            transform=axes.get_xaxis_transform(),
            rotation=90,
            ha="center",
            va="bottom",
            color=colours[bar],
        )
    if frame["published"].notna().any():
        mark = {"marker": "D", "edgecolor": style.BLACK, "linewidth": 0.9, "size": 3.5}
        white = dict.fromkeys(colours, style.FREE)
        sns.stripplot(
            named, y="published", palette=white, dodge=True, jitter=False, **layout, **mark
        )
        axes.plot([], [], label="published", **style.PUBLISHED_MARK)
    axes.plot([], [], **style.INTERVAL)
    bounds = frame.groupby(x)["bound"].mean()[places].dropna()
    if options.context and len(bounds):
        middles = np.array([places.index(name) for name in bounds.index])
        label = "exact shortest path"
        axes.hlines(bounds, middles - 0.45, middles + 0.45, label=label, **style.BOUND)
    style.name_places(axes, names, axis_label(x, scene))
    axes.set_xlim(-0.5, len(names) - 0.5)
    axes.set_box_aspect(_HEIGHT)
    axes.set_ylabel(axis_label(options.metric, scene, options.statistic))
    style.measure(axes.yaxis, options.scale, unit_of(options.metric, scene))
    metric = f"{options.statistic} {style.column_name(options.metric, labels)}"
    return Note(
        "",
        runs_note(frame, options.statistic, "bar"),
        glance.mostly(metric, frame, x, hue, labels),
    )
