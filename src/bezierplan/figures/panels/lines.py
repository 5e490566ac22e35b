"""A metric's statistic against a numeric factor, with its interval and single repeats; or two
columns of a table against each other.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis import metrics, statistics
from bezierplan.figures import seen, style
from bezierplan.figures.panels import MayPrint, Note, Sources, TablePanel, exactly_one
from bezierplan.schema.model import (
    Column,
    Experiment,
    Flag,
    Function,
    Metric,
    NumberColumn,
    PrintedTable,
    Quantity,
    Repeat,
    Where,
    listed,
    wrong,
)
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Where lines do not join points, the groups at one x take this share of the distance to the next.
_SPREAD = 0.7

# At most so many values, evenly spaced, each get a tick, and of a table a mark.
_FEW = 5

# Above this many points, only the points are drawn: lines between jumping values would cover the
# panel.
_MOST_JOINED = 100


class OfMetric:
    """What a panel that draws the numbers of its key `metric` says of them. It does not declare the
    key: each kind describes its own.
    """

    @property
    def measured(self) -> str | None:
        """The metric whose numbers are drawn."""
        return self.metric

    @property
    def timed(self) -> bool:
        """Whether these are seconds; a column of a table is no metric."""
        return self.metric in metrics.METRICS and metrics.unit(self.metric, "") == "s"


class Options(OfMetric, MayPrint, TablePanel):
    """Keys of a panel: of runs, or of a table."""

    experiment: Experiment = Field(None, description="the name of an experiment")
    data: Function = Field(
        None,
        description="in place of experiment, the name of a function of the study's module that "
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
    repeats: listed(Repeat) = Field(
        (), description="a list of whole numbers: single runs that are drawn in addition"
    )
    printed: PrintedTable = Field(
        None,
        description="of runs, the name of a published table whose means are marked at their places",
    )
    joined: Flag = Field(
        True,
        description="whether lines join points, true or false: false where x is a name in "
        "numbers, without order",
    )
    sorted_by: Quantity = Field(
        None,
        description="of runs, with joined: false, a column of numbers of the runs table: values of "
        "x stand in the order of its means, each at the same distance from the next",
    )

    @model_validator(mode="after")
    def _check_source(self) -> Options:
        exactly_one(self, "experiment", "data")
        if self.printed is not None and self.experiment is None:
            raise wrong("printed: needs experiment")
        if self.sorted_by is not None and (self.joined or self.experiment is None):
            raise wrong("sorted_by: needs experiment and joined: false")
        return self

    def source(self, sources: Sources) -> Results | pd.DataFrame:
        """Runs, or the rows of a table."""
        return (
            super().source(sources)
            if self.experiment is None
            else sources.runs(self.experiment, self.where)
        )


def data(source: Results | pd.DataFrame, options: Options) -> pd.DataFrame:
    """One row per point; columns: hue (if one is given) and x, both by their own names; part
    (statistic, repeat, published or value), value; with `sorted_by`, the place of x (0, 1, ...).

    For runs: the columns of `summary` for the statistic, and repeat, the number of a single run.
    For a table: the column `metric`, as is.

    Raises ValueError if a single repeat has several runs at one place, and KeyError for an unknown
    metric or column.
    """
    import pandas as pd

    metric, printed = options.metric, options.printed
    keys = [options.x] if options.hue is None else [options.hue, options.x]
    if isinstance(source, pd.DataFrame):
        return source[[*keys, metric]].rename(columns={metric: "value"}).assign(part="value")
    frame = summary(source, keys, metric, options.statistic).assign(part="statistic")
    single = source.runs[source.runs["repeat"].isin(options.repeats)]
    if single.duplicated([*keys, "repeat"]).any():
        raise ValueError(
            f"repeats: several runs of one repeat have equal {' and '.join(keys)}; see the "
            "panel's `where`"
        )
    values = metrics.values(source.runs, metric, source.problems).loc[single.index]
    thin = single[[*keys, "repeat"]].assign(value=values, part="repeat", **constants(source.runs))
    parts = [frame, thin.sort_values(["repeat", *keys])]
    if printed is not None and source.published is not None:
        marked = [
            dict(zip(keys, key)) | {"part": "published", "value": value}
            for key, own in source.runs.groupby(keys)
            for value in published(source, own, metric, table=printed)
        ]
        parts.append(pd.DataFrame(marked, columns=[*keys, "part", "value"]))
    drawn = pd.concat(parts, ignore_index=True)
    if options.sorted_by is None:
        return drawn
    means = source.runs.sort_values("id").groupby(options.x)[options.sorted_by].mean()
    places = means.rank(method="first").astype(int) - 1
    return drawn.assign(place=drawn[options.x].map(places))


def summary(results: Results, keys: list[str], metric: str, statistic: str) -> pd.DataFrame:
    """A statistic of a metric for each group of runs with equal keys.

    Columns: those of `constants`; the keys; runs and feasible_runs (counts), n (runs that have the
    metric), value, low95 and high95 (its 95 % bootstrap interval), in the metric's unit.
    """
    import pandas as pd

    runs = results.runs.assign(value=metrics.values(results.runs, metric, results.problems))
    rows = []
    for key, group in runs.groupby(keys):
        # Sorted, so that nothing depends on the order in which chunks are read.
        numbers = np.sort(group["value"].dropna().to_numpy())
        named = dict(zip(keys, key))
        name = "/".join(
            [metric, statistic, *(f"{column}={value}" for column, value in named.items())]
        )
        low, high = np.nan, np.nan
        if not metrics.METRICS[metric].of_group:
            low, high = statistics.interval(statistic, numbers, generator(name))
        value = statistics.statistic(statistic, numbers)
        found = {"n": len(numbers), "value": value, "low95": low, "high95": high}
        rows.append(constants(runs) | named | counts(group) | found)
    return pd.DataFrame(rows)


def constants(runs: pd.DataFrame) -> dict[str, Any]:
    """Problem and method of runs, where they share one."""
    return {
        column: runs[column].iloc[0]
        for column in ("problem", "method")
        if runs[column].nunique() == 1
    }


def counts(runs: pd.DataFrame) -> dict[str, int]:
    """How many runs there are, and how many of them are feasible."""
    return {"runs": len(runs), "feasible_runs": int(runs["feasible"].sum())}


# Reference lines: the exact shortest length, and the best known path of the methods' own kind.
LIMITS = {
    "reference": {**style.REFERENCE, "label": "best known path of the same kind"},
    "bound": {**style.BOUND, "label": "exact shortest path"},
}


def shared_limits(runs: pd.DataFrame) -> dict[str, float]:
    """Values of `LIMITS` that all runs share, by name."""
    return {
        name: runs[name].iloc[0]
        for name in LIMITS
        if name in runs and runs[name].notna().all() and runs[name].nunique() == 1
    }


def axis_label(column: str, scene: Any, statistic: str = "") -> str:
    """Name and unit of what an axis shows; a column other than a metric has its unit in its label,
    or is a count, or has no unit.
    """
    if column not in metrics.METRICS and style.column_name(column, scene.labels).endswith(")"):
        return f"{statistic} {style.column_name(column, scene.labels)}".lstrip()
    unit = metrics.unit(column, scene.unit) if column in metrics.METRICS else "-"
    return (
        f"{statistic} "
        f"{style.column_name(column, scene.labels)}{'' if unit == '-' else f' ({unit})'}"
    ).lstrip()


# Columns of published numbers that do not distinguish runs.
_PRINTED = ["table", "metric", "statistic", "n", "unit", "value"]


def published(
    results: Results,
    runs: pd.DataFrame,
    metric: str,
    statistic: str = "mean",
    table: str | None = None,
) -> list[float]:
    """Values of a metric's statistic that the paper prints for the problem, method and settings of
    runs, in any table or in one; a row's empty keys match all runs.

    A number that is of a part of the runs only, such as one of several problems, is none of theirs.
    One repeated in several tables counts once.
    """
    numbers = results.published
    if numbers is None:
        return []
    numbers = numbers[(numbers["metric"] == metric) & (numbers["statistic"] == statistic)]
    if table is not None:
        numbers = numbers[numbers["table"] == table]
    for column in numbers.columns.difference(_PRINTED):
        fits = (
            numbers[column].isin(runs[column].unique() if runs[column].nunique() == 1 else [])
            if column in runs
            else False
        )
        numbers = numbers[numbers[column].isna() | fits]
    return sorted(numbers["value"].unique())


def interval_band(axes: Axes, x: pd.Series, low: pd.Series, high: pd.Series, colour: str) -> None:
    """The interval of a line as a band in the line's colour."""
    from matplotlib.patches import Rectangle

    axes.fill_between(x, low, high, zorder=1.5, **style.interval_band(colour))
    axes.add_patch(Rectangle((0, 0), 0, 0, **style.INTERVAL_BAND))


