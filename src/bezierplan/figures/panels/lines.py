"""A metric's statistic against a numeric factor, with its interval and single repeats; or two columns of a table against each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis import metrics, statistics
from bezierplan.figures import style
from bezierplan.figures.panels import TablePanel, exactly_one
from bezierplan.schema.model import Column, Experiment, Flag, Function, Metric, NumberColumn, Repeat, Where, listed
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Where lines do not join points, the groups at one x take this share of the distance to the next.
_SPREAD = 0.7

# Shares above points take this part of a panel's height.
_ROOM = 0.15

# At most so many values, evenly spaced, each get a tick.
_FEW = 5

# Above this many points, only the points are drawn: lines between jumping values would cover the panel.
_MOST_JOINED = 100


class Options(TablePanel):
    """Keys of a panel: of runs, or of a table."""

    experiment: Experiment = Field(None, description="the name of an experiment")
    data: Function = Field(None, description="in place of experiment, the name of a function of the study's module that returns a table")
    where: Where = Field({}, description="column of the runs table or of the data → value or list of values")
    x: NumberColumn = Field(description="a column of numbers of the runs table or of the data")
    metric: Metric = Field(description="the name of a metric, or of a column of the data")
    hue: Column = Field(None, description="a column of the runs table or of the data: a line for each of its values")
    statistic: Literal["mean", "median", "share"] = Field("mean", description="of runs: mean (left out: this), median or share")
    repeats: listed(Repeat) = Field((), description="a list of whole numbers: single runs that are drawn besides")
    shares: Flag = Field(False, description="of runs: whether each point shows the share of its runs that is feasible, true or false")
    joined: Flag = Field(True, description="whether lines join points, true or false: false where x is a name in numbers, without order")

    @model_validator(mode="after")
    def _check_source(self) -> Options:
        exactly_one(self, "experiment", "data")
        return self


@Options.filled
def data(
    source: Results | pd.DataFrame,
    *,
    x: str,
    metric: str,
    statistic: Literal["mean", "median", "share"],
    hue: str | None,
    repeats: Sequence[int],
    shares: bool,
    joined: bool,
) -> pd.DataFrame:
    """One row per point; columns: hue (if one is given) and x, both by their own names; part (statistic, repeat or value), value.

    For runs: the columns of `summary` for the statistic, and repeat, the number of a single run. For a table: the column `metric`, as is.

    x: a numeric column. hue: a column, with a line for each of its values. repeats: the single runs to draw as well. shares: whether points
    show the share of feasible runs. joined: whether lines join points. Raises ValueError if a single repeat has several runs at one place,
    and KeyError for an unknown metric or column.
    """
    import pandas as pd

    keys = [x] if hue is None else [hue, x]
    if isinstance(source, pd.DataFrame):
        return source[[*keys, metric]].rename(columns={metric: "value"}).assign(part="value")
    frame = summary(source, keys, metric, statistic).assign(part="statistic")
    single = source.runs[source.runs["repeat"].isin(repeats)]
    if single.duplicated([*keys, "repeat"]).any():
        raise ValueError(f"repeats: several runs of one repeat have equal {' and '.join(keys)}; see the panel's `where`")
    values = metrics.values(source.runs, metric, source.problems).loc[single.index]
    thin = single[[*keys, "repeat"]].assign(value=values, part="repeat", **constants(source.runs))
    return pd.concat([frame, thin.sort_values(["repeat", *keys])], ignore_index=True)


def summary(results: Results, keys: list[str], metric: str, statistic: str) -> pd.DataFrame:
    """A statistic of a metric for each group of runs with equal keys.

    Columns: those of `constants`; the keys; runs and feasible_runs (counts), n (runs that have the metric), value, low95 and high95 (its
    95 % bootstrap interval), in the metric's unit.
    """
    import pandas as pd

    runs = results.runs.assign(value=metrics.values(results.runs, metric, results.problems))
    rows = []
    for key, own in runs.groupby(keys):
        # Sorted, so that nothing depends on the order in which chunks are read.
        numbers = np.sort(own["value"].dropna().to_numpy())
        named = dict(zip(keys, key))
        name = "/".join([metric, statistic, *(f"{column}={value}" for column, value in named.items())])
        low, high = np.nan, np.nan
        if not metrics.METRICS[metric].of_group:
            low, high = statistics.interval(statistic, numbers, generator(name))
        counts = {"runs": len(own), "feasible_runs": int(own["feasible"].sum()), "n": len(numbers)}
        rows.append(constants(runs) | named | counts | {"value": statistics.statistic(statistic, numbers), "low95": low, "high95": high})
    return pd.DataFrame(rows)


def constants(runs: pd.DataFrame) -> dict[str, Any]:
    """Problem and method of runs, where they share one."""
    return {column: runs[column].iloc[0] for column in ("problem", "method") if runs[column].nunique() == 1}


# Reference lines: the exact shortest length, and the best known path of the methods' own kind.
LIMITS = {
    "reference": {**style.REFERENCE, "label": "best known path of the same kind"},
    "bound": {**style.BOUND, "label": "exact shortest path"},
}


def shared_limits(runs: pd.DataFrame) -> dict[str, float]:
    """Values of `LIMITS` that all runs share, by name."""
    return {name: runs[name].iloc[0] for name in LIMITS if name in runs and runs[name].notna().all() and runs[name].nunique() == 1}


def axis_label(column: str, scene: Any, statistic: str = "") -> str:
    """Name and unit of what an axis shows; a column other than a metric has its unit in its label, or is a count, or has no unit."""
    if column not in metrics.METRICS and style.column_name(column, scene.labels).endswith(")"):
        return f"{statistic} {style.column_name(column, scene.labels)}".lstrip()
    unit = metrics.unit(column, scene.unit) if column in metrics.METRICS else "-"
    return f"{statistic} {style.column_name(column, scene.labels)}{'' if unit == '-' else f' ({unit})'}".lstrip()


# Columns of published numbers that do not distinguish runs.
_PRINTED = ["table", "metric", "statistic", "n", "unit", "value"]


def published(results: Results, runs: pd.DataFrame, metric: str, statistic: str = "mean") -> list[float]:
    """Values of a metric's statistic that the paper prints for the problem, method and settings of runs; a row's empty keys match all runs.

    A number repeated in several tables counts once.
    """
    found = results.published
    if found is None:
        return []
    found = found[(found["metric"] == metric) & (found["statistic"] == statistic)]
    for column in found.columns.difference(_PRINTED):
        fits = found[column].isin(runs[column]) if column in runs else False
        found = found[found[column].isna() | fits]
    return sorted(found["value"].unique())


def interval_band(axes: Axes, x: pd.Series, low: pd.Series, high: pd.Series, colour: str, label: str) -> None:
    """The interval of a line as a band in the line's colour."""
    axes.fill_between(x, low, high, label=label, zorder=1.5, **style.interval_band(colour))


