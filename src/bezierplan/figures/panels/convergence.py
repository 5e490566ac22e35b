"""The best objective of each generation: one picked run with median and spread of all runs, or one line per method or value of a factor.

A study's label of `generation` names the axis, such as `iteration` for a swarm.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis import statistics
from bezierplan.figures import style
from bezierplan.figures.panels import PICK, Pick, RunsPanel, exactly_one
from bezierplan.figures.panels.lines import LIMITS, constants, interval_band, published, runs_note, shared_limits
from bezierplan.figures.panels.paths import feasible_note, picked, run_note
from bezierplan.schema.model import Column, Flag, PrintedTable, Whole, wrong
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Least distance between names beside a panel, as a share of its height: a line of text when two panels are side by side.
_NAME_GAP = 0.08

# Marks on the line of a group, at generations that differ from those of the other lines.
_MARKS = 5

# Distance of published means at the end of the axis, as a share of it: side by side, so that they do not hide each other.
_MARK_STEP = 0.03


class Options(RunsPanel):
    """Keys of a panel."""

    pick: Pick = Field(None, description=PICK)
    hue: Column = Field(None, description="in place of pick, a column of the runs table: a line for each of its values")
    statistic: Literal["mean", "median"] = Field("mean", description="with hue, of its runs: mean (left out: this) or median")
    reference: Flag = Field(False, description="whether the reference of the problem is drawn, true or false")
    until: Whole = Field(None, description="the generation at which the axis ends; left out: the last one of the longest run")
    printed: PrintedTable = Field(None, description="with hue, the name of a published table whose means are marked beside the last values")

    @property
    def published_drawn(self) -> bool:
        """Whether published numbers are drawn."""
        return self.printed is not None

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


@Options.filled
def data(
    results: Results,
    *,
    pick: dict[str, Any] | None,
    hue: str | None,
    statistic: Literal["mean", "median"],
    reference: bool,
    until: int | None,
    printed: str | None,
) -> pd.DataFrame:
    """One row per generation, and with `hue` also per value of it. A run that stopped early keeps its last objective.

    Objectives are the planner's own, in units, over all runs, feasible or not; bound is the exact shortest length.

    With `pick`, columns: those of `paths.picked`, generation, objective (of the picked run; empty without one), median, quartile1 and
    quartile3, bound. With `hue`, columns: those of `lines.constants`, the hue's own name, runs and feasible_runs (counts), generation,
    objective (the statistic), low95 and high95 (its 95 % bootstrap interval), bound (empty if problems differ in it). With `reference`, a
    column of that name: the length of the best known path of the methods' own kind, empty if problems differ in it. With `printed`, a
    column of that name: the mean that this published table has for a group, in the row of the last generation.

    pick: the run, as in `analysis.results.pick`. hue: a column of the runs table. until: the generation at which rows end, unless a run is
    longer. Raises ValueError unless either pick or hue is given, and with `pick` unless all runs are of one problem and one method.
    """
    if (pick is None) == (hue is None):
        raise ValueError("a panel of kind convergence needs either pick or hue")
    generations = max(results.runs["history"].map(len).max(), 0 if until is None else until + 1)
    frame = _of_one_run(results, pick, generations) if hue is None else _of_groups(results, hue, statistic, generations)
    if printed is not None and results.published is not None:
        table = results.published[results.published["table"] == printed]
        frame["printed"] = _published_ends(results._replace(published=table), frame, hue)
    return frame.assign(reference=shared_limits(results.runs).get("reference", np.nan)) if reference else frame


def _of_one_run(results: Results, pick: dict[str, Any], generations: int) -> pd.DataFrame:
    import pandas as pd

    run, names = picked(results, pick)
    histories = np.array([_lengthened(history, generations) for history in results.runs["history"]])
    low, median, high = np.quantile(histories, [0.25, 0.5, 0.75], axis=0)
    shown = np.full(generations, np.nan) if run is None else _lengthened(run["history"], generations)
    frame = pd.DataFrame({"generation": range(generations), "objective": shown})
    frame = frame.assign(median=median, quartile1=low, quartile3=high, bound=results.runs["bound"].iloc[0], **names)
    return frame[[*names, "generation", "objective", "median", "quartile1", "quartile3", "bound"]]


def _of_groups(results: Results, hue: str, statistic: str, generations: int) -> pd.DataFrame:
    # Sorted, so that no sum depends on the order in which chunks were read.
    import pandas as pd

    runs = results.runs.sort_values("id")
    frames = []
    for value, own in runs.groupby(hue):
        histories = np.array([_lengthened(history, generations) for history in own["history"]])
        named = constants(runs) | {hue: value, "runs": len(own), "feasible_runs": int(own["feasible"].sum())}
        objective = statistics.STATISTICS[statistic](histories.T)
        low, high = _intervals(histories, statistic, f"convergence/{hue}={value}")
        frames.append(pd.DataFrame(named | {"generation": range(generations), "objective": objective, "low95": low, "high95": high}))
    bound = runs["bound"].iloc[0] if runs["bound"].nunique() == 1 else np.nan
    return pd.concat(frames, ignore_index=True).assign(bound=bound)


def _intervals(histories: np.ndarray, statistic: str, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the 95 % interval of a statistic of histories (n, generations): (generations,) each, from the same draws of runs."""
    ends = []
    for generation, values in enumerate(histories.T):
        held = generation > 0 and np.array_equal(values, histories[:, generation - 1])
        ends.append(ends[-1] if held else statistics.interval(statistic, values, generator(name)))
    low, high = np.transpose(ends)
    return low, high