def runs_note(frame: pd.DataFrame, statistic: str, where: str) -> str:
    """The number of runs behind a statistic, from the columns of `summary`, and the share of them
    that is feasible.
    """
    fewest, most = frame["runs"].min(), frame["runs"].max()
    share = 100 * frame["feasible_runs"] / frame["runs"]
    counted = _range(fewest, most)
    if "n" in frame and (frame["n"] < frame["feasible_runs"]).any():
        counted = f"{_range(frame['n'].min(), frame['n'].max())} of {counted}"
    return (
        f"{statistic} of {counted} runs per {where}, "
        f"{_range(round(share.min()), round(share.max()))} % feasible"
    )


def _range(low: float, high: float) -> str:
    """A range of whole numbers, as printed."""
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    hue, x = options.hue, options.x if options.sorted_by is None else "place"
    of_runs = options.experiment is not None
    statistic = options.statistic if of_runs else ""
    groups = [None] if hue is None else style.in_order(frame[hue], options.where)
    values = np.unique(frame[x])
    apart = min(np.diff(values), default=1)
    for number, (group, look) in enumerate(zip(groups, _looks(groups, frame, scene))):
        rows = frame if hue is None else frame[frame[hue] == group]
        named = {} if hue is None else {"label": style.printed(group, hue, scene.labels)}
        if not of_runs:
            axes.plot(rows[x], rows["value"], **_joined(look, len(rows)), **named)
            continue
        theirs = rows[rows["part"] == "published"]
        if len(theirs):
            edge = style.PUBLISHED_MARK | {"markeredgecolor": look["color"]}
            axes.plot(theirs[x], theirs["value"], zorder=5, **edge)
            axes.plot([], [], label="published mean", **style.PUBLISHED_MARK)
        if options.joined:
            bands = len(groups) <= style.MOST_BANDS
            _draw_statistic(axes, rows[rows["part"] == "statistic"], x, look | named, bands=bands)
            _draw_repeats(axes, rows[rows["part"] == "repeat"], x, look["color"])
        else:
            aside = _SPREAD * apart * ((number + 0.5) / len(groups) - 0.5)
            _draw_apart(axes, rows[rows["part"] == "statistic"], x, aside, look | named)
    if not options.joined or (len(values) <= _FEW and len(set(np.diff(values))) <= 1):
        axes.set_xticks(values)
    elif (frame[x] % 1 == 0).all():
        axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel(axis_label(options.x, scene))
    if options.sorted_by is not None:
        named = frame.drop_duplicates("place").sort_values("place")[options.x]
        axes.set_xticks(values, [f"{value:g}" for value in named])
        by = style.column_name(options.sorted_by, scene.labels)
        axes.set_xlabel(f"{axis_label(options.x, scene)}, sorted by {by}")
    axes.set_ylabel(axis_label(options.metric, scene, statistic))
    axes.grid(visible=True)
    ends = [frame[end] for end in ("value", "low95", "high95") if end in frame]
    style.fit(
        axes.yaxis,
        itertools.chain(*ends),
        [] if hue is None else frame.groupby(hue)["value"].median(),
        wide=options.metric in scene.wide,
    )
    if scene.milliseconds:
        style.in_milliseconds(axes.yaxis)
    if not of_runs:
        return Note()
    ours = frame[frame["part"] == "statistic"]
    return Note("", runs_note(ours, statistic, "point"), _seen(ours, scene, options))


