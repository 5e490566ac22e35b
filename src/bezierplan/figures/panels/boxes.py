"""Boxes of a metric, one per method or value of a factor, with the published means."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from pydantic import Field

from bezierplan.analysis import metrics
from bezierplan.figures import seen, style
from bezierplan.figures.panels import Note, RunsPanel
from bezierplan.figures.panels.lines import (
    LIMITS,
    OfMetric,
    axis_label,
    constants,
    counts,
    published,
    runs_note,
    shared_limits,
)
from bezierplan.schema.model import Column, Flag, Metric, Number
from bezierplan.schema.words import amount

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Whiskers end at the last value within this many interquartile ranges of the box.
_REACH = 1.5

# Names of the parts of a box here and in `Axes.bxp`.
_PARTS = {"low": "whislo", "quartile1": "q1", "median": "med", "quartile3": "q3", "high": "whishi"}


# Published means farther away than this many times the range of our values are drawn at the edge,
# with their value.
_FAR = 0.25

# So that a number can be read where it lies on a whisker.
_BEHIND_TEXT = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6}


class Options(OfMetric, RunsPanel):
    named_rows: ClassVar[bool] = True
    published_drawn: ClassVar[bool] = True

    metric: Metric = Field(description="the name of a metric")
    by: Column = Field(
        "method",
        description="a column of the runs table: a box for each of its values; left out: method",
    )
    limits: Flag = Field(
        False, description="whether the exact bound and the reference are drawn, true or false"
    )
    limit: Number = Field(None, description="the published limit of the metric, a number")


def data(results: Results, options: Options) -> pd.DataFrame:
    """One row per part of a box; columns: those of `lines.constants`, `by` by its own name, runs
    and feasible_runs (counts), part, value.

    Parts: low and high (where the whiskers end), quartile1, median, quartile3; beyond, a value
    beyond the whiskers; mean; published, the mean that the paper prints, and published_end, the
    least and the largest value that it prints. Values are in the metric's unit, for runs that have
    the metric. A group without such runs has a row: none. Rows without a group: limit; and, with
    limits, reference (the best known path of the kind) and bound (the exact shortest length), each
    if all runs share it.

    Raises KeyError for an unknown metric or column.
    """
    import pandas as pd

    metric, by = options.metric, options.by
    runs = results.runs.assign(value=metrics.values(results.runs, metric, results.problems))
    rows = []
    for group, group_runs in runs.groupby(by):
        named = constants(runs) | {by: group} | counts(group_runs)
        parts = _box(np.sort(group_runs["value"].dropna().to_numpy())) or [("none", np.nan)]
        for part, statistic in (
            ("published", "mean"),
            ("published_end", "min"),
            ("published_end", "max"),
        ):
            parts += [(part, value) for value in published(results, group_runs, metric, statistic)]
        rows += [named | {"part": part, "value": value} for part, value in parts]
    if options.limits:
        rows += [
            constants(runs) | {"part": name, "value": value}
            for name, value in shared_limits(runs).items()
        ]
    if options.limit is not None:
        rows.append(constants(runs) | {"part": "limit", "value": options.limit})
    return pd.DataFrame(rows)


def _box(values: np.ndarray) -> list[tuple[str, float]]:
    """Parts of the box of sorted values (n,) and their positions; none without values."""
    if not len(values):
        return []
    first, median, third = np.quantile(values, [0.25, 0.5, 0.75])
    reach = _REACH * (third - first)
    inside = (values >= first - reach) & (values <= third + reach)
    low, high = values[inside][[0, -1]]
    box = [
        ("low", low),
        ("quartile1", first),
        ("median", median),
        ("quartile3", third),
        ("high", high),
        ("mean", values.mean()),
    ]
    return box + [("beyond", value) for value in values[~inside]]


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`, the first box on top."""
    by = options.by
    groups = style.in_order(frame[by], options.where)
    boxes = [
        frame[frame[by] == group].groupby("part")["value"].apply(list).to_dict() for group in groups
    ]
    _draw_boxes(axes, boxes)
    for name, look in LIMITS.items():
        for value in frame.loc[frame["part"] == name, "value"]:
            axes.axvline(value, zorder=1.5, **look)
    for value in frame.loc[frame["part"] == "limit", "value"]:
        label = f"published limit: {amount(format(value, 'g'), scene.unit)}"
        axes.axvline(value, zorder=1.5, label=label, **style.PUBLISHED)
    axes.set_xlabel(axis_label(options.metric, scene))
    medians = frame.loc[frame["part"] == "median", "value"]
    # Labels such as 0.0025 would touch each other.
    axes.locator_params(axis="x", nbins=4, steps=[1, 2, 5, 10])
    # A far outlier would compress all boxes.
    spread = [*medians[medians > 0], frame["value"].max()]
    if options.metric in scene.wide or style.is_wide(spread):
        style.fit(axes.xaxis, frame["value"], spread, near_zero=True, wide=True)
        far = set()
    else:
        far = _draw_far(axes, boxes, frame.loc[frame["part"].isin(list(LIMITS)), "value"].to_list())
    marks = {
        "beyond": style.mark(".", 1.6, style.BLUE, alpha=0.6, label="outlier", zorder=1),
        "mean": style.mark("x", 4, style.RED, label="mean", zorder=4),
        "published_end": style.mark(
            "|", 9, style.BLACK, label="published minimum and maximum", zorder=5
        ),
        "published": style.PUBLISHED_MARK
        | {"clip_on": False, "label": "published mean", "zorder": 5},
    }
    for part, look in marks.items():
        points = [
            (value, height)
            for height, parts in enumerate(boxes)
            for value in parts.get(part, [])
            if value not in far
        ]
        if points:
            axes.plot(*zip(*points), **look)
    of_feasible = metrics.METRICS[options.metric].feasible_only
    for height, parts in enumerate(boxes):
        if "none" in parts:
            words = "no feasible run" if of_feasible else "no value"
            middle = {"ha": "center", "va": "center_baseline"}
            axes.text(0.5, height, words, transform=axes.get_yaxis_transform(), **middle)
    names = [style.printed(group, by, scene.labels) for group in groups]
    partial = {}
    if of_feasible:
        partial = _partial_shares(frame.dropna(subset=[by]).groupby(by).first())
    rows = [
        f"{name} ({partial[group]})" if group in partial else name
        for name, group in zip(names, groups)
    ]
    style.name_rows(axes, rows, 0.6)
    if scene.milliseconds:
        style.in_milliseconds(axes.xaxis)
    told = runs_note(frame, "box", "method" if by == "method" else "row")
    if axes.get_xscale() == "symlog":
        told += "; the axis is linear up to the first number after 0, then logarithmic"
    if partial:
        told += "; in parentheses: share of feasible runs, below 100 %"
    middles = [parts.get("median", [np.nan])[0] for parts in boxes]
    return Note("", told, seen.extremes("median", dict(zip(names, middles))))


