"""The best objective of each generation: one picked run with median and spread of all runs, or one
line per method or value of a factor.

A study's label of `generation` names the axis, such as `iteration` for a swarm.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis import statistics
from bezierplan.figures import seen, style
from bezierplan.figures.panels import PICK, MayPrint, Note, Pick, RunsPanel, exactly_one
from bezierplan.figures.panels.lines import (
    LIMITS,
    constants,
    counts,
    interval_band,
    published,
    runs_note,
    shared_limits,
)
from bezierplan.figures.panels.paths import feasible_note, picked, run_note
from bezierplan.schema.model import Column, Flag, PrintedTable, Whole, wrong
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Marks on the line of a group, at generations that differ from those of the other lines.
_MARKS = 5

# The strip of last values beside a panel: its width and its distance, as shares of the panel's
# width.
_STRIP, _APART = 0.34, 0.04

# Room beyond last values and their intervals, as a share of the axis, so that marks are seen whole.
_ROOM = 0.03

_PRINTED = style.PUBLISHED_MARK | {"markersize": 3.5}

# Published means farther beyond our values than this share of their range are drawn at the end of
# the axis, with the range of theirs.
_FAR = 0.5


class Options(MayPrint, RunsPanel):
    pick: Pick = Field(None, description=PICK)
    hue: Column = Field(
        None,
        description="in place of pick, a column of the runs table: a line for each of its values",
    )
    statistic: Literal["mean", "median"] = Field(
        "mean", description="with hue, of its runs: mean (left out: this) or median"
    )
    reference: Flag = Field(
        False, description="whether the reference of the problem is drawn, true or false"
    )
    until: Whole = Field(
        None,
        description="the generation at which the axis ends; "
        "left out: the last one of the longest run",
    )
    printed: PrintedTable = Field(
        None,
        description="with hue, the name of a published table "
        "whose means are marked next to the last values",
    )

    @property
    def named_rows(self) -> bool:
        """Whether last values stand beside it."""
        return self.hue is not None

    @property
    def one(self) -> tuple[str, ...]:
        """Columns of which the runs have one value, if one of them is picked."""
        return ("problem", "method") if self.pick else ()

    @model_validator(mode="after")
    def _check_source(self) -> Options:
        exactly_one(self, "pick", "hue")
        if "statistic" in self.model_fields_set and self.hue is None:
            raise wrong("statistic: needs hue")
        if self.printed is not None and self.hue is None:
            raise wrong("printed: needs hue")
        return self


def data(results: Results, options: Options) -> pd.DataFrame:
    """One row per generation, and with `hue` also per value of it. A run that stopped early keeps
    its last objective.

    Objectives are the planner's own, in units, over all runs, feasible or not; bound is the exact
    shortest length.

    With `pick`, columns: those of `paths.picked`, generation, objective (of the picked run; empty
    without one), median, quartile1 and quartile3, bound. With `hue`, columns: those of
    `lines.constants`, the hue's own name, runs and feasible_runs (counts), generation, objective
    (the statistic), low95 and high95 (its 95 % bootstrap interval), bound (empty if problems differ
    in it). With `reference`, a column of that name: the length of the best known path of the
    methods' own kind, empty if problems differ in it. With `printed`, a column of that name: the
    mean that this published table has for a group, in the row of the last generation.

    Rows end at the generation `until`, unless a run is longer. Raises ValueError with `pick` unless
    all runs are of one problem and one method.
    """
    generations = max(
        results.runs["history"].map(len).max(), 0 if options.until is None else options.until + 1
    )
    if options.pick is not None:
        frame = _of_one_run(results, options.pick, generations)
    else:
        frame = _of_groups(results, options.hue, options.statistic, generations)
    if options.printed is not None and results.published is not None:
        frame["printed"] = _published_ends(results, frame, options)
    return (
        frame.assign(reference=shared_limits(results.runs).get("reference", np.nan))
        if options.reference
        else frame
    )


def _of_one_run(results: Results, pick: Pick, generations: int) -> pd.DataFrame:
    import pandas as pd

    run, names = picked(results, pick)
    histories = np.array([_lengthened(history, generations) for history in results.runs["history"]])
    low, median, high = np.quantile(histories, [0.25, 0.5, 0.75], axis=0)
    shown = (
        np.full(generations, np.nan) if run is None else _lengthened(run["history"], generations)
    )
    frame = pd.DataFrame({"generation": range(generations), "objective": shown})
    frame = frame.assign(
        median=median, quartile1=low, quartile3=high, bound=results.runs["bound"].iloc[0], **names
    )
    return frame[[*names, "generation", "objective", "median", "quartile1", "quartile3", "bound"]]


def _of_groups(results: Results, hue: str, statistic: str, generations: int) -> pd.DataFrame:
    # Sorted, so that no sum depends on the order in which chunks were read.
    import pandas as pd

    runs = results.runs.sort_values("id")
    frames = []
    for value, group_runs in runs.groupby(hue):
        histories = np.array(
            [_lengthened(history, generations) for history in group_runs["history"]]
        )
        low, high = _intervals(histories, statistic, f"convergence/{hue}={value}")
        columns = {
            "generation": range(generations),
            "objective": statistics.STATISTICS[statistic](histories.T),
            "low95": low,
            "high95": high,
        }
        frames.append(pd.DataFrame(constants(runs) | {hue: value} | counts(group_runs) | columns))
    bound = runs["bound"].iloc[0] if runs["bound"].nunique() == 1 else np.nan
    return pd.concat(frames, ignore_index=True).assign(bound=bound)


def _intervals(histories: np.ndarray, statistic: str, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the 95 % interval of a statistic of histories (n, generations): (generations,) each,
    from the same draws of runs.
    """
    ends = []
    for generation, values in enumerate(histories.T):
        held = generation > 0 and np.array_equal(values, histories[:, generation - 1])
        ends.append(ends[-1] if held else statistics.interval(statistic, values, generator(name)))
    low, high = np.transpose(ends)
    return low, high


