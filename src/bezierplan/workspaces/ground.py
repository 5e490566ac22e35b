"""The ground of a grid for paths from cell to cell: which edges meet obstacles, what they cost, and
the cheapest path (meledje).

An edge is the straight line between the centres of two cells. It meets a cell if it passes through
its interior; touching a side or a corner does not count, unless corners are closed. This is decided
in integer arithmetic.

Lengths, heights and energies are in cells. On a map with few cells all edges are measured once, on
a larger one when they are needed; the numbers are identical to the last bit.
"""

from enum import IntEnum
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_inline, compile_kernel
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.trace import trace_back

# For a map with more cells than this no table of all edges is made: it would grow with the square
# of their number. At this one both tables take 42 MB, and those of the last eight maps are kept.
TABLE_CELLS = 2048

Neighbourhood = IntEnum("Neighbourhood", "eight four within_two")
"""The neighbours of a cell: the eight around it, the four beside it, or all at most two columns and
rows away."""

MOST_NEIGHBOURS = 24


class Ground(NamedTuple):
    """The ground on which edges are measured, in cells, numbered row by row from the bottom left.

    occupied: bool (rows, columns).
    heights: (rows, columns), or (0, 0) on flat ground.
    friction: at most 1 on most kinds of ground.
    closed: true if an edge through a common corner of four cells meets the two next to it.
    encounters, energy: (cells, cells) for the edge from one cell to another, the number of occupied
        cells it meets and its cost; or (0, 0).
    """

    occupied: np.ndarray
    heights: np.ndarray
    friction: float
    closed: bool
    encounters: np.ndarray
    energy: np.ndarray


@lru_cache(maxsize=8)
def build_ground(grid: Grid, friction: float, closed: bool = False) -> Ground:
    """Build the ground of a grid, with all its edges measured if it has at most `TABLE_CELLS`
    cells.

    Do not modify the result: it is kept for the next run on the same map.
    """
    heights = np.empty((0, 0)) if grid.heights is None else grid.heights / grid.cell
    # A copy: for a read-only array numba would compile the kernels once more.
    cells, empty = grid.occupied.copy(), np.empty((0, 0))
    bare = Ground(cells, heights, friction, closed, empty.astype(np.uint16), empty)
    if cells.size > TABLE_CELLS:
        return bare
    encounters, energy = _build_tables(bare)
    return bare._replace(encounters=encounters, energy=energy)


@lru_cache(maxsize=64)
def find_least_energy(grid: Grid, friction: float, closed: bool, start: int, target: int) -> float:
    """Return the energy of `find_cheapest` on the ground of a grid, cached."""
    return find_cheapest(build_ground(grid, friction, closed), start, target)[0]


@compile_kernel
def _build_tables(ground):
    """Measure the edges between all pairs of cells: how many occupied cells they meet, and their
    energy, both (cells, cells).
    """
    cells = ground.occupied.size
    # Two bytes are enough for the cells of a map with a table, and save memory.
    encounters, energy = np.empty((cells, cells), np.uint16), np.empty((cells, cells))
    # Back and forth an edge meets the same cells, but climbs differently.
    for one in range(cells):
        for other in range(one + 1):
            encounters[one, other] = encounters[other, one] = count_obstacles_on(ground, one, other)
            energy[one, other] = energy[other, one] = compute_edge_energy(ground, one, other)
            if ground.heights.size:
                energy[other, one] = compute_edge_energy(ground, other, one)
    return encounters, energy


@compile_inline
def count_obstacles_on(ground: Ground, start: int, end: int) -> int:
    """Count the occupied cells that the edge between two cells meets, including the two (meledje,
    eq. 3: beta).
    """
    if ground.encounters.size:
        return int(ground.encounters[start, end])
    return _measure_edge(ground, start, end)[0]


@allocation_free
def count_obstacles_along(path: np.ndarray, ground: Ground) -> int:
    """Count the occupied cells that the edges of a path of cells (n,) meet; a cell counts once for
    every edge that meets it.
    """
    encounters = 0
    for k in range(len(path) - 1):
        encounters += count_obstacles_on(ground, path[k], path[k + 1])
    return encounters


@compile_inline
def compute_edge_energy(ground: Ground, start: int, end: int) -> float:
    """Return the cost of the edge from one cell to another: its length plus its climb divided by
    the friction (meledje, eq. 2: epsilon).
    """
    if ground.energy.size:
        return ground.energy[start, end]
    length = measure_distance(ground, start, end)
    return (
        length + _measure_edge(ground, start, end)[1] / ground.friction
        if ground.heights.size
        else length
    )


