"""A baseline: the shortest path over free cells, counting 1 for a straight step and 1.5 for a
diagonal one. No cell-counting length (`cell_length`) can be smaller.
"""

import math

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.geometry.cell_length import DIAGONAL
from bezierplan.planners import Path, Plan, Problem
from bezierplan.workspaces.lattice import drop_straight_vertices

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
    start, target = (grid.cell_of(*end) for end in problem.ends)
    bound = shortest_paths.lattice_path(grid.occupied, start, target, DIAGONAL, "free")
    path = None
    if math.isfinite(bound.length):
        points = drop_straight_vertices(grid.in_units(bound.points))
        # A path within one cell still needs two points.
        if len(points) == 1:
            points = points.repeat(2, axis=0)
        # A computed cell centre can differ from the given one in the last bit.
        points[[0, -1]] = problem.ends
        path = Path("polyline", points)
    return Plan.of_one(path, bound.length * grid.cell, "exact")
