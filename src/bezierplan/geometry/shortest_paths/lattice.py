"""Shortest paths over the 8 neighbours of free cells."""

import heapq

import numpy as np

from bezierplan.geometry.shortest_paths.graph import Bound, no_path
from bezierplan.kernels import compile_kernel
from bezierplan.workspaces.grid import add_wall
from bezierplan.workspaces.lattice import STEPS, Corners


def lattice_path(
    occupied: np.ndarray,
    start: tuple[int, int],
    target: tuple[int, int],
    diagonal_weight: float,
    corner_rule: str,
) -> Bound:
    """Find the shortest path over the 8 neighbours of free cells, by the algorithm A*; length and
    points (x, y) in cells.

    occupied: bool (rows, columns). start, target: row and column. diagonal_weight: length of a
    diagonal step; others count 1. corner_rule: how many of the two cells beside a diagonal step may
    be occupied.

    The rule `free` allows a diagonal step past an occupied cell, the rule `none` does not:

    >>> from bezierplan.workspaces.grid import from_lines
    >>> occupied = from_lines(["....", ".##.", "...."], cell=1.0, unit="m").occupied
    >>> ends = {"start": (0, 0), "target": (2, 3)}
    >>> lattice_path(occupied, **ends, diagonal_weight=1.5, corner_rule="free").length
    4.5
    >>> lattice_path(occupied, **ends, diagonal_weight=1.5, corner_rule="none").length
    5.0
    """
    if occupied[start] or occupied[target]:
        return no_path()

    walled_cells = add_wall(occupied)
    length, cells = _find_least_cells(
        walled_cells,
        np.array(start) + 1,
        np.array(target) + 1,
        STEPS,
        diagonal_weight,
        int(Corners[corner_rule]),
    )
    row, column = np.divmod(cells, walled_cells.shape[1])
    return Bound(length, np.column_stack([column - 0.5, row - 0.5]))


@compile_kernel
def _find_least_cells(walls, start, target, steps, diagonal_weight, most_beside):
    """Find a shortest path by A*.

    Returns its length and its cells (n,), numbered row by row; infinite and empty if there is no
    path.

    walls: bool (rows, columns), the cells with a frame of occupied ones.
    start, target: row and column.
    most_beside: how many of the two cells beside a diagonal step may be occupied.

    The remaining length is estimated by the shortest path without obstacles, so only cells near the
    shortest paths are examined.
    """
    columns = walls.shape[1]
    # A step of either kind may be replaced by two of the other kind.
    straight, diagonal = min(1.0, diagonal_weight), min(diagonal_weight, 2.0)
    length = np.full(walls.shape, np.inf)
    came_by = np.full(walls.shape, -1, np.int8)
    settled = np.zeros(walls.shape, np.bool_)
    length[start[0], start[1]] = 0.0
    # Estimated length, the part of it still ahead, and the cell; ties go to those nearest to the
    # target.
    heap = [(0.0, 0.0, start[0], start[1])]
    while len(heap) > 0:
        _, _, row, column = heapq.heappop(heap)
        if row == target[0] and column == target[1]:
            break
        if settled[row, column]:
            continue
        settled[row, column] = True
        for k in range(len(steps)):
            next_row, next_column = row + steps[k, 0], column + steps[k, 1]
            is_diagonal = next_row != row and next_column != column
            if walls[next_row, next_column] or settled[next_row, next_column]:
                continue
            if is_diagonal and walls[next_row, column] + walls[row, next_column] > most_beside:
                continue
            so_far = length[row, column] + (diagonal_weight if is_diagonal else 1.0)
            if so_far < length[next_row, next_column]:
                length[next_row, next_column] = so_far
                came_by[next_row, next_column] = k
                up, right = abs(target[0] - next_row), abs(target[1] - next_column)
                ahead = diagonal * min(up, right) + straight * abs(up - right)
                heapq.heappush(heap, (so_far + ahead, ahead, next_row, next_column))

    if length[target[0], target[1]] == np.inf:
        return np.inf, np.empty(0, np.int64)
    row, column = target[0], target[1]
    cells = [row * columns + column]
    diagonals = 0
    while came_by[row, column] >= 0:
        step = steps[came_by[row, column]]
        row -= step[0]
        column -= step[1]
        cells.append(row * columns + column)
        diagonals += step[0] != 0 and step[1] != 0
    # Steps are counted and then weighed, so equal steps give equal bits.
    return len(cells) - 1 - diagonals + diagonal_weight * diagonals, np.array(cells)[::-1]
