"""Boxes of a metric, one per method or value of a factor, with the published means."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field

from bezierplan.analysis import naming
from bezierplan.figures import style
from bezierplan.figures.groups import (
    LIMITS,
    add_metric,
    collect_rows,
    describe_axis,
    describe_runs,
    find_constants,
    find_limits,
    find_published,
    list_values,
    show_metric,
)
from bezierplan.figures.panels import MetricPanel, Note
from bezierplan.running.columns import Row
from bezierplan.schema.model import Column, Number

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Whiskers end at the last value within this many interquartile ranges of the box: Tukey's rule, the
# usual one of matplotlib and seaborn.
_REACH = 1.5

# Parts of a box, of which seaborn makes the same box, and those that are marks.
_BOX = ["low", "quartile1", "median", "quartile3", "high"]
_MARKS = {
    "beyond": style.build_mark_style(".", 1.6, style.BLUE, alpha=0.6, label="outlier", zorder=1),
    "mean": style.build_mark_style("x", 4, style.RED, label="mean", zorder=4),
    "published_end": style.build_mark_style(
        "_", 9, style.BLACK, label="published minimum and maximum", zorder=5
    ),
    "published": style.PUBLISHED_MARK | {"label": "published mean", "zorder": 5},
}


class Options(MetricPanel):
    by: Column = Field(
        "method",
        description="a column of the runs table: a box for each of its values; left out: method",
    )
    limit: Number = Field(None, description="the published limit of the metric, a number")


def data(results: Results, options: Options) -> pd.DataFrame:
    """Return one row per part of a box.

    Columns of `groups.collect_rows` by `by` come first, then part and value. Parts: low and high
    (ends of whiskers), quartile1, median, quartile3; beyond, a value beyond the whiskers; mean;
    published, the mean that the paper prints, and published_end, the least and the largest value
    that it prints. Values are in the metric's unit, of runs that have the metric. A group that has
    no such run has one row with the part none. Rows of no group: limit; and, with context,
    reference (the best known path of the kind) and bound (the exact shortest length), each if all
    runs share it.

    Raises KeyError for an unknown metric or column.
    """
    import pandas as pd

    def list_rows(group: Results) -> Iterable[Row]:
        parts = _compute_box(list_values(group)) or [("none", np.nan)]
        for part, statistic in (
            ("published", "mean"),
            ("published_end", "min"),
            ("published_end", "max"),
        ):
            theirs = find_published(group, options.metric, options.printed, statistic)
            parts += [(part, value) for value in theirs]
        return [{"part": part, "value": value} for part, value in parts]

    lines = find_limits(results.runs) if options.context else {}
    if options.limit is not None:
        lines["limit"] = options.limit
    shared = find_constants(results.runs)
    boxes = collect_rows(add_metric(results, options.metric), [options.by], list_rows)
    alone = pd.DataFrame([shared | {"part": part, "value": value} for part, value in lines.items()])
    return pd.concat([boxes, alone], ignore_index=True) if lines else boxes


def _compute_box(numbers: np.ndarray) -> list[tuple[str, float]]:
    """Compute the parts of the box of sorted values (n,), none if there are no values."""
    if not len(numbers):
        return []
    first, median, third = np.quantile(numbers, [0.25, 0.5, 0.75])
    reach = _REACH * (third - first)
    inside = (numbers >= first - reach) & (numbers <= third + reach)
    low, high = numbers[inside][[0, -1]]
    box = zip([*_BOX, "mean"], [low, first, median, third, high, numbers.mean()])
    return [*box, *(("beyond", value) for value in numbers[~inside])]


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`, the boxes side by side."""
    import seaborn as sns

    by = options.by
    order = naming.list_in_order(frame[by], options.where)
    look = {"color": style.LIGHT_BLUE, "linecolor": style.BLUE, "linewidth": 0.7, "width": 0.6}
    box = frame[frame["part"].isin(_BOX)]
    # The rows are the five numbers of each box: of these seaborn must find no outliers (`whis`).
    with warnings.catch_warnings(action="ignore"):  # seaborn passes what matplotlib will drop
        sns.boxplot(box, x=by, y="value", order=order, whis=(0, 100), ax=axes, **look)
    places = frame[by].map(order.index, na_action="ignore")
    style.draw_parts(axes, frame.assign(x=places, y=frame["value"]), _MARKS)
    for part, own in frame.groupby("part")["value"]:
        if part in LIMITS:
            axes.axhline(own.iloc[0], zorder=1.5, **LIMITS[part])
    if options.limit is not None:
        label = f"published limit: {naming.format_amount(format(options.limit, 'g'), scene.unit)}"
        axes.axhline(options.limit, zorder=1.5, label=label, **style.PUBLISHED)
    names = [naming.format_value(group, by, scene.labels) for group in order]
    style.name_places(axes, names, describe_axis(by, scene))
    show_metric(axes, options.metric, scene, scale=options.scale)
    where = "method" if by == "method" else "place"
    return Note("", describe_runs(frame.dropna(subset=[by]), "box", where))