def _seen(statistics: pd.DataFrame, scene: Any, options: Options) -> str:
    """Which line is lowest and highest at most places, or where the only line is."""
    name = f"{options.statistic} {style.column_name(options.metric, scene.labels)}"
    if options.hue is None:
        at = [style.printed(value, options.x, scene.labels) for value in statistics[options.x]]
        return seen.extremes(name, dict(zip(at, statistics["value"])))
    table = statistics.pivot(index=options.x, columns=options.hue, values="value")
    columns = [style.printed(value, options.hue, scene.labels) for value in table]
    return seen.mostly(name, table.set_axis(columns, axis=1))


def _looks(groups: list[Any], frame: pd.DataFrame, scene: Any) -> list[dict]:
    """Looks of lines; of the only line that of its method, if all its runs have one; of the exact
    shortest path that which it has everywhere.
    """
    if groups != [None]:
        exact = LIMITS["bound"]["label"]
        others = style.lines([group for group in groups if group != exact], scene.looks)
        return [
            {**style.BOUND, "marker": ""} if group == exact else others.pop(0) for group in groups
        ]
    methods = frame["method"].dropna().unique() if "method" in frame else []
    return (
        style.lines(list(methods), scene.looks)
        if len(methods) == 1
        else [style.OURS | {"marker": "o", "markersize": 3.5}]
    )


