"""A shortest path over the centres of free cells, with four or eight neighbours of a cell (A*)."""

import heapq
import itertools
import math

import numpy as np

from bezierplan.planners import Path, Plan

workspaces = ("grid",)
deterministic = True
extra = ("expanded",)


def plan(problem, rng, *, diagonal: bool):
    """The path; a diagonal step passes between free cells only. Its extra column `expanded` counts
    the cells whose neighbours were looked at.
    """
    grid = problem.workspace
    start, target = grid.cell_of(*problem.start), grid.cell_of(*problem.target)
    came, cost, expanded = {start: None}, {start: 0.0}, set()
    queue = [(math.dist(start, target), start)]
    while queue and target not in expanded:
        _, cell = heapq.heappop(queue)
        if cell in expanded:
            continue
        expanded.add(cell)
        for step in itertools.product((-1, 0, 1), repeat=2):
            other = cell[0] + step[0], cell[1] + step[1]
            if (all(step) and not diagonal) or not _free(grid, cell, other):
                continue
            longer = cost[cell] + math.hypot(*step)
            if longer < cost.get(other, math.inf):
                came[other], cost[other] = cell, longer
                heapq.heappush(queue, (longer + math.dist(other, target), other))
    if target not in expanded:
        return Plan.of_one(None, math.inf, "no way", {"expanded": float(len(expanded))})
    cells = [target]
    while came[cells[-1]] is not None:
        cells.append(came[cells[-1]])
    points = np.array([[column, row] for row, column in reversed(cells)]) + 0.5
    path = Path("polyline", np.array(grid.origin) + grid.cell * points)
    length = grid.cell * cost[target]
    return Plan.of_one(path, length, "found", {"expanded": float(len(expanded))})


def _free(grid, cell, other):
    """Whether a cell is on the map and free, as are those that a step to it passes between."""
    rows, columns = grid.occupied.shape
    return (
        0 <= other[0] < rows
        and 0 <= other[1] < columns
        and not grid.occupied[other]
        and not grid.occupied[cell[0], other[1]]
        and not grid.occupied[other[0], cell[1]]
    )
