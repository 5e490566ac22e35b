"""A metric's statistic against a numeric factor, with its interval; or two
columns of a table against each other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.figures import style
from bezierplan.figures.groups import (
    compute_summary,
    describe_axis,
    describe_runs,
    find_published,
    show_metric,
)
from bezierplan.figures.panels import (
    MetricPanel,
    Note,
    RunsPanel,
    Sources,
    TablePanel,
    require_one,
)
from bezierplan.schema.model import (
    Column,
    ExperimentName,
    Function,
    Metric,
    NumberColumn,
    Where,
    build_error,
)

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# At most so many values, evenly spaced, each get a tick, and of a table a mark.
_FEW = 5

# Intervals of which none is longer than this share of the panel's height are not seen.
_SEEN = 0.02

# Above this many points, only the points are drawn: lines between jumping values would cover the
# panel.
_MOST_JOINED = 100


class Options(MetricPanel, TablePanel):
    """Keys of a panel of lines, which are of runs or of a table."""

    experiment: ExperimentName = Field(None, description="the name of an experiment")
    data: Function = Field(
        None,
        description="instead of experiment, the name of a function of the study's module that "
        "returns a table",
    )
    where: Where = Field(
        {}, description="column of the runs table or of the data → value or list of values"
    )
    x: NumberColumn = Field(description="a column of numbers of the runs table or of the data")
    metric: Metric = Field(description="the name of a metric, or of a column of the data")
    hue: Column = Field(
        None, description="a column of the runs table or of the data: a line for each of its values"
    )
    statistic: Literal["mean", "median", "share"] = Field(
        "mean", description="of runs: mean (left out: this), median or share"
    )

    @model_validator(mode="after")
    def _check_source(self) -> Options:
        """Refuse both or neither of experiment and data, and printed numbers of a table."""
        require_one(self, "experiment", "data")
        if self.printed is not None and self.experiment is None:
            raise build_error("printed: needs experiment")
        return self

    def source(self, sources: Sources) -> Results | pd.DataFrame:
        """Return the runs, or the rows of a table."""
        return (RunsPanel if self.experiment else TablePanel).source(self, sources)


def data(source: Results | pd.DataFrame, options: Options) -> pd.DataFrame:
    """Return one row per point.

    Columns: hue (if one is given) and x, both by their own names; part (statistic, published or
    value), value. Rows of runs have the columns of `groups.compute_summary` for the statistic. Rows
    of a table have the column `metric` as it is.

    Raises KeyError for an unknown metric or column.
    """
    import pandas as pd

    metric = options.metric
    keys = [options.x] if options.hue is None else [options.hue, options.x]
    if isinstance(source, pd.DataFrame):
        return source[[*keys, metric]].rename(columns={metric: "value"}).assign(part="value")
    theirs = [
        dict(zip(keys, key)) | {"part": "published", "value": value}
        for key, own in source.runs.groupby(keys)
        for value in find_published(source._replace(runs=own), metric, options.printed)
    ]
    ours = compute_summary(source, keys, metric, options.statistic).assign(part="statistic")
    return pd.concat([ours, pd.DataFrame(theirs)], ignore_index=True)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw a line for each value of hue, with intervals and published means if it is of runs."""
    hue, x, of_table = options.hue, options.x, options.experiment is None
    if hue is None:
        # The look of the method of all runs.
        methods = frame["method"].dropna().unique() if "method" in frame else []
        groups = [(None, frame, style.choose_line_styles(list(methods) or [""], scene.looks)[0])]
    else:
        groups = style.list_groups(frame, hue, options, scene)
    for _, rows, look in groups:
        if of_table:
            # The more points, the fewer marks.
            if len(rows) > _MOST_JOINED:
                look |= {"linestyle": "", "marker": ".", "markersize": 1.2}
            elif len(rows) > _FEW:
                look |= {"marker": ""}
            axes.plot(rows[x], rows["value"], **look)
            continue
        parts = dict(iter(rows.groupby("part")))
        _draw_statistic(axes, parts["statistic"], x, look)
        if "published" in parts:
            edge = style.PUBLISHED_MARK | {"markeredgecolor": look["color"]}
            axes.plot(*parts["published"][[x, "value"]].T.to_numpy(), zorder=5, **edge)
            axes.plot([], [], label="published mean", **style.PUBLISHED_MARK)
    values = np.unique(frame[x])
    if len(values) <= _FEW and len(set(np.diff(values))) <= 1:
        axes.set_xticks(values)
    elif (frame[x] % 1 == 0).all():
        axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel(describe_axis(x, scene))
    statistic = "" if of_table or frame["n"].max() < 2 else options.statistic
    axes.grid(visible=True)
    show_metric(axes, options.metric, scene, statistic, options.scale)
    if of_table:
        return Note()
    ours = frame[frame["part"] == "statistic"]
    # Only now: the scale of the axis decides how long an interval looks.
    ends = [
        axes.transData.transform(ours[[x, end]].to_numpy())[:, 1] for end in ("low95", "high95")
    ]
    if np.nanmax(np.diff(ends, axis=0), initial=0) > _SEEN * axes.bbox.height:
        axes.plot([], [], **style.INTERVAL)
    return Note("", describe_runs(ours, options.statistic, "point"))


def _draw_statistic(axes: Axes, frame: pd.DataFrame, x: str, look: dict) -> None:
    """Draw a line of marks with intervals.

    Marks are hollow for statistics of feasible runs alone if there are other runs, because a method
    that rarely succeeds may have the best mean.
    """
    axes.vlines(frame[x], frame["low95"], frame["high95"], color=look["color"], linewidth=0.8)
    axes.plot(frame[x], frame["value"], zorder=3, **look)
    partial = frame[(frame["feasible_runs"] < frame["runs"]) & (frame["n"] < frame["runs"])]
    if len(partial):
        hollow = look | {"linestyle": "", "markerfacecolor": style.FREE, "label": None}
        axes.plot(partial[x], partial["value"], zorder=3.1, **hollow)
        axes.plot([], [], label=style.HOLLOW_LABEL, **style.HOLLOW)