def _draw_statistic(axes: Axes, frame: pd.DataFrame, x: str, look: dict, *, bands: bool) -> None:
    """A line with marks, in a band that shows the interval of its points, or with a bar at each of
    them.
    """
    if bands:
        interval_band(axes, frame[x], frame["low95"], frame["high95"], look["color"])
    else:
        _draw_bars(axes, frame[x], frame, look["color"])
    axes.plot(frame[x], frame["value"], zorder=3, **look)
    _draw_hollow(axes, frame[x], frame, look)


def _draw_hollow(axes: Axes, places: pd.Series, frame: pd.DataFrame, look: dict) -> None:
    """Open the marks of statistics of the feasible runs alone, where there are others: a method
    that rarely succeeds may have the best mean.
    """
    partial = (frame["feasible_runs"] < frame["runs"]) & (frame["n"] < frame["runs"])
    if not partial.any():
        return
    hollow = look | {"linestyle": "", "markerfacecolor": style.FREE, "label": None}
    axes.plot(places[partial], frame["value"][partial], zorder=3.1, **hollow)
    axes.plot([], [], label="hollow: some runs are not feasible", **style.HOLLOW)


def _draw_apart(axes: Axes, frame: pd.DataFrame, x: str, aside: float, look: dict) -> None:
    """Marks without a line, each with its interval, shifted so that groups are side by side."""
    places = frame[x] + aside
    _draw_bars(axes, places, frame, look["color"])
    axes.plot(places, frame["value"], zorder=3, **look | {"linestyle": ""})
    _draw_hollow(axes, places, frame, look)


def _draw_bars(axes: Axes, places: pd.Series, frame: pd.DataFrame, colour: str) -> None:
    """The interval of each statistic as a bar."""
    axes.vlines(places, frame["low95"], frame["high95"], color=colour, linewidth=0.8, zorder=2)
    axes.plot([], [], **style.INTERVAL)


def _draw_repeats(axes: Axes, frame: pd.DataFrame, x: str, colour: str) -> None:
    """A thin line for each single repeat, all alike: they show how far runs scatter."""
    look = {"color": colour, "alpha": 0.6, "linewidth": 0.5, "linestyle": (0, (2, 1.5))}
    for _, own in frame.groupby("repeat"):
        axes.plot(own[x], own["value"], zorder=1.8, label="single runs", **look)


def _joined(look: dict, points: int) -> dict:
    """The style of a line through the given number of points of a table: few are marked."""
    if points > _MOST_JOINED:
        return look | {"linestyle": "", "marker": ".", "markersize": 1.2}
    return look if points <= _FEW else look | {"marker": ""}