def _published_ends(results: Results, frame: pd.DataFrame, options: Options) -> np.ndarray:
    """For each row of `data`, the published mean of its group, at the last generation only."""
    printed = np.full(len(frame), np.nan)
    last = frame["generation"] == frame["generation"].max()
    for value, own in results.runs.groupby(options.hue):
        means = published(results, own, "objective", table=options.printed)
        printed[last & (frame[options.hue] == value)] = next(iter(means), np.nan)
    return printed


def _lengthened(history: list[float], generations: int) -> np.ndarray:
    """A history (generations,) extended with its last value."""
    return np.pad(np.asarray(history, dtype=float), (0, generations - len(history)), mode="edge")


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    axes.set_xlim(0, max(1, frame["generation"].max()))
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel(style.column_name("generation", scene.labels))
    axes.grid(visible=True)
    for name, look in LIMITS.items():
        if name in frame and np.isfinite(frame[name].iloc[0]):
            axes.axhline(frame[name].iloc[0], zorder=3.5, **look)
    if options.hue is not None:
        return _draw_groups(axes, frame, scene, options)
    _draw_one_run(axes, frame)
    axes.set_ylabel(f"objective ({scene.unit})")
    style.fit(axes.yaxis, frame["median"], [])
    return Note("", run_note(frame, feasible_note(frame)))


def _draw_one_run(axes: Axes, frame: pd.DataFrame) -> None:
    generation = frame["generation"]
    band = {"color": style.LIGHT_BLUE, "linewidth": 0, "label": "quartiles of all runs"}
    axes.fill_between(generation, frame["quartile1"], frame["quartile3"], **band)
    axes.plot(generation, frame["median"], label="median of all runs", **style.OURS)
    if frame["objective"].notna().any():
        axes.plot(generation, frame["objective"], label="run shown", **style.RUN_SHOWN)


