"""A baseline: the shortest path over free cells, counting 1 for a straight step and 1.5 for a
diagonal one. No cell-counting length (`cell_length`) can be smaller.
"""

import math

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.geometry.cell_length import DIAGONAL
from bezierplan.planners import Plan
from bezierplan.workspaces.problem import Path, Problem

workspaces = ("grid",)
deterministic = True


def plan(problem: Problem, rng: np.random.Generator) -> Plan:
    """Return the shortest path over the cells of a grid, a polyline through the centres of free
    cells.

    It leads from the cell of the start to that of the target. A step may pass between two occupied
    cells that share only a corner. Its objective is its length in cells times the side of a cell,
    or infinite if there is no path.
    """
    grid = problem.workspace
    start, target = (grid.cell_of(*end) for end in (problem.start, problem.target))
    bound = shortest_paths.lattice_path(grid.occupied, start, target, DIAGONAL, "free")
    path = None
    if math.isfinite(bound.length):
        points = _drop_straight_vertices(grid.in_units(bound.points))
        # A computed cell centre can differ from the given one in the last bit.
        points[[0, -1]] = problem.start, problem.target
        path = Path("polyline", points)
    return Plan.of_one(path, bound.length * grid.cell, "exact")


def _drop_straight_vertices(points: np.ndarray) -> np.ndarray:
    """Return a polyline (n, 2) without the vertices between two equal steps."""
    # A path within one cell still needs two points.
    steps = np.diff(points, axis=0)
    # Steps between computed centres differ in their last bits.
    turns = np.any(np.abs(steps[1:] - steps[:-1]) > 1e-9, axis=1)
    return (
        points[np.concatenate([[True], turns, [True]])]
        if len(points) > 1
        else np.repeat(points, 2, axis=0)
    )