def runs_note(frame: pd.DataFrame, statistic: str, where: str) -> str:
    """The number of runs behind a statistic, from the columns of `summary`, and the share of them that is feasible."""
    fewest, most = frame["runs"].min(), frame["runs"].max()
    share = 100 * frame["feasible_runs"] / frame["runs"]
    counted = _range(fewest, most)
    if "n" in frame and (frame["n"] < frame["feasible_runs"]).any():
        counted = f"{_range(frame['n'].min(), frame['n'].max())} of {counted}"
    return f"{statistic} of {counted} runs a {where}; {_range(round(share.min()), round(share.max()))} % feasible"


def _range(low: float, high: float) -> str:
    """A range of whole numbers, as printed."""
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, panel: dict) -> str:
    """Draw the rows of `data`; returns the note below the panel's title."""
    x, hue = panel["x"], panel.get("hue")
    of_runs = "experiment" in panel
    statistic = panel["statistic"] if of_runs else ""
    groups = [None] if hue is None else style.in_order(frame[hue], panel)
    values = np.unique(frame[x])
    apart = min(np.diff(values), default=1)
    for number, (group, look) in enumerate(zip(groups, style.lines(groups))):
        own = frame if hue is None else frame[frame[hue] == group]
        label = statistic if hue is None else style.printed(group, hue, scene.labels)
        if of_runs and not panel["joined"]:
            aside = _SPREAD * apart * ((number + 0.5) / len(groups) - 0.5)
            _draw_apart(axes, own[own["part"] == "statistic"], x, aside, look | {"label": label})
            if panel["shares"]:
                _write_shares(axes, own, x, aside)
        elif of_runs:
            _draw_statistic(axes, own[own["part"] == "statistic"], x, look | {"label": label})
            _draw_repeats(axes, own[own["part"] == "repeat"], x, None if hue is None else look["color"])
            if panel["shares"]:
                _write_shares(axes, own, x, 0.0)
        else:
            axes.plot(own[x], own["value"], label=label or None, **_joined(look, len(own)))
    if of_runs and panel["shares"]:
        low, high = axes.get_ylim()
        axes.set_ylim(low, high + _ROOM * (high - low))
    if not panel["joined"] or (len(values) <= _FEW and len(set(np.diff(values))) <= 1):
        axes.set_xticks(values)
    elif (frame[x] % 1 == 0).all():
        axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel(axis_label(x, scene))
    axes.set_ylabel(axis_label(panel["metric"], scene, statistic))
    axes.grid(visible=True)
    return runs_note(frame[frame["part"] == "statistic"], statistic, "point") if of_runs else ""