def _partial_shares(counts: pd.DataFrame) -> dict[Any, str]:
    """The share of feasible runs of each group that has others: the box is of them alone.

    counts: by group, with runs and feasible_runs.
    """
    some = counts[counts["feasible_runs"] < counts["runs"]]
    # Rounded down, so that none is printed as all.
    shares = np.floor(100 * some["feasible_runs"] / some["runs"])
    return {group: f"{share:g} %" for group, share in shares.items()}


def _draw_far(axes: Axes, groups: list[dict[str, list[float]]], limits: list[float]) -> set[float]:
    """Mark published means that would compress the boxes at the edge of the scale that they lie
    beyond, and return them.

    groups: values by part. limits: other values that are shown.
    """
    values_shown = limits + [
        value
        for parts in groups
        for part, values in parts.items()
        if part != "published"
        for value in values
    ]
    if not values_shown:
        return set()
    low, high = min(values_shown), max(values_shown)
    reach = _FAR * (high - low)
    far = set()
    for height, parts in enumerate(groups):
        for above in (False, True):
            beyond = sorted(
                value
                for value in parts.get("published", [])
                if (value > high + reach if above else value < low - reach)
            )
            if not beyond:
                continue
            far.update(beyond)
            # Several, of several conditions, by their range: one text each would lie on the other.
            told = " to ".join(dict.fromkeys(f"{value:.4g}" for value in (beyond[0], beyond[-1])))
            # On the right, beside the panel, where they hide no data; on the left are the names of
            # the rows.
            at = {
                "xycoords": ("axes fraction", "data"),
                "textcoords": "offset points",
                "xytext": (7, 0),
                "va": "center",
                "ha": "left",
            }
            behind = None if above else _BEHIND_TEXT
            axes.annotate(told, (1.0 if above else 0.0, height), zorder=5, bbox=behind, **at)
            edge = style.PUBLISHED_MARK | {
                "marker": ">" if above else "<",
                "label": "published mean, off the scale",
            }
            place = {"transform": axes.get_yaxis_transform(), "clip_on": False, "zorder": 5}
            axes.plot(1.0 if above else 0.0, height, **place, **edge)
    if far:
        # Ends of the scale: the threshold for far means, if there are any; otherwise everything
        # shown, with a small margin.
        shown = values_shown + [
            value for parts in groups for value in parts.get("published", []) if value not in far
        ]
        room = 0.05 * (high - low)
        axes.set_xlim(
            low - reach if min(far) < low else min(shown) - room,
            high + reach if max(far) > high else max(shown) + room,
        )
    return far


def _draw_boxes(axes: Axes, groups: list[dict[str, list[float]]]) -> None:
    """One box per group of values by part, at heights 0, 1, ..."""
    there = {height: parts for height, parts in enumerate(groups) if "median" in parts}
    boxes = [{name: parts[part][0] for part, name in _PARTS.items()} for parts in there.values()]
    thin = {"color": style.BLUE, "linewidth": 0.7}
    looks = {
        "boxprops": style.BOX,
        "whiskerprops": thin,
        "capprops": thin,
        "medianprops": {"color": style.BLUE, "linewidth": 1.6},
    }
    axes.bxp(
        boxes,
        list(there),
        orientation="horizontal",
        widths=0.6,
        patch_artist=True,
        showfliers=False,
        manage_ticks=False,
        **looks,
    )
