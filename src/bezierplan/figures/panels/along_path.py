"""The curvature along the path of one chosen run, with the limit that the paper claims for it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field

from bezierplan.analysis.measures import CURVATURE_SAMPLES
from bezierplan.figures import style
from bezierplan.figures.panels import Note, Picked, RunsPanel
from bezierplan.figures.panels.paths import choose_run, describe_run
from bezierplan.geometry import curves
from bezierplan.schema.model import Number

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# A peak higher than this many limits would flatten the curve onto the axis: then the scale ends
# lower, and an arrow marks the peak.
_HIGHEST_PEAK = 10
_CUT_SCALE = 4

_JOINT = {"color": style.BLUE, "linestyle": (0, (3, 1.5)), "linewidth": 0.9}


class Options(RunsPanel):
    one = ("problem", "method")

    pick: Picked
    limit: Number = Field(math.nan, description="the published limit, a number")


def data(results: Results, options: Options) -> pd.DataFrame:
    """Return one row per sample of a path, uniform in its parameter.

    Columns of `paths.choose_run` come first, then limit, pieces (of the path), t (0 to 1), value:
    the curvature with its sign, left turns positive, in 1/unit; empty where the speed is zero. If
    there is no path, one row has neither t nor value.

    Raises ValueError unless all runs are of one problem and one method.
    """
    import pandas as pd

    from bezierplan.analysis.results import build_path

    run, names = choose_run(results, options.pick)
    names |= {"limit": options.limit}
    path = None if run is None else build_path(run)
    if path is None:
        return pd.DataFrame([names | {"pieces": 0, "t": math.nan, "value": math.nan}])
    names["pieces"] = len(curves.bezier_pieces(path))
    samples = np.linspace(0, 1, CURVATURE_SAMPLES)
    values, _ = curves.curvature(path, CURVATURE_SAMPLES)  # those of the metric that claims judge
    return pd.DataFrame(names | {"t": samples, "value": values})


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the curvature with its limits, and mark the largest magnitude."""
    row = frame.iloc[0]
    unit = options.find_workspace(frame, scene).unit
    axes.set_xlim(0, 1)
    axes.set_xlabel("curve parameter t")
    axes.set_ylabel(f"signed curvature (1/{unit})")
    axes.grid(visible=True)
    for side, label in ((1, f"published limit: {row['limit']:g} 1/{unit}"), (-1, None)):
        if np.isfinite(row["limit"]):
            axes.axhline(side * row["limit"], label=label, zorder=3, **style.PUBLISHED)
    if frame["value"].isna().all():
        missing = "no path" if frame["t"].isna().all() else "the curve is a single point"
        return Note("", describe_run(frame, missing))
    axes.plot(frame["t"], frame["value"], label="path", **style.RUN_SHOWN)
    for joint in range(1, int(row["pieces"]) if options.context else 1):
        axes.axvline(joint / row["pieces"], label="joint of two pieces", zorder=2, **_JOINT)
    return _mark_highest(axes, frame, unit)


def _mark_highest(axes: Axes, frame: pd.DataFrame, unit: str) -> Note:
    """Mark the value of largest magnitude and fit the scale to it.

    Returns a note about that value and about the samples left out.
    """
    highest = frame.loc[frame["value"].abs().idxmax()]
    limit, magnitude, side = highest["limit"], abs(highest["value"]), np.sign(highest["value"])
    cut = magnitude > _HIGHEST_PEAK * limit
    # A straight path has no curvature, and yet its axis needs two ends.
    top = _CUT_SCALE * limit if cut else 1.12 * np.nanmax([magnitude, limit, 1e-3])
    axes.set_ylim(-top, top)
    marker = ("^" if side > 0 else "v") if cut else "o"
    mark = style.build_mark_style(marker, 5, style.BLACK, label="largest magnitude")
    axes.plot(highest["t"], side * min(magnitude, top), clip_on=False, zorder=4, **mark)
    still = int(frame["value"].isna().sum())
    left_out = f"{still} of {len(frame)} samples left out, where the curve stands still"
    return Note(
        f"largest {highest['value']:.3g} 1/{unit} at t = {highest['t']:.2f}",
        describe_run(frame, *([left_out] if still else [])),
    )