def _draw_statistic(axes: Axes, frame: pd.DataFrame, x: str, look: dict) -> None:
    """A line with marks, in a band that shows the interval of its points."""
    interval_band(axes, frame[x], frame["low95"], frame["high95"], look["color"], "95 % interval")
    axes.plot(frame[x], frame["value"], zorder=3, **look)


def _draw_apart(axes: Axes, frame: pd.DataFrame, x: str, aside: float, look: dict) -> None:
    """Marks without a line, each with its interval, shifted so that groups are side by side."""
    places = frame[x] + aside
    axes.vlines(places, frame["low95"], frame["high95"], color=look["color"], linewidth=0.8, zorder=2, label="95 % interval")
    axes.plot(places, frame["value"], zorder=3, **look | {"linestyle": ""})


def _write_shares(axes: Axes, frame: pd.DataFrame, x: str, aside: float) -> None:
    """Above each point, or the end of its interval, the share of its runs that is feasible, in per cent."""
    own = frame[(frame["part"] == "statistic") & frame["value"].notna()]
    top = own[["value", "high95"]].max(axis=1)
    for place, height, feasible, runs in zip(own[x] + aside, top, own["feasible_runs"], own["runs"]):
        text = {"xytext": (0, 3), "textcoords": "offset points", "ha": "center", "va": "bottom", "rotation": 90, "fontsize": "xx-small"}
        axes.annotate(f"{100 * feasible / runs:.0f} %", (place, height), zorder=4, **text)


def _draw_repeats(axes: Axes, frame: pd.DataFrame, x: str, colour: str | None) -> None:
    """A thin line for each single repeat; without a colour, each gets its own colour and a name."""
    repeats = frame["repeat"].unique()
    looks = style.lines([str(repeat) for repeat in range(len(repeats) + 1)])[1:]  # the first style is the statistic's
    for repeat, look in zip(repeats, looks):
        own = frame[frame["repeat"] == repeat]
        thin = look | {"linewidth": 0.6, "markersize": 2.2, "zorder": 2.5}
        axes.plot(own[x], own["value"], **(thin | ({"color": colour} if colour else {"label": f"repeat {repeat:g}"})))


def _joined(look: dict, points: int) -> dict:
    """The style of a line through the given number of points of a table."""
    return look | ({"marker": ""} if points <= _MOST_JOINED else {"linestyle": "", "marker": ".", "markersize": 1.2})
