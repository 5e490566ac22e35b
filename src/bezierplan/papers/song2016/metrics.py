"""Metrics of song2016 alone."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.analysis.measures import (
    CURVATURE_SAMPLES,
    cells,
    extend_histories,
    find_first_generation,
    sample_curvature,
)
from bezierplan.analysis.metric import (
    build_generation,
    measure_on_maps,
    metric,
    of_path,
    on_map,
    register,
)
from bezierplan.workspaces.grid import ON_LINE, Grid, embed

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.analysis.metric import Problems
    from bezierplan.workspaces.problem import Path


@metric(
    "-",
    "length / length of the best feasible run of the same method and condition - 1",
    feasible_only=True,
)
def gap_best(runs: pd.DataFrame, problems: Problems) -> pd.Series:
    """Return how much longer (n,) a path is than the best of its experiment, condition and method,
    as a share of that.
    """
    best = runs.groupby(["experiment", "condition", "method"])["length"].transform("min")
    return runs["length"] / best - 1


@of_path(
    "1/u",
    f"largest curvature over {CURVATURE_SAMPLES} samples by its sign, left turns positive; "
    "corners between pieces left out",
)
def signed_curvature(path: Path) -> float:
    """Return the largest curvature of `CURVATURE_SAMPLES` samples with its sign, in 1/unit.

    Left turns are positive (song2016, eq. 5); the curvature counts as 0 where the speed is zero.
    """
    return float(np.nan_to_num(sample_curvature(path)).max())


@of_path("-", "control points that differ from each other", feasible_only=False, step=1.0)
def distinct_points(path: Path) -> int:
    """Count the distinct control points of a path."""
    return len(set(map(tuple, path.points.tolist())))


@on_map("-", "control points in occupied cells of a grid", "grid", step=1.0)
def occupied_points(path: Path, grid: Grid) -> int:
    """Count the control points in occupied cells; a point on a grid line belongs to the cell above
    or to the right.

    song2016's planner may use surplus cells outside a grid whose width is not a power of two
    (`grid.embed`); they count as occupied.
    """
    occupied = embed(grid.occupied)
    columns, rows = np.floor(grid.in_cells(path.points) + ON_LINE).astype(int).T
    # A point on the upper or right border has no cell above or to the right.
    last = np.array(occupied.shape) - 1
    return int(occupied[np.minimum(rows, last[0]), np.minimum(columns, last[1])].sum())


@metric("-", "whether the path is free and so is its control polygon", step=1.0, on=("grid",))
def free_polygon(runs: pd.DataFrame, problems: Problems) -> np.ndarray:
    """Tell which runs (n,) have a free path whose control polygon touches no occupied cell."""
    polygons = runs.assign(path_curve=np.where(runs["path_curve"] == "", "", "polyline"))
    return runs["feasible"].to_numpy() & ~np.isnan(measure_on_maps(cells, polygons, problems))


@of_path("u", "length of the control polygon", least="bound")
def polygon_length(path: Path) -> float:
    """Return the length of a path's control polygon, in units."""
    return float(np.hypot(*np.diff(path.points, axis=0).T).sum())


def find_generation_improved_by(share: float, runs: pd.DataFrame, problems: Problems) -> np.ndarray:
    """Return the first generation (n,) by which a share of the improvement from generation 0 to the
    last is made; 0 if there is none.
    """
    held = extend_histories(runs)
    return (held <= held[:, :1] - share * (held[:, :1] - held[:, -1:])).argmax(axis=1)


register(
    {
        "generation_5pct": build_generation(
            "first generation within 5 % of the run's final objective",
            partial(find_first_generation, 0.05),
        ),
        "generation_90pct_improved": build_generation(
            "first generation by which nine tenths of the run's improvement of the objective are "
            "made",
            partial(find_generation_improved_by, 0.9),
        ),
    }
)