def _draw_groups(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    hue, statistic = options.hue, options.statistic
    groups = style.in_order(frame[hue], options.where)
    looks = style.lines(groups, scene.looks)
    lines = [frame.loc[frame[hue] == group] for group in groups]
    for number, (group, rows, look) in enumerate(zip(groups, lines, looks)):
        step = max(1, len(rows) // _MARKS)
        if len(groups) <= style.MOST_BANDS:
            ends = rows["low95"], rows["high95"]
            interval_band(axes, rows["generation"], *ends, look["color"])
        named = look | {"label": style.printed(group, hue, scene.labels)}
        axes.plot(
            rows["generation"],
            rows["objective"],
            markevery=(number * step // len(groups), step),
            **named,
        )
    axes.set_ylabel(f"{statistic} objective ({scene.unit})")
    axes.set_box_aspect(style.HIGH_PANEL_HEIGHT)
    axes.autoscale_view()
    style.fit(axes.yaxis, frame["objective"], [])
    ends = [rows.iloc[-1] for rows in lines]
    _draw_ends(axes, ends, looks, statistic)
    names = [style.printed(group, hue, scene.labels) for group in groups]
    last = dict(zip(names, (end["objective"] for end in ends)))
    return Note(
        "",
        f"{runs_note(frame, statistic, 'line')}; right: last values",
        seen.extremes(f"final {statistic}", last),
    )


def _draw_ends(axes: Axes, ends: list[pd.Series], looks: list[dict], statistic: str) -> None:
    """The last value of each line with its interval, and the published one, side by side in a strip
    that shares the vertical axis.
    """
    low, high = axes.get_ylim()
    known = [
        each[name]
        for each in ends
        for name in ("objective", "low95", "high95")
        if np.isfinite(each[name])
    ]
    reach = _FAR * (max(known) - min(known))
    printed = [each.get("printed", np.nan) for each in ends]
    near = [value for value in printed if min(known) - reach <= value <= max(known) + reach]
    least, most = min([*known, *near]), max([*known, *near])
    room = _ROOM * (max(high, most) - min(low, least))
    low, high = min(low, least - room), max(high, most + room)
    axes.set_ylim(low, high)
    strip = axes.inset_axes([1 + _APART, 0, _STRIP, 1], sharey=axes)
    strip.tick_params(labelleft=False, left=False)
    strip.set_xticks([])
    strip.set_xlim(-0.7, len(ends) - 0.3)
    # Level with that of the panel, below its last number.
    strip.set_xlabel(f"final {statistic}", labelpad=style.SMALLEST_TEXT + 8)
    strip.grid(visible=True, axis="y")
    for column, (end, look, value) in enumerate(zip(ends, looks, printed)):
        bar = {"color": look["color"], "linewidth": 0.9, "zorder": 2}
        strip.plot([column, column], [end["low95"], end["high95"]], **bar)
        strip.plot(column, end["objective"], zorder=3, **look | {"linestyle": ""})
        if not np.isfinite(value):
            continue
        if low <= value <= high:
            strip.plot(column, value, label="published final mean", zorder=4, **_PRINTED)
        else:
            above = value > high
            edge = _PRINTED | {
                "marker": "^" if above else "v",
                "clip_on": False,
                "label": "published, off the scale",
            }
            strip.plot(column, high if above else low, zorder=4, **edge)
    _tell_far(strip, sorted(value for value in printed if value > high), above=True)
    _tell_far(strip, sorted(value for value in printed if value < low), above=False)
    axes.set_ylim(low, high)


def _tell_far(strip: Axes, values: list[float], *, above: bool) -> None:
    """Write the range of values beyond an end of the axis there."""
    if values:
        told = " to ".join(dict.fromkeys(f"{value:.3g}" for value in (values[0], values[-1])))
        strip.text(
            0.5,
            0.95 if above else 0.05,
            told,
            transform=strip.transAxes,
            ha="center",
            va="top" if above else "bottom",
            zorder=5,
        )