def _published_ends(results: Results, frame: pd.DataFrame, hue: str) -> np.ndarray:
    """For each row of `data`, the published mean of its group, at the last generation only."""
    printed = np.full(len(frame), np.nan)
    last = frame["generation"] == frame["generation"].max()
    for value, own in results.runs.groupby(hue):
        printed[last & (frame[hue] == value)] = next(iter(published(results, own, "objective")), np.nan)
    return printed


def _lengthened(history: list[float], generations: int) -> np.ndarray:
    """A history (generations,) extended with its last value."""
    return np.pad(np.asarray(history, dtype=float), (0, generations - len(history)), mode="edge")


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, panel: dict) -> str:
    """Draw the rows of `data`; returns the note below the panel's title."""
    axes.set_xlim(0, max(1, frame["generation"].max()))
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel(style.column_name("generation", scene.labels))
    axes.grid(visible=True)
    for name, look in LIMITS.items():
        if name in frame and np.isfinite(frame[name].iloc[0]):
            axes.axhline(frame[name].iloc[0], **look)
    if "hue" in panel:
        return _draw_groups(axes, frame, scene, panel)
    _draw_one_run(axes, frame)
    axes.set_ylabel(f"objective ({scene.unit})")
    return run_note(frame, feasible_note(frame))


def _draw_one_run(axes: Axes, frame: pd.DataFrame) -> None:
    generation = frame["generation"]
    band = {"color": style.LIGHT_BLUE, "linewidth": 0, "label": "quartiles of all runs"}
    axes.fill_between(generation, frame["quartile1"], frame["quartile3"], **band)
    axes.plot(generation, frame["median"], label="median of all runs", **style.OURS)
    if frame["objective"].notna().any():
        axes.plot(generation, frame["objective"], label="run shown", **style.RUN_SHOWN)


def _draw_groups(axes: Axes, frame: pd.DataFrame, scene: Any, panel: dict) -> str:
    hue, statistic = panel["hue"], panel["statistic"]
    groups = style.in_order(frame[hue], panel)
    looks = style.lines(groups)
    lines = [frame.loc[frame[hue] == group] for group in groups]
    for number, (own, look) in enumerate(zip(lines, looks)):
        step = max(1, len(own) // _MARKS)
        interval_band(axes, own["generation"], own["low95"], own["high95"], look["color"], f"95 % interval of the {statistic}")
        axes.plot(own["generation"], own["objective"], markevery=(number * step // len(groups), step), **look)
        if "printed" in own and np.isfinite(own["printed"].iloc[-1]):
            place = own["generation"].iloc[-1] * (1 - _MARK_STEP * (len(groups) - 1 - number))
            mark = {"marker": look["marker"], "markerfacecolor": look["color"], "label": "published final mean, with the mark of its line"}
            axes.plot(place, own["printed"].iloc[-1], clip_on=False, zorder=5, **(style.PUBLISHED_MARK | mark))
    axes.set_ylabel(f"{statistic} objective ({scene.unit})")
    axes.set_box_aspect(style.HIGH_PANEL_HEIGHT)
    _name_lines(axes, [own["objective"].iloc[-1] for own in lines], [style.printed(group, hue, scene.labels) for group in groups], looks)
    return runs_note(frame, statistic, "line")


def _name_lines(axes: Axes, ends: list[float], names: list[str], looks: list[dict]) -> None:
    """Write the lines' names (n) beside the panel, each at the end of its line (n) or as near to it as possible, from high to low."""
    order = np.argsort(ends, kind="stable")
    axes.autoscale_view()
    to_share = axes.transData + axes.transAxes.inverted()
    ends = to_share.transform([(0.0, ends[i]) for i in order])[:, 1]
    for i, end, height in zip(order, ends, _apart(ends)):
        beside = {"transform": axes.transAxes, "clip_on": False}
        axes.plot([1, 1.05], [end, height], **beside, color=looks[i]["color"], linewidth=0.5)
        axes.plot([1.05, 1.12, 1.19], [height] * 3, markevery=[1], **beside, **looks[i])
        axes.text(1.21, height, names[i], va="center_baseline", transform=axes.transAxes)


def _apart(heights: np.ndarray) -> np.ndarray:
    """Heights (n,), ascending, moved as little as possible so that they are at least a gap apart and between 0 and 1."""
    from scipy.optimize import isotonic_regression

    steps = min(_NAME_GAP, 1 / max(1, len(heights) - 1)) * np.arange(len(heights))
    return isotonic_regression(heights - steps).x.clip(0, 1 - steps[-1]) + steps
