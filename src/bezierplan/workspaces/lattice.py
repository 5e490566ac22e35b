"""The 8-connected lattice of a grid: paths from centre to centre of neighbouring free cells, and to
start and target inside their cells.

Cells are numbered as in `grid.Grid`; lengths are in cells.
"""

import heapq
import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from bezierplan.kernels import compile_kernel
from bezierplan.workspaces.grid import Grid, add_wall

Corners = IntEnum("Corners", {"free": 2, "one": 1, "none": 0})
"""How many of the two cells beside a diagonal step may be occupied."""

STEPS = np.array([(0, -1), (0, 1), (1, 0), (-1, 0), (-1, -1), (1, -1), (-1, 1), (1, 1)])
"""Rows and columns of the eight steps: W, E, N, S, SW, NW, SE, NE."""


class Lattice(NamedTuple):
    """The lattice of a problem, for kernels.

    neighbours: (cells, 8) the number of the cell that each of `STEPS` reaches, -1 where it is not
        allowed.
    around: (cells, 8) the same without any corner rule, -1 only outside the grid and for occupied
        cells.
    occupied: bool (cells,).
    row, column: (cells,).
    start, target: cells.
    diagonal: length of a diagonal step, others count 1.
    ends: total distance of start and target from the centres of their cells, 0 if they coincide.
    """

    neighbours: np.ndarray
    around: np.ndarray
    occupied: np.ndarray
    row: np.ndarray
    column: np.ndarray
    start: int
    target: int
    diagonal: float
    ends: float


def build_grid_lattice(
    grid: Grid, start: tuple[float, float], target: tuple[float, float], corners: str
) -> Lattice:
    """Build the lattice of a grid with the cells of start and target, both (x, y) in units.

    Raises ValueError if one of them lies in an occupied cell.
    """
    rows, columns = grid.occupied.shape
    cells, ends = [], 0.0
    for name, point in (("start", start), ("target", target)):
        cell = grid.cell_of(*point)
        assert cell  # the ends of a problem lie on its map
        if grid.occupied[cell]:
            raise ValueError(
                f"{name}: {point}: in the occupied cell of row {cell[0]}, column {cell[1]}; "
                "expected a point of a free cell"
            )
        cells.append(cell[0] * columns + cell[1])
        # A path from a place to itself has no length.
        if start != target:
            ends += math.dist(point, grid.centre(cells[-1])) / grid.cell
    row, column = np.divmod(np.arange(rows * columns), columns)
    first, last = cells
    return Lattice(
        list_neighbours(grid.occupied, corners),
        _list_free_cells_around(grid.occupied),
        grid.occupied.ravel(),
        row,
        column,
        first,
        last,
        math.sqrt(2),
        ends,
    )


def list_neighbours(occupied: np.ndarray, corners: str) -> np.ndarray:
    """List the cells that each of `STEPS` reaches: (cells, 8) numbers, -1 where a step is not
    allowed and from occupied cells.

    occupied: bool (rows, columns).
    """
    walled = add_wall(occupied)
    # The frame spares a test for steps beyond the border.
    row, column = np.argwhere(~occupied).T + 1
    # The two cells next to a step; for a step along an axis these are the cells that it leaves and
    # enters.
    beside = [
        walled[row + up, column].astype(int) + walled[row, column + right] for up, right in STEPS
    ]
    reached = np.full((occupied.size, len(STEPS)), -1)
    free = np.flatnonzero(~occupied)
    reached[free] = np.where(
        np.column_stack(beside) <= Corners[corners], _list_free_cells_around(occupied)[free], -1
    )
    return reached


def _list_free_cells_around(occupied: np.ndarray) -> np.ndarray:
    """List the free cells around each cell, free or not: (cells, 8) numbers, or -1 for none."""
    number = np.pad(
        np.where(occupied, -1, np.arange(occupied.size).reshape(occupied.shape)),
        1,
        constant_values=-1,
    )
    row, column = np.indices(occupied.shape).reshape(2, -1) + 1
    return np.column_stack([number[row + up, column + right] for up, right in STEPS])


def compute_distances(occupied: np.ndarray, row: int, column: int) -> np.ndarray:
    """Return the distance (rows, columns) from a cell to each cell over free cells and their eight
    neighbours, infinite where there is no path.
    """
    return _compute_distances(add_wall(occupied), row + 1, column + 1, STEPS)[1:-1, 1:-1]


@compile_kernel
def _compute_distances(walls, row, column, steps):
    """Compute the distance of each cell from one by Dijkstra's algorithm; `walls` frames the grid
    with occupied cells.

    scipy takes six times as long, for its graph: as long as half of a run on 200 x 200 cells.
    """
    far = np.full(walls.shape, np.inf)
    far[row, column] = 0.0
    heap = [(0.0, row, column)]
    while len(heap) > 0:
        length, row, column = heapq.heappop(heap)
        # An outdated entry: a shorter way to the cell was found after it.
        if length > far[row, column]:
            continue
        for k in range(len(steps)):
            up, right = row + steps[k, 0], column + steps[k, 1]
            ahead = length + math.sqrt(steps[k, 0] ** 2 + steps[k, 1] ** 2)
            if not walls[up, right] and ahead < far[up, right]:
                far[up, right] = ahead
                heapq.heappush(heap, (ahead, up, right))
    return far


def list_points(
    grid: Grid, start: tuple[float, float], target: tuple[float, float], cells: np.ndarray
) -> np.ndarray:
    """List start, the centres of cells (n,), and target, in units: (n + 2, 2).

    There are fewer where start or target is itself a centre; no cells if start equals target.
    """
    if start == target:
        return np.array([start, target])
    centres = [grid.centre(cell) for cell in cells.tolist()]
    return np.array(
        [start, *centres[centres[0] == start : len(centres) - (centres[-1] == target)], target]
    )


def drop_straight_vertices(points: np.ndarray) -> np.ndarray:
    """Return a polyline (n, 2) without the vertices between two equal steps."""
    steps = np.diff(points, axis=0)
    # Steps between computed centres differ in their last bits.
    turns = np.any(np.abs(steps[1:] - steps[:-1]) > 1e-9, axis=1)
    # A single point is both the first and the last.
    return points[np.concatenate([[True], turns, [True]])[-len(points) :]]
