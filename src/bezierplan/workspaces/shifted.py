"""Maps far from the origin, such as those in projected coordinates: they are shifted to it before
anything is computed, and results are shifted back, since the certified checker keeps its tolerance
only for small numbers.

A shift is a whole number of units, so that shifting a map is exact.
"""

import math
from dataclasses import replace

import numpy as np

from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.files import Workspace
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.grown import Grown, original
from bezierplan.workspaces.limits import LARGEST
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem

Shift = tuple[float, float]


def shift_of(workspace: Workspace) -> Shift:
    """What is subtracted from a map's coordinates before anything is computed: zeros, unless one of
    them is beyond `LARGEST`.

    It is the same before and after the map grows by a robot's radius. Raises ValueError for a map
    that is wider than that.
    """
    x_low, x_high, y_low, y_high = bounds = original(workspace).bounds
    if max(map(abs, bounds)) <= LARGEST:
        return 0.0, 0.0
    shift = float(math.floor(x_low)), float(math.floor(y_low))
    if max(x_high - shift[0], y_high - shift[1]) > LARGEST:
        raise ValueError(
            f"the border: {x_high - x_low:g} x {y_high - y_low:g} units; expected at most "
            f"{LARGEST:g} on a side, so a larger unit"
        )
    return shift


def near(workspace: Workspace) -> Workspace:
    """A map where it is computed with."""
    return moved(workspace, lowered((0.0, 0.0), shift_of(workspace)))


def near_problem(problem: Problem) -> Problem:
    """A problem on the map where it is computed with."""
    start, target = (
        lowered(end, shift_of(problem.workspace)) for end in (problem.start, problem.target)
    )
    return Problem(problem.name, near(problem.workspace), start, target)


def lowered(point: tuple[float, float], shift: Shift) -> tuple[float, float]:
    """A point less a shift."""
    return point[0] - shift[0], point[1] - shift[1]


def moved(workspace: Workspace, by: Shift) -> Workspace:
    """A map whose coordinates are larger by a shift."""
    if by == (0.0, 0.0):
        return workspace
    if isinstance(workspace, Grid):
        drawn = _moved_shapes(workspace.drawn, by) if workspace.drawn else None
        origin = workspace.origin[0] + by[0], workspace.origin[1] + by[1]
        return replace(workspace, origin=origin, drawn=drawn, grown=_grown(workspace.grown, by))
    return _moved_shapes(workspace, by)


def _moved_shapes(workspace: Circles | Polygons, by: Shift) -> Circles | Polygons:
    x_low, x_high, y_low, y_high = workspace.bounds
    bounds = x_low + by[0], x_high + by[0], y_low + by[1], y_high + by[1]
    grown = _grown(workspace.grown, by)
    if isinstance(workspace, Circles):
        return replace(
            workspace, bounds=bounds, centres=workspace.centres + np.array(by), grown=grown
        )
    obstacles = tuple(tuple(ring + np.array(by) for ring in rings) for rings in workspace.obstacles)
    return replace(workspace, bounds=bounds, obstacles=obstacles, grown=grown)


def _grown(grown: Grown | None, by: Shift) -> Grown | None:
    return grown and Grown(grown.radius, moved(grown.original, by), grown.centres + np.array(by))
