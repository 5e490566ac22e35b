"""The best objective of each generation: one picked run with median and spread of all runs, or a line a method or value of a factor."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan import style
from bezierplan.analysis import statistics
from bezierplan.figures import PICK, Pick, RunsPanel, exactly_one
from bezierplan.figures.lines import LIMITS, constants, runs_note, shared_limits
from bezierplan.figures.paths import feasible_note, picked, run_note
from bezierplan.model import Column, Flag, wrong

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Least distance of names beside a panel, as a share of its height: a line of text where two panels stand side by side.
_NAME_GAP = 0.08

# Marks on a line of a group, at other generations than those of the other lines.
_MARKS = 5


class Options(RunsPanel):
    """Keys of a panel."""

    pick: Pick = Field(None, description=PICK)
    hue: Column = Field(None, description="in place of pick, a column of the runs table: a line for each of its values")
    statistic: Literal["mean", "median"] = Field("mean", description="with hue, of its runs: mean (left out: this) or median")
    reference: Flag = Field(False, description="whether the reference of the problem is drawn, true or false")

    @model_validator(mode="after")
    def _check_source(self) -> Options:
        exactly_one(self, "pick", "hue")
        if "statistic" in self.model_fields_set and self.hue is None:
            raise wrong("statistic: needs hue")
        return self


def data(
    results: Results,
    *,
    pick: dict[str, Any] | None = None,
    hue: str | None = None,
    statistic: Literal["mean", "median"] = "mean",
    reference: bool = False,
) -> pd.DataFrame:
    """One row a generation, and with `hue` one for each of its values as well. A run that stopped early keeps its last objective.

    Objectives are the planner's own, in units, over all runs, feasible or not; bound is the exact shortest length.

    With `pick`, columns: those of `paths.picked`, generation, objective (of the picked run; empty without one), median, quantile10 and
    quantile90, bound. With `hue`, columns: those of `lines.constants`, the hue's own name, runs and feasible_runs (counts), generation,
    objective (the statistic), bound (empty where problems differ in it). With `reference` a column of that name, the length of the best
    known path of the methods' own kind, empty where problems differ in it.

    pick: the run, as in `analysis.results.pick`. hue: a column of the runs table. Raises ValueError unless either is given, and with `pick`
    unless all runs are of one problem and one method.
    """
    if (pick is None) == (hue is None):
        raise ValueError("a panel of kind convergence needs either pick or hue")
    frame = _of_one_run(results, pick) if hue is None else _of_groups(results, hue, statistic)
    return frame.assign(reference=shared_limits(results.runs).get("reference", np.nan)) if reference else frame


def _of_one_run(results: Results, pick: dict[str, Any]) -> pd.DataFrame:
    import pandas as pd

    run, names = picked(results, pick)
    generations = max(len(history) for history in results.runs["history"])
    histories = np.array([_lengthened(history, generations) for history in results.runs["history"]])
    low, median, high = np.quantile(histories, [0.1, 0.5, 0.9], axis=0)
    shown = np.full(generations, np.nan) if run is None else _lengthened(run["history"], generations)
    frame = pd.DataFrame({"generation": range(generations), "objective": shown})
    frame = frame.assign(median=median, quantile10=low, quantile90=high, bound=results.runs["bound"].iloc[0], **names)
    return frame[[*names, "generation", "objective", "median", "quantile10", "quantile90", "bound"]]


def _of_groups(results: Results, hue: str, statistic: str) -> pd.DataFrame:
    # Sorted, so that no sum depends on the order in which chunks were read.
    import pandas as pd

    runs = results.runs.sort_values("id")
    generations = max(len(history) for history in runs["history"])
    frames = []
    for value, own in runs.groupby(hue):
        histories = np.array([_lengthened(history, generations) for history in own["history"]])
        named = constants(runs) | {hue: value, "runs": len(own), "feasible_runs": int(own["feasible"].sum())}
        objective = statistics.STATISTICS[statistic](histories.T)
        frames.append(pd.DataFrame(named | {"generation": range(generations), "objective": objective}))
    bound = runs["bound"].iloc[0] if runs["bound"].nunique() == 1 else np.nan
    return pd.concat(frames, ignore_index=True).assign(bound=bound)


def _lengthened(history: list[float], generations: int) -> np.ndarray:
    """A history (generations,) that goes on with its last value."""
    return np.pad(np.asarray(history, dtype=float), (0, generations - len(history)), mode="edge")


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, panel: dict) -> str:
    """Draw the rows of `data`; returns the note below the panel's title."""
    axes.set_xlim(0, max(1, frame["generation"].max()))
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel("generation (-)")
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
    band = {"color": style.LIGHT_BLUE, "linewidth": 0, "label": "10 to 90 % of all runs"}
    axes.fill_between(generation, frame["quantile10"], frame["quantile90"], **band)
    axes.plot(generation, frame["median"], label="median of all runs", **style.OURS)
    if frame["objective"].notna().any():
        axes.plot(generation, frame["objective"], label="run shown", **style.RUN_SHOWN)


def _draw_groups(axes: Axes, frame: pd.DataFrame, scene: Any, panel: dict) -> str:
    hue, statistic = panel["hue"], panel.get("statistic", "mean")
    groups = style.in_order(frame[hue], panel)
    looks = style.lines(groups)
    lines = [frame.loc[frame[hue] == group] for group in groups]
    for number, (own, look) in enumerate(zip(lines, looks)):
        step = max(1, len(own) // _MARKS)
        axes.plot(own["generation"], own["objective"], markevery=(number * step // len(groups), step), **look)
    axes.set_ylabel(f"{statistic} objective ({scene.unit})")
    axes.set_box_aspect(style.HIGH_PANEL_HEIGHT)
    _name_lines(axes, [own["objective"].iloc[-1] for own in lines], [style.printed(group, hue, scene.labels) for group in groups], looks)
    return runs_note(frame, statistic, "line")


def _name_lines(axes: Axes, ends: list[float], names: list[str], looks: list[dict]) -> None:
    """Write the lines' names (n) beside the panel, each at the end of its line (n) or as near to it as there is room, from high to low."""
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
    """Heights (n,), ascending, moved as little as possible so that they lie a gap apart and between 0 and 1."""
    from scipy.optimize import isotonic_regression

    steps = min(_NAME_GAP, 1 / max(1, len(heights) - 1)) * np.arange(len(heights))
    return isotonic_regression(heights - steps).x.clip(0, 1 - steps[-1]) + steps
