"""The best objective of each generation: one picked run, and median and spread of all runs."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from bezierplan import style
from bezierplan.analysis.results import Results
from bezierplan.figures.paths import feasible_note, picked, run_note


def data(results: Results, *, pick: dict[str, Any]) -> pd.DataFrame:
    """One row a generation; columns: those of `paths.picked`, generation, objective (of the picked run; empty without one), median,
    quantile10 and quantile90 over all runs, feasible or not, and bound, the exact shortest length. Objectives are the planner's own, in
    units.

    A run that stopped early keeps its last objective. pick: the run, as in `analysis.results.pick`. Raises ValueError unless all runs are
    of one problem and one method.
    """
    run, names = picked(results, pick)
    generations = max(len(history) for history in results.runs["history"])
    histories = np.array([_lengthened(history, generations) for history in results.runs["history"]])
    low, median, high = np.quantile(histories, [0.1, 0.5, 0.9], axis=0)
    shown = np.full(generations, np.nan) if run is None else _lengthened(run["history"], generations)
    frame = pd.DataFrame({"generation": range(generations), "objective": shown})
    frame = frame.assign(median=median, quantile10=low, quantile90=high, bound=results.runs["bound"].iloc[0], **names)
    return frame[[*names, "generation", "objective", "median", "quantile10", "quantile90", "bound"]]


def _lengthened(history: list[float], generations: int) -> np.ndarray:
    """A history (generations,) that goes on with its last value."""
    return np.pad(np.asarray(history, dtype=float), (0, generations - len(history)), mode="edge")


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, panel: dict) -> str:
    """Draw the rows of `data`; returns the note below the panel's title."""
    generation = frame["generation"]
    band = {"color": style.LIGHT_BLUE, "linewidth": 0, "label": "10 to 90 % of all runs"}
    axes.fill_between(generation, frame["quantile10"], frame["quantile90"], **band)
    axes.plot(generation, frame["median"], label="median of all runs", **style.OURS)
    if frame["objective"].notna().any():
        axes.plot(generation, frame["objective"], label="run shown", **style.RUN_SHOWN)
    if np.isfinite(frame["bound"].iloc[0]):
        axes.axhline(frame["bound"].iloc[0], label="shortest path possible", **style.BOUND)
    axes.set_xlim(0, max(1, generation.max()))
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel("generation (-)")
    axes.set_ylabel(f"objective ({scene.unit})")
    axes.grid(visible=True)
    return run_note(frame, feasible_note(frame))
