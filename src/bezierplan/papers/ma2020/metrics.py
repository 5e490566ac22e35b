"""Metrics of ma2020 alone."""

from __future__ import annotations

from functools import cache, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.analysis.measures import CORNER, compute_heading_changes, measure_heading_changes
from bezierplan.analysis.metric import measure_on_maps, metric, of_path, on_map
from bezierplan.workspaces.grid import Grid

if TYPE_CHECKING:
    import pandas as pd
    from shapely import Geometry

    from bezierplan.analysis.metric import Problems
    from bezierplan.geometry.region import Region
    from bezierplan.workspaces.problem import Path


@of_path("rad", "largest change of heading between neighbouring chords")
def heading_max(path: Path) -> float:
    """Return the largest change of heading between neighbouring chords, in radians."""
    return float(measure_heading_changes(path).max(initial=0.0))


@on_map(
    "-",
    "corners of a polyline that can be left out, because a free leg joins the corners before "
    "and after; none for a curve",
    "grid",
    step=1.0,
)
def spare_corners(path: Path, grid: Grid) -> float:
    """Count the corners of a polyline that can be left out, NaN for a curve.

    A straight leg that enters no occupied cell joins the corners before and after.
    """
    return float(_find_spare(_list_turns(path), grid).sum()) if path.curve == "polyline" else np.nan


@on_map("u", "length of a polyline without the corners that can be left out", "grid")
def length_without_spares(path: Path, grid: Grid) -> float:
    """Return the length of a polyline after its superfluous corners are removed one by one, the
    first one each time.

    NaN for a curve.
    """
    if path.curve != "polyline":
        return np.nan
    turns = _list_turns(path)
    # One at a time: a corner may be needed once its neighbour is gone.
    while (spare := _find_spare(turns, grid)).any():
        turns = np.delete(turns, spare.argmax() + 1, axis=0)
    return float(np.hypot(*np.diff(turns, axis=0).T).sum())


def _list_turns(path: Path) -> np.ndarray:
    """List the ends and corners (n, 2) of a polyline."""
    steps = np.diff(path.points, axis=0)
    moved = np.hypot(*steps.T) > 0
    places, turned = path.points[1:][moved], compute_heading_changes(steps[moved])
    return np.concatenate([path.points[:1], places[:-1][turned > CORNER], places[-1:]])


def _find_spare(turns: np.ndarray, grid: Grid) -> np.ndarray:
    """Tell which inner corners of a polyline (n, 2) can be left out (n - 2,)."""
    import shapely

    legs = shapely.linestrings(np.stack([turns[:-2], turns[2:]], axis=1))
    return ~shapely.intersects(_build_inside(grid), legs)


@lru_cache(maxsize=8)
def _build_inside(grid: Grid) -> Geometry:
    """Build the shape that a path must not enter: the occupied cells of a grid, a billionth of a
    cell smaller, since a path may touch them.
    """
    import shapely

    rows, columns = np.nonzero(grid.occupied)
    x, y = grid.origin[0] + grid.cell * columns, grid.origin[1] + grid.cell * rows
    whole = shapely.union_all(shapely.box(x, y, x + grid.cell, y + grid.cell))
    inner = whole.buffer(-1e-9 * grid.cell)
    shapely.prepare(inner)
    return inner


@metric(
    "u",
    "least distance to the occupied cells of a grid, its border not counted",
    feasible_only=True,
    on=("grid",),
)
def obstacle_clearance(runs: pd.DataFrame, problems: Problems) -> list[float]:
    """Return the least distance (n,) from a path in a grid to its occupied cells; infinite without
    any.
    """
    return measure_on_maps(_measure_clearance, runs, problems)


def _measure_clearance(path: Path, grid: Grid) -> float:
    """Measure the least distance from a free path to the occupied cells of a grid.

    This is the checker's clearance, which counts the border, in the same grid padded with free
    cells so that the border is farthest.
    """
    from bezierplan.geometry import checker, curves

    if not grid.occupied.any():
        return np.inf
    moved = path._replace(points=(grid.in_cells(path.points) + _find_margin(grid)) * grid.cell)
    return checker.check(curves.bezier_pieces(moved), _build_padded(grid)).clearance


def _find_margin(grid: Grid) -> int:
    """Find how many free cells round a grid move its border farther away than any cell of it."""
    return sum(grid.occupied.shape)


@cache
def _build_padded(grid: Grid) -> Region:
    """Build the blocked region of a grid with free cells round it."""
    from bezierplan.geometry.region import build_region

    return build_region(Grid(np.pad(grid.occupied, _find_margin(grid)), grid.cell, ""))


@metric(
    "-",
    "whether the planner's safety distance from the occupied cells is kept",
    feasible_only=True,
    step=1.0,
    needs=("safety_distance",),
    on=("grid",),
)
def keeps_distance(runs: pd.DataFrame, problems: Problems) -> pd.Series:
    """Tell which paths (n,) keep their planner's safety distance from the obstacles; NaN where the
    planner has none.
    """
    kept = np.array(obstacle_clearance(runs, problems)) >= runs["safety_distance"]
    return kept.astype(float).where(runs["safety_distance"].notna())


@metric(
    "u",
    "length of a path that keeps the planner's safety distance",
    feasible_only=True,
    needs=("safety_distance",),
    on=("grid",),
)
def length_at_distance(runs: pd.DataFrame, problems: Problems) -> pd.Series:
    """Return the lengths (n,) of paths that keep their planner's safety distance; NaN of all
    others.
    """
    return runs["length"].where(keeps_distance(runs, problems) == 1)