@allocation_free
def measure_distance(ground: Ground, start: int, end: int) -> float:
    """Return the length of the edge between two cells."""
    columns = ground.occupied.shape[1]
    across, up = end % columns - start % columns, end // columns - start // columns
    return np.sqrt(float(across * across + up * up))


@allocation_free
def _measure_edge(ground, start, end):
    """Count the occupied cells that an edge meets, and sum up its climbs from cell to cell.

    The edge crosses its next vertical grid line after (2 i + 1) / (2 across) of its length, its
    next horizontal one after (2 j + 1) / (2 up); through a corner it leads from cell to cell
    without a third, but meets the two next to the corner if corners are closed.
    """
    columns = ground.occupied.shape[1]
    row, column = start // columns, start % columns
    across, up = end % columns - column, end // columns - row
    right, upward = (1 if across > 0 else -1), (1 if up > 0 else -1)
    across, up = abs(across), abs(up)
    encounters, climb = int(ground.occupied[row, column]), 0.0
    i = j = 0
    while i < across or j < up:
        height = ground.heights[row, column] if ground.heights.size else 0.0
        # Whole numbers: a corner is met exactly or not at all.
        ahead = (2 * i + 1) * up - (2 * j + 1) * across
        if ahead == 0 and ground.closed:
            encounters += int(ground.occupied[row, column + right]) + int(
                ground.occupied[row + upward, column]
            )
        if ahead <= 0:
            i += 1
            column += right
        if ahead >= 0:
            j += 1
            row += upward
        encounters += int(ground.occupied[row, column])
        if ground.heights.size:
            # Only climbs cost energy; a descent gives none back.
            climb += max(ground.heights[row, column] - height, 0.0)
    return encounters, climb


def find_cheapest(ground: Ground, start: int, target: int) -> tuple[float, np.ndarray]:
    """Find the path from cell to cell with the least energy that meets no obstacle.

    Returns the energy, in cells, and the path's cells; infinite and empty if there is no such path.
    """
    energy, before = _find_cheapest(ground, start, target)
    return energy, trace_back(before, target, energy)


@compile_kernel
def _find_cheapest(ground, start, target):
    """Find the least energy from start to target by A*; return it, and the cell before each cell on
    the cheapest way.

    The straight distance guides the search. An edge is examined only if it would be an improvement:
    on a large map few are.
    """
    cells = ground.occupied.size
    energy = np.full(cells, np.inf)
    before = np.full(cells, -1)
    # An edge to an occupied cell meets it, so none leads there.
    done = ground.occupied.ravel().copy()
    energy[start] = 0.0
    while True:
        # A search for the next cell takes no more than its edges, one to each cell: no heap is
        # needed.
        here, least = -1, np.inf
        for cell in range(cells):
            if not done[cell] and energy[cell] + measure_distance(ground, cell, target) < least:
                here, least = cell, energy[cell] + measure_distance(ground, cell, target)
        if here < 0 or here == target:
            return energy[target], before
        done[here] = True
        for cell in range(cells):
            if (
                not done[cell]
                and energy[here] + measure_distance(ground, here, cell) < energy[cell]
                and count_obstacles_on(ground, here, cell) == 0
            ):
                through = energy[here] + compute_edge_energy(ground, here, cell)
                if through < energy[cell]:
                    energy[cell], before[cell] = through, here


def centres(grid: Grid, cells: np.ndarray) -> np.ndarray:
    """Return the centres (n, 2) of cells (n,), in units."""
    return np.array([grid.centre(cell) for cell in cells.tolist()]).reshape(-1, 2)


@allocation_free
def list_free_neighbours(
    cell: int, ground: Ground, neighbourhood: int, neighbours: np.ndarray
) -> int:
    """Write the free cells among the neighbours of a cell (`Neighbourhood`), row by row from the
    lower left, to `neighbours` (MOST_NEIGHBOURS,), and return their number.
    """
    rows, columns = ground.occupied.shape
    own_row, own_column = divmod(cell, columns)
    reach = 2 if neighbourhood == Neighbourhood.within_two else 1
    count = 0
    for row in range(max(own_row - reach, 0), min(own_row + reach + 1, rows)):
        for column in range(max(own_column - reach, 0), min(own_column + reach + 1, columns)):
            if row == own_row and column == own_column:
                continue
            diagonal = row != own_row and column != own_column
            if neighbourhood == Neighbourhood.four and diagonal:
                continue
            if not ground.occupied[row, column]:
                neighbours[count] = row * columns + column
                count += 1
    return count
