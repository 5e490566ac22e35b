"""Shortest paths on grids: visibility between corners or centres of cells, in integers."""

import math
from fractions import Fraction

import numpy as np

from bezierplan.geometry.region import GridRegion, from_origin
from bezierplan.geometry.shortest_paths import shadows
from bezierplan.geometry.shortest_paths.graph import (
    Bound,
    follow_nodes,
    move_bound,
    no_path,
    shortest_in_graph,
)
from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.workspaces.grid import Grid, add_wall, find_occupied_around
from bezierplan.workspaces.problem import Problem

# A graph of cell centres has an entry for every pair of nodes; it may have this many.
_MOST_NODES = 5000

# Start and target are put on a lattice of at most this many points per cell, so that visibility is
# decided with integers.
_FINEST_LATTICE = 2**20

# Products of two coordinates of the lattice must fit in 64 bits.
_LARGEST_WHOLE = 2**30

# A value this close to a fraction with a small denominator, in cells, is taken to be that fraction.
_SAME_FRACTION = 1e-12

# A cell centre may be this far off, in cells.
_CENTRE_TOLERANCE = 1e-9


def shortest_on_grid(problem: Problem, blocked: GridRegion) -> Bound:
    """Find the shortest path along start, target and the corners at which it can turn.

    Such corners are the vertices with exactly one occupied cell around them, and contacts, at which
    two occupied cells share only a corner.
    """
    cells = np.ascontiguousarray(blocked.blocked[::2, ::2])
    corners, slopes = _list_grid_corners(cells)
    ends = from_origin(problem.ends, blocked)
    scale = _choose_lattice(
        ends / blocked.cell, min(_FINEST_LATTICE, _LARGEST_WHOLE // max(cells.shape))
    )
    lattice = np.rint(ends / blocked.cell * scale).astype(np.int64)
    # Without this test a search would look around at each corner that the start can reach.
    if not _is_joined(cells, lattice[0], lattice[1], scale):
        return no_path()
    direct = _is_visible(lattice[0], lattice[1], cells, scale)
    nodes = shadows.search(
        shadows.build_scene(cells, corners, slopes, scale),
        lattice,
        np.concatenate([ends / blocked.cell, corners]),
        direct,
    )
    return move_bound(
        follow_nodes(np.concatenate([ends, corners * blocked.cell]), nodes), blocked.origin
    )


def centre_path(problem: Problem) -> Bound:
    """Find the shortest polyline through centres of free cells of a grid, in the problem's unit.

    Raises ValueError if start or target is not the centre of a cell, within 1e-9 of a cell's side,
    and for more than `_MOST_NODES` free cells.
    """
    grid = problem.workspace
    assert isinstance(grid, Grid)
    nodes = [
        _find_centre_cell(grid, name, point)
        for name, point in (("start", problem.start), ("target", problem.target))
    ]
    if any(grid.occupied[row, column] for row, column in nodes):
        return no_path()
    cells = np.concatenate([nodes, np.argwhere(~grid.occupied)])
    if len(cells) > _MOST_NODES:
        raise ValueError(f"a graph of {len(cells)} nodes; expected at most {_MOST_NODES}")
    lattice = 2 * cells[:, ::-1] + 1
    visible = _find_visible_centres(lattice, add_wall(grid.occupied))
    return move_bound(shortest_in_graph(lattice * (0.5 * grid.cell), visible), grid.origin)


def _find_centre_cell(grid: Grid, name: str, point: tuple[float, float]) -> tuple[int, int]:
    """Return the row and column of the cell whose centre is the given point.

    Raises ValueError for any other point.
    """
    cell = grid.cell_of(*point)
    column, row = grid.in_cells(np.array(point)) - 0.5
    if cell is None or not np.allclose((row, column), cell, rtol=0, atol=_CENTRE_TOLERANCE):
        raise ValueError(f"the {name} {point} is not the centre of a cell")
    return cell


def _list_grid_corners(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """List the corners (n, 2) at which a shortest path can turn, x and y in cells, and the slopes
    (n,) of the directions that it can take from them.

    A slope of +1 stands for directions with dx dy >= 0, -1 for dx dy <= 0.
    """
    below_left, below_right, above_left, above_right = around = find_occupied_around(cells)
    # Bytes: as whole numbers of eight bytes these sums would take 128 MB on the largest map.
    number = around.view(np.int8).sum(axis=0, dtype=np.int8)
    single, pair = number == 1, number == 2
    # Around a single occupied cell a path turns from one of the two adjacent quadrants to the
    # other; at a contact it stays in the free ones.
    rising = (single & (below_right | above_left)) | (pair & below_right & above_left)
    falling = (single & (below_left | above_right)) | (pair & below_left & above_right)
    row, column = np.nonzero(rising | falling)
    corners = np.column_stack([column, row])
    slopes = np.where(rising[row, column], 1, -1)
    return corners, slopes


def _choose_lattice(points: np.ndarray, finest: int) -> int:
    """Return the least points per cell, `finest` at most, that make all coordinates integers."""
    fractions = [Fraction(value).limit_denominator(finest) for value in points.ravel().tolist()]
    scale = math.lcm(*(fraction.denominator for fraction in fractions))
    exact = all(
        abs(value - fraction) <= _SAME_FRACTION
        for value, fraction in zip(points.ravel(), fractions)
    )
    return scale if exact and scale <= finest else finest


def _is_joined(cells: np.ndarray, start: np.ndarray, target: np.ndarray, scale: int) -> bool:
    """Tell whether free cells lead from one free point of the lattice to another; they may meet at
    a corner only.
    """
    from scipy import ndimage

    parts, _ = ndimage.label(~cells, np.ones((3, 3)))
    # All free cells around a point are in the same part.
    around = (
        parts[-(-y // scale) : y // scale + 2, -(-x // scale) : x // scale + 2]
        for x, y in (start, target)
    )
    one, other = (part.max() for part in around)
    return one == other


@compile_kernel
def _find_visible_centres(nodes: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Tell which pairs i < j of cell centres see each other: bool (n, n).

    nodes: (n, 2) integers, two for each cell.
    cells: occupied cells with a ring around them.
    """
    visible = np.zeros((len(nodes), len(nodes)), np.bool_)
    for i in range(len(nodes)):
        for j in range(i + 1, len(nodes)):
            visible[i, j] = _is_visible(nodes[i], nodes[j], cells, 2)
    return visible


@allocation_free
def _is_visible(start: np.ndarray, end: np.ndarray, cells: np.ndarray, scale: int) -> bool:
    """Tell whether the segment between two free points of the lattice is free."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    if dx == 0:
        return _is_visible_along_column(start[0], min(start[1], end[1]), abs(dy), cells, scale)
    if dy == 0:
        return _is_visible_along_column(start[1], min(start[0], end[0]), abs(dx), cells.T, scale)
    return _is_visible_across(start[0], start[1], dx, dy, cells, scale)


@allocation_free
def _is_visible_along_column(x: int, low: int, length: int, cells: np.ndarray, scale: int) -> bool:
    """Tell whether a vertical segment is free.

    On a grid line it runs along edges, which are blocked if both of their cells are occupied.
    """
    column = x // scale
    on_line = x % scale == 0
    for row in range(low // scale, (low + length - 1) // scale + 1):
        if cells[row + 1, column + 1] and (not on_line or cells[row + 1, column]):
            return False
    return True


@allocation_free
def _is_visible_across(x: int, y: int, dx: int, dy: int, cells: np.ndarray, scale: int) -> bool:
    """Tell whether a slanted segment is free: a walk over the cells that it enters.

    to_x and to_y are the distances from the segment's start to the next vertical and horizontal
    grid line, along each axis.
    """
    step_x = 1 if dx > 0 else -1
    step_y = 1 if dy > 0 else -1
    width = abs(dx)
    height = abs(dy)
    column = x // scale if dx > 0 else (x - 1) // scale
    row = y // scale if dy > 0 else (y - 1) // scale
    to_x = (column + 1) * scale - x if dx > 0 else x - column * scale
    to_y = (row + 1) * scale - y if dy > 0 else y - row * scale
    while not cells[row + 1, column + 1]:
        if to_x >= width and to_y >= height:
            return True
        order = to_x * height - to_y * width
        if order <= 0:
            column += step_x
            to_x += scale
        if order >= 0:
            row += step_y
            to_y += scale
    return False
