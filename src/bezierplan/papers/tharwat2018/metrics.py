"""Metrics of tharwat2018 alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bezierplan.analysis.measures import sample_path
from bezierplan.analysis.metric import (
    Metric,
    build_count,
    measure_on_maps,
    metric,
    on_map,
    register,
)
from bezierplan.workspaces.circles import Circles

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.analysis.metric import Problems
    from bezierplan.workspaces.problem import Path, Workspace

# Samples of a path that determine its way round the circles.
CLASS_SAMPLES = 2001


def compute_homotopy_class(path: Path, workspace: Workspace) -> float:
    """Return on which side a polyline passes each circle: the sum of 2^k over the circles k = 0, 1,
    ... that it leaves to its left.

    A circle lies to the left if the angle swept by the polyline about its centre is positive. This
    distinguishes classes if no polyline winds round a circle and all have the same ends. NaN
    without points or in a workspace of another kind.
    """
    if not len(path.points) or not isinstance(workspace, Circles):
        return np.nan
    x, y = np.ascontiguousarray(path.points.T)[:, None] - workspace.centres.T[:, :, None]
    angles = np.arctan2(y[:, [0, -1]], x[:, [0, -1]])
    # Where the polyline crosses the ray to the left of the centre, its angle jumps from pi to -pi,
    # or back.
    leftward = x[:, :-1] * y[:, 1:] > y[:, :-1] * x[:, 1:]
    above = y >= 0
    rounds = (above[:, :-1] & ~above[:, 1:] & leftward).sum(axis=1) - (
        ~above[:, :-1] & above[:, 1:] & ~leftward
    ).sum(axis=1)
    swept = angles[:, 1] - angles[:, 0] + 2 * np.pi * rounds
    return float((2.0 ** np.arange(len(workspace.centres)))[swept > 0].sum())


@on_map(
    "-",
    "class of the path: the sum of 2^k over the circles k that it leaves to its left",
    "circles",
    step=1.0,
)
def homotopy(path: Path, workspace: Workspace) -> float:
    """Return the homotopy class of a path (`compute_homotopy_class`)."""
    line = path._replace(points=sample_path(path, CLASS_SAMPLES))
    return compute_homotopy_class(line, workspace)


@metric(
    "-",
    "whether the path is free and passes each circle where the shortest one does",
    step=1.0,
    on=("circles",),
)
def best_corridor(runs: pd.DataFrame, problems: Problems) -> np.ndarray:
    """Tell which runs (n,) have a free path in the homotopy class of the exact shortest one; NaN
    without circles.
    """
    shortest = runs.assign(path_curve="polyline", path_points=runs["bound_path"])
    best = measure_on_maps(compute_homotopy_class, shortest, problems)
    found = np.equal(measure_on_maps(homotopy, runs, problems), best)
    return np.where(np.isnan(best), np.nan, runs["feasible"] & found)


@metric("-", "control points of all paths evaluated", step=1.0, least=0.0)
def points_evaluated(runs: pd.DataFrame, problems: Problems) -> pd.Series:
    """Count the control points (n,) of all paths evaluated, each counted with as many as the run's
    path has; NaN where the run has no path.
    """
    points = runs["path_points"].map(len) / 2
    return runs["evaluations"] * points.where(points > 0)


register(
    {
        "violation": Metric(
            "-",
            "mean depth of the samples below the circles, as a share of the radius, "
            "summed over circles",
        ),
        "collisions_a": Metric(
            "particles",
            "colliding particles per iteration, of 20, the first swarm included",
            least=0.0,
            most=20.0,
        ),
        "collisions_b": Metric(
            "samples", "colliding samples per evaluated path, summed over circles"
        ),
        "collisions_c": Metric(
            "samples", "colliding samples of the best path, added over iterations", step=1.0
        ),
        "collisions_d": Metric("iterations", "iterations whose best path collides", step=1.0),
        "collisions_e": build_count("whether the final path collides, by the planner's own test"),
        "collisions_f": build_count("paths evaluated that collide"),
    }
)
