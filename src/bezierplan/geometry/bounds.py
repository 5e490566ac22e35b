"""Exact shortest paths of a point robot: any-angle on grids, around circles and polygons; through cell centres; on the 8-connected lattice.

They read the same region as the certified check, and the paths that they give are free by it: touching is allowed.
"""

import heapq
import math
from fractions import Fraction
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numba import njit

from bezierplan.geometry.checker import TOLERANCE, check, first_collision
from bezierplan.geometry.region import CircleRegion, GridRegion, PolygonRegion, from_origin, occupied_around, region, walled
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.lattice import CORNERS, STEPS, Corners
from bezierplan.workspaces.problem import Problem

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# A graph has an entry for every pair of nodes; with more nodes than this a search that keeps no pairs takes its place.
MOST_NODES = 5000
MOST_POLYGON_NODES = 500

# Start and target are put on a lattice of at most this many points a cell, so that visibility is decided with whole numbers.
_FINEST_LATTICE = 2**20

# Products of two coordinates of the lattice must fit in 64 bits.
_LARGEST_WHOLE = 2**30

# A value this near to a fraction with a small denominator, in cells, is meant as that fraction.
_SAME_FRACTION = 1e-12

# The polyline along arcs is at most this much longer than they are, in units.
POLYLINE_EXCESS = 1e-6

# Arcs that overlap by less than this angle count as touching.
_SAME_ANGLE = 1e-8

# A polyline around an arc is refined this many times at most to keep clear of a neighbouring circle.
_REFINEMENTS = 20

# A cell centre may be this far off, in cells.
_CENTRE_TOLERANCE = 1e-9

# Sparse matrices take an entry of zero for no edge.
_NO_LENGTH = 1e-300


class Bound(NamedTuple):
    """A shortest path.

    length: in the problem's unit, infinite if there is no path. points: (n, 2) a polyline along it from start to target, (0, 2) if there
    is no path.
    """

    length: float
    points: np.ndarray


def least_length(bound: Bound) -> float:
    """The least length that a path may have which the certified check calls free.

    Such a path may be a few 1e-9 deep and cuts its bends by that; the allowance is a relative 1e-9 and 1e-8 a radian of turning. Obstacles
    that are sharper than a right angle and gaps below 1e-7 can allow more.
    """
    step = np.diff(bound.points, axis=0)
    step = step[np.hypot(step[:, 0], step[:, 1]) > TOLERANCE]
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    return bound.length * (1 - 1e-9) - 1e-8 * float(np.abs(np.diff(heading)).sum())


def shortest_path(problem: Problem, corner_cutting: Literal["open", "closed"] = "open") -> Bound:
    """The shortest path from start to target; no path if one of them is blocked.

    corner_cutting: whether it may pass between two occupied cells that meet only by a corner; matters on grids only.

    On a grid the visibility of start and target is decided for the nearest points of a lattice: coordinates that are no fractions of a cell
    with a common denominator of at most 2**20 are off by up to 5e-7 cells there. Lengths are those of the points themselves. Around circles
    the length is a sum of closed forms, and the polyline is up to `POLYLINE_EXCESS` longer.

    Raises ValueError for an unknown rule of corner cutting, and for the rule `closed` on a grid with more than `MOST_NODES` corners.
    """
    blocked = region(problem.workspace)
    for point in (problem.start, problem.target):
        if not check(np.array([[point, point]]), blocked, corner_cutting).feasible:
            return _no_path()
    if isinstance(blocked, GridRegion):
        return _shortest_on_grid(problem, blocked, corner_cutting)
    if isinstance(blocked, CircleRegion):
        return _shortest_around_circles(problem, blocked)
    return _shortest_among_polygons(problem, blocked)


def centre_path(problem: Problem) -> Bound:
    """The shortest polyline through centres of free cells of a grid, in the problem's unit.

    Raises ValueError if start or target is not the centre of a cell, within 1e-9 of a cell's side, and for more than `MOST_NODES` free
    cells.
    """
    grid = problem.workspace
    nodes = [_centre_cell(grid, name, point) for name, point in (("start", problem.start), ("target", problem.target))]
    if any(grid.occupied[row, column] for row, column in nodes):
        return _no_path()
    cells = np.concatenate([nodes, np.argwhere(~grid.occupied)])
    _refuse_large(len(cells))
    lattice = 2 * cells[:, ::-1] + 1
    anything = np.zeros((len(cells), 2), dtype=np.int64)
    visible = _visible_on_grid(lattice, anything[:, 0], anything, walled(grid.occupied), 2, False)
    return _moved(_shortest_in_graph(lattice * (0.5 * grid.cell), visible), grid.origin)


def _centre_cell(grid: Grid, name: str, point: tuple[float, float]) -> tuple[int, int]:
    """Row and column of the cell whose centre a point is."""
    column, row = grid.in_cells(np.array(point)) - 0.5
    rows, columns = grid.occupied.shape
    is_centre = abs(column - round(column)) <= _CENTRE_TOLERANCE and abs(row - round(row)) <= _CENTRE_TOLERANCE
    if not (is_centre and 0 <= round(row) < rows and 0 <= round(column) < columns):
        raise ValueError(f"the {name} {point} is not the centre of a cell")
    return round(row), round(column)


def lattice_path(
    occupied: np.ndarray,
    start: tuple[int, int],
    target: tuple[int, int],
    diagonal_weight: float,
    corner_rule: Corners,
) -> Bound:
    """The shortest path over the 8 neighbours of free cells, by the algorithm A*; length and points (x, y) in cells.

    occupied: bool (rows, columns). start, target: row and column. diagonal_weight: length of a diagonal step; others count 1. corner_rule:
    how many of the two cells beside a diagonal step may be occupied.
    Raises ValueError for an unknown rule and for a start or target outside of the grid.
    """
    if corner_rule not in CORNERS:
        raise ValueError(f"unknown corner rule {corner_rule!r}; known: {', '.join(CORNERS)}")
    rows, columns = occupied.shape
    for name, (row, column) in (("start", start), ("target", target)):
        if not (0 <= row < rows and 0 <= column < columns):
            raise ValueError(f"the {name} cell (row {row}, column {column}) is not on the grid of {rows} x {columns} cells")
    if occupied[start] or occupied[target]:
        return _no_path()

    walled_cells = np.pad(occupied, 1, constant_values=True)
    length, cells = _least_cells(walled_cells, np.array(start) + 1, np.array(target) + 1, STEPS, diagonal_weight, CORNERS[corner_rule])
    row, column = np.divmod(cells, columns + 2)
    return Bound(length, np.column_stack([column - 0.5, row - 0.5]))


@njit(cache=True)
def _least_cells(walled, start, target, steps, diagonal_weight, most_beside):
    """Length of a shortest path and its cells (n,), numbered row by row; infinite and none if there is no path.

    walled: bool (rows, columns), the cells with a frame of occupied ones. start, target: row and column. most_beside: how many of the two
    cells beside a diagonal step may be occupied. What is left is estimated by the shortest path without obstacles, so only cells around the
    shortest paths are looked at.
    """
    columns = walled.shape[1]
    # A step of each kind may be replaced by two of the other kind.
    straight, diagonal = min(1.0, diagonal_weight), min(diagonal_weight, 2.0)
    length = np.full(walled.shape, np.inf)
    came_by = np.full(walled.shape, -1, dtype=np.int8)
    settled = np.zeros(walled.shape, dtype=np.bool_)
    length[start[0], start[1]] = 0.0
    # Estimated length, the part of it that is ahead, and the cell; of equally long ones those nearest to the target come first.
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
            if walled[next_row, next_column] or settled[next_row, next_column]:
                continue
            if is_diagonal and walled[next_row, column] + walled[row, next_column] > most_beside:
                continue
            so_far = length[row, column] + (diagonal_weight if is_diagonal else 1.0)
            if so_far < length[next_row, next_column]:
                length[next_row, next_column] = so_far
                came_by[next_row, next_column] = k
                up, right = abs(target[0] - next_row), abs(target[1] - next_column)
                ahead = diagonal * min(up, right) + straight * abs(up - right)
                heapq.heappush(heap, (so_far + ahead, ahead, next_row, next_column))

    if length[target[0], target[1]] == np.inf:
        return np.inf, np.empty(0, dtype=np.int64)
    row, column = target[0], target[1]
    cells = [row * columns + column]
    diagonals = 0
    while came_by[row, column] >= 0:
        step = steps[came_by[row, column]]
        row -= step[0]
        column -= step[1]
        cells.append(row * columns + column)
        diagonals += step[0] != 0 and step[1] != 0
    return len(cells) - 1 - diagonals + diagonal_weight * diagonals, np.array(cells)[::-1]


def _moved(bound: Bound, by: np.ndarray | tuple[float, float]) -> Bound:
    """A path measured from a grid's corner, measured from the origin."""
    return bound._replace(points=bound.points + by)


def _no_path() -> Bound:
    return Bound(math.inf, np.empty((0, 2)))


def _refuse_large(nodes: int) -> None:
    if nodes > MOST_NODES:
        raise ValueError(f"the visibility graph has {nodes} nodes, more than {MOST_NODES}; use a coarser or a smaller workspace")


def _dijkstra(graph: "csr_array", start: int, target: int) -> tuple[float, np.ndarray]:
    """Length of a shortest path in a sparse graph, whose edges go both ways, and the nodes along it; none without a path."""
    from scipy.sparse.csgraph import dijkstra

    distances, predecessors = dijkstra(graph, directed=False, indices=start, return_predecessors=True)
    if math.isinf(distances[target]):
        return math.inf, np.empty(0, dtype=np.int64)
    nodes = [target]
    while nodes[-1] != start:
        nodes.append(int(predecessors[nodes[-1]]))
    return float(distances[target]), np.array(nodes[::-1])


def _shortest_in_graph(points: np.ndarray, visible: np.ndarray) -> Bound:
    """The shortest polyline from the first to the second of some points (n, 2), along pairs that see each other: bool (n, n), i < j."""
    from scipy.sparse import coo_array

    tail, head = np.nonzero(visible)
    lengths = np.hypot(*(points[head] - points[tail]).T)
    graph = coo_array((np.maximum(lengths, _NO_LENGTH), (tail, head)), shape=visible.shape).tocsr()
    _, nodes = _dijkstra(graph, 0, 1)
    if not len(nodes):
        return _no_path()
    return _along(points, nodes)


def _along(points: np.ndarray, nodes: np.ndarray) -> Bound:
    """The polyline along some of the points (n, 2), without repeated ones; no path without nodes."""
    if not len(nodes):
        return _no_path()
    path = points[nodes]
    moving = np.any(np.diff(path, axis=0) != 0, axis=1)
    path = np.concatenate([path[:1], path[1:][moving]]) if moving.any() else path[:2]
    return Bound(math.fsum(np.hypot(*np.diff(path, axis=0).T)), path)


# ---------------------------------------------------------------------------------------------------------------------
# Grids: visibility between corners, in whole numbers


def _shortest_on_grid(problem: Problem, blocked: GridRegion, corner_cutting: str) -> Bound:
    """The visibility graph of start, target and the corners at which a shortest path can turn.

    Those are the vertices with exactly one occupied cell around them, and contacts. A contact that is closed is two nodes, one a free
    quadrant, each with directions of its own quadrant only.
    """
    cells = np.ascontiguousarray(blocked.blocked[::2, ::2])
    corners, slopes, quadrants = _grid_corners(cells, corner_cutting == "closed")
    ends = from_origin(np.array([problem.start, problem.target], dtype=float), blocked)
    scale = _lattice(ends / blocked.cell, min(_FINEST_LATTICE, _LARGEST_WHOLE // max(cells.shape)))
    lattice = np.concatenate([np.rint(ends / blocked.cell * scale).astype(np.int64), corners * scale])
    slopes = np.concatenate([[0, 0], slopes])
    if len(lattice) > MOST_NODES and corner_cutting == "open":
        most = _least_over_cells(problem)
        if math.isinf(most):
            return _no_path()
        nodes = _search_grid(np.concatenate([ends / blocked.cell, corners]), lattice, slopes, cells, scale, most)
        return _moved(_along(np.concatenate([ends, corners * blocked.cell]), nodes), blocked.origin)
    _refuse_large(len(lattice))
    quadrants = np.concatenate([np.zeros((2, 2), dtype=np.int64), quadrants])
    visible = _visible_on_grid(lattice, slopes, quadrants, cells, scale, corner_cutting == "closed")
    return _moved(_shortest_in_graph(np.concatenate([ends, corners * blocked.cell]), visible), blocked.origin)


def _grid_corners(cells: np.ndarray, closed: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners (n, 2) as x and y in cells, slopes (n,) and quadrants (n, 2) of the directions that a shortest path can take from them.

    A slope of +1 stands for directions with dx dy >= 0, -1 for dx dy <= 0. A quadrant holds the signs of dx and dy, or zeros for any.
    """
    around = occupied_around(cells)
    below_left, below_right, above_left, above_right = around
    single = around.sum(axis=0) == 1
    pair = around.sum(axis=0) == 2
    # Around a single occupied cell a path turns from one of the two quadrants beside it to the other; at a contact it stays in free ones.
    rising = (single & (below_right | above_left)) | (pair & below_right & above_left)
    falling = (single & (below_left | above_right)) | (pair & below_left & above_right)
    row, column = np.nonzero(rising | falling)
    corners = np.column_stack([column, row])
    slopes = np.where(rising[row, column], 1, -1)
    quadrants = np.zeros_like(corners)
    if closed:
        contact = pair[row, column]
        twice = np.repeat(np.arange(len(corners)), np.where(contact, 2, 1))
        corners, slopes, contact = corners[twice], slopes[twice], contact[twice]
        first = np.concatenate([[True], twice[1:] != twice[:-1]])[: len(twice)]
        side = np.where(first, 1, -1)
        quadrants = np.where(contact[:, None], np.column_stack([side, side * slopes]), 0)
    return corners, slopes, quadrants


def _lattice(points: np.ndarray, finest: int) -> int:
    """The least number of lattice points a cell that makes all coordinates whole; `finest` if that is not enough."""
    fractions = [Fraction(value).limit_denominator(finest) for value in points.ravel().tolist()]
    scale = math.lcm(*(fraction.denominator for fraction in fractions))
    exact = all(abs(value - fraction) <= _SAME_FRACTION for value, fraction in zip(points.ravel(), fractions))
    return scale if exact and scale <= finest else finest


@njit(cache=True)
def _visible_on_grid(
    nodes: np.ndarray, slopes: np.ndarray, quadrants: np.ndarray, cells: np.ndarray, scale: int, closed: bool
) -> np.ndarray:
    """Which pairs i < j of nodes can follow each other on a shortest path: bool (n, n).

    nodes: (n, 2) whole numbers, `scale` a cell. cells: occupied cells with a ring around them.
    """
    visible = np.zeros((len(nodes), len(nodes)), dtype=np.bool_)
    for i in range(len(nodes)):
        for j in range(i + 1, len(nodes)):
            dx = nodes[j, 0] - nodes[i, 0]
            dy = nodes[j, 1] - nodes[i, 1]
            if slopes[i] * dx * dy < 0 or slopes[j] * dx * dy < 0:
                continue
            if not (_in_quadrant(dx, dy, quadrants[i]) and _in_quadrant(-dx, -dy, quadrants[j])):
                continue
            if dx == 0 and dy == 0:
                # The two nodes of a closed contact lie in one place and do not see each other.
                visible[i, j] = quadrants[i, 0] == 0 or quadrants[j, 0] == 0
            else:
                visible[i, j] = _sees(nodes[i], nodes[j], cells, scale, closed)
    return visible


@njit(cache=True)
def _sees(one: np.ndarray, other: np.ndarray, cells: np.ndarray, scale: int, closed: bool) -> bool:
    """Whether the segment between two different points of the lattice is free."""
    dx, dy = other[0] - one[0], other[1] - one[1]
    if dx == 0:
        return _sees_along_column(one[0], min(one[1], other[1]), abs(dy), cells, scale, closed)
    if dy == 0:
        return _sees_along_column(one[1], min(one[0], other[0]), abs(dx), cells.T, scale, closed)
    return _sees_across(one[0], one[1], dx, dy, cells, scale, closed)


def _least_over_cells(problem: Problem) -> float:
    """Length in cells of the shortest way over the centres of free cells, start and target joined to those of their own cells: no shortest
    path is longer. Infinite without one, for then there is no path at all; but not if start or target lies on an occupied cell's side.
    """
    grid = problem.workspace
    start, target = (grid.cell_of(*end) for end in (problem.start, problem.target))
    if grid.occupied[start] or grid.occupied[target]:
        return np.finfo(float).max
    ends = sum(
        math.dist(end, grid.centre(row * grid.occupied.shape[1] + column)) for end, (row, column) in zip(problem[2:], (start, target))
    )
    return lattice_path(grid.occupied, start, target, math.sqrt(2), "free").length + ends / grid.cell


@njit(cache=True)
def _search_grid(points, lattice, slopes, cells, scale, most):
    """The nodes of a shortest path from node 0 to node 1 by the algorithm A*, none without a path; pairs are tested when they matter.

    points: (n, 2) in cells, lattice: (n, 2) the same in whole numbers. most: in cells, a length that the path does not exceed.
    """
    ahead = np.hypot(points[:, 0] - points[1, 0], points[:, 1] - points[1, 1])
    length = np.full(len(points), np.inf)
    before = np.full(len(points), -1)
    left = np.flatnonzero(np.hypot(points[:, 0] - points[0, 0], points[:, 1] - points[0, 1]) + ahead <= most * (1 + 1e-9))
    length[0] = 0.0
    while len(left) > 0:
        best = 0
        for k in range(len(left)):
            if length[left[k]] + ahead[left[k]] < length[left[best]] + ahead[left[best]]:
                best = k
        i = left[best]
        if i == 1 or length[i] == np.inf:
            break
        left[best] = left[-1]
        left = left[:-1]
        for j in left:
            dx, dy = lattice[j, 0] - lattice[i, 0], lattice[j, 1] - lattice[i, 1]
            if slopes[i] * dx * dy < 0 or slopes[j] * dx * dy < 0:
                continue
            so_far = length[i] + math.sqrt((points[j, 0] - points[i, 0]) ** 2 + (points[j, 1] - points[i, 1]) ** 2)
            if so_far >= length[j] or so_far + ahead[j] > most * (1 + 1e-9):
                continue
            if (dx == 0 and dy == 0) or _sees(lattice[i], lattice[j], cells, scale, False):
                length[j] = so_far
                before[j] = i
    return _way_back(before, length[1])


@njit(cache=True)
def _way_back(before, length):
    """The nodes from node 0 to node 1, by the node before each; none if the length is infinite."""
    nodes = [1]
    while before[nodes[-1]] >= 0:
        nodes.append(before[nodes[-1]])
    return np.array(nodes[::-1]) if length < np.inf else np.empty(0, dtype=np.int64)


@njit(cache=True)
def _in_quadrant(dx: int, dy: int, quadrant: np.ndarray) -> bool:
    return dx * quadrant[0] >= 0 and dy * quadrant[1] >= 0


@njit(cache=True)
def _sees_along_column(x: int, low: int, length: int, cells: np.ndarray, scale: int, closed: bool) -> bool:
    """Whether a vertical segment is free. On a grid line it passes edges, blocked if both of their cells are occupied."""
    column = x // scale
    on_line = x % scale == 0
    for row in range(low // scale, (low + length - 1) // scale + 1):
        if cells[row + 1, column + 1] and (not on_line or cells[row + 1, column]):
            return False
        if closed and on_line and row * scale > low and _is_contact(cells, row, column):
            return False
    return True


@njit(cache=True)
def _is_contact(cells: np.ndarray, row: int, column: int) -> bool:
    """Whether two occupied cells meet only by a corner in a vertex, given by its grid lines."""
    below_left, below_right = cells[row, column], cells[row, column + 1]
    above_left, above_right = cells[row + 1, column], cells[row + 1, column + 1]
    return below_left == above_right and below_right == above_left and below_left != below_right


@njit(cache=True)
def _sees_across(x: int, y: int, dx: int, dy: int, cells: np.ndarray, scale: int, closed: bool) -> bool:
    """Whether a slanted segment is free: a walk over the cells that it enters.

    to_x and to_y are the distances from the segment's begin to the next vertical and horizontal grid line, along each axis.
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
        if order == 0 and closed and cells[row + 1, column + 1 + step_x] and cells[row + 1 + step_y, column + 1]:
            return False
        if order <= 0:
            column += step_x
            to_x += scale
        if order >= 0:
            row += step_y
            to_y += scale
    return False


# ---------------------------------------------------------------------------------------------------------------------
# Polygons: visibility between convex corners


def _shortest_among_polygons(problem: Problem, blocked: PolygonRegion) -> Bound:
    """The visibility graph of start, target, the convex corners of the blocked region, and the points at which its corners meet."""
    begin = blocked.edges[:, :2]
    corner = np.flatnonzero(blocked.convex)
    repeated, count = np.unique(begin, axis=0, return_counts=True)
    anywhere = np.concatenate([[problem.start, problem.target], repeated[count > 1]])
    nodes = np.concatenate([anywhere, blocked.edges[corner, 2:]])
    before = np.concatenate([anywhere, begin[corner]])
    after = np.concatenate([anywhere, blocked.edges[blocked.following[corner], 2:]])
    if len(nodes) > MOST_POLYGON_NODES:
        return _along(nodes, _search_polygons(nodes, before, after, blocked))
    return _shortest_in_graph(nodes, _visible_among_polygons(nodes, before, after, blocked))


@njit(cache=True)
def _visible_among_polygons(nodes: np.ndarray, before: np.ndarray, after: np.ndarray, region: PolygonRegion) -> np.ndarray:
    """Which pairs i < j of nodes can follow each other on a shortest path: bool (n, n).

    before, after: (n, 2) the neighbours of a corner along the boundary; the node itself where a path may turn in any way.
    """
    visible = np.zeros((len(nodes), len(nodes)), dtype=np.bool_)
    segment = np.empty((1, 2, 2))
    for i in range(len(nodes)):
        for j in range(i + 1, len(nodes)):
            if not (_is_taut(nodes, i, j, before, after) and _is_taut(nodes, j, i, before, after)):
                continue
            for axis in range(2):
                segment[0, 0, axis] = nodes[i, axis]
                segment[0, 1, axis] = nodes[j, axis]
            visible[i, j] = not _crosses(nodes[i], nodes[j], region.edges) and first_collision(segment, region)[0] == math.inf
    return visible


@njit(cache=True)
def _search_polygons(nodes: np.ndarray, before: np.ndarray, after: np.ndarray, region: PolygonRegion) -> np.ndarray:
    """The nodes of a shortest path from node 0 to node 1 by the algorithm A*, none without a path; pairs are tested when they matter:
    a node's way to all others waits in a heap, and is tested when it is the most promising one.
    """
    came_by = np.full(len(nodes), -1)
    settled = np.zeros(len(nodes), dtype=np.bool_)
    ahead = np.hypot(nodes[:, 0] - nodes[1, 0], nodes[:, 1] - nodes[1, 1])
    segment = np.empty((1, 2, 2))
    heap = [(ahead[0], 0.0, -1, 0)]
    while len(heap) > 0:
        _, length, tail, i = heapq.heappop(heap)
        if settled[i]:
            continue
        if tail >= 0:
            for axis in range(2):
                segment[0, 0, axis] = nodes[tail, axis]
                segment[0, 1, axis] = nodes[i, axis]
            if _crosses(nodes[tail], nodes[i], region.edges) or first_collision(segment, region)[0] < math.inf:
                continue
        settled[i] = True
        came_by[i] = tail
        if i == 1:
            return _way_back(came_by, length)
        for j in range(len(nodes)):
            if settled[j] or not (_is_taut(nodes, i, j, before, after) and _is_taut(nodes, j, i, before, after)):
                continue
            so_far = length + math.hypot(nodes[j, 0] - nodes[i, 0], nodes[j, 1] - nodes[i, 1])
            heapq.heappush(heap, (so_far + ahead[j], so_far, i, j))
    return np.empty(0, dtype=np.int64)


@njit(cache=True)
def _offset(a: np.ndarray, b: np.ndarray, point: np.ndarray) -> float:
    """Distance of a point from the line through a and b, positive on its left; 0 if a and b are one point."""
    length = math.hypot(b[0] - a[0], b[1] - a[1])
    if length == 0.0:
        return 0.0
    return ((b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])) / length


@njit(cache=True)
def _apart(first: float, second: float) -> bool:
    """Whether two offsets from a line lie strictly on its two sides."""
    return min(first, second) < -TOLERANCE and max(first, second) > TOLERANCE


@njit(cache=True)
def _is_taut(nodes: np.ndarray, i: int, j: int, before: np.ndarray, after: np.ndarray) -> bool:
    """Whether a shortest path can turn at corner i on its way to or from j: the corner lies on one side of the line."""
    return not _apart(_offset(nodes[i], nodes[j], before[i]), _offset(nodes[i], nodes[j], after[i]))


@njit(cache=True)
def _crosses(a: np.ndarray, b: np.ndarray, edges: np.ndarray) -> bool:
    """Whether a segment and an edge lie strictly across each other. What only touches edges is left to the certified check."""
    for e in range(len(edges)):
        c, d = edges[e, :2], edges[e, 2:]
        if _apart(_offset(a, b, c), _offset(a, b, d)) and _apart(_offset(c, d, a), _offset(c, d, b)):
            return True
    return False


# ---------------------------------------------------------------------------------------------------------------------
# Circles: the tangent graph


class _Tangents(NamedTuple):
    """Nodes of a tangent graph and the straight pairs between them that are not yet tested.

    points: positions (x, y). circles: the circle that a node lies on, -1 for start and target. angles: its angle there. pairs: two nodes.
    """

    points: list[tuple[float, float]]
    circles: list[int]
    angles: list[float]
    pairs: list[tuple[int, int]]

    def add(self, centre: np.ndarray, radius: float, circle: int, angle: float) -> int:
        """Add a node on a circle and return its number."""
        self.points.append((centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)))
        self.circles.append(circle)
        self.angles.append(angle % math.tau)
        return len(self.points) - 1


def _shortest_around_circles(problem: Problem, blocked: CircleRegion) -> Bound:
    """The tangent graph: start, target, and the ends of all common tangents, joined by tangents and by the arcs between them."""
    from scipy.sparse import coo_array

    centres, radii = _outer_circles(blocked)
    tangents = _tangents(problem, centres, radii)
    points, on_circle = np.array(tangents.points), np.array(tangents.circles)
    pairs = np.array(tangents.pairs)
    pairs = pairs[_straight_is_free(points[pairs[:, 0]], points[pairs[:, 1]], centres, radii, blocked.bounds)]
    arcs, angles = _free_arcs(tangents, centres, radii, blocked.bounds)

    tail, head = np.concatenate([pairs, arcs]).T
    sweep = np.concatenate([np.zeros(len(pairs)), angles])
    straight = np.hypot(*(points[pairs[:, 1]] - points[pairs[:, 0]]).T)
    length = np.concatenate([straight, radii[on_circle[arcs[:, 0]]] * angles])
    kept = _shortest_between(tail, head, length)
    tail, head, sweep, length = tail[kept], head[kept], sweep[kept], length[kept]
    graph = coo_array((np.maximum(length, _NO_LENGTH), (tail, head)), shape=(len(points), len(points))).tocsr()
    _, nodes = _dijkstra(graph, 0, 1)
    if not len(nodes):
        return _no_path()

    edge_of = {pair: edge for edge, pair in enumerate(zip(tail.tolist(), head.tolist()))}
    steps = list(zip(nodes[:-1].tolist(), nodes[1:].tolist()))
    used = [edge_of.get((a, b), edge_of.get((b, a))) for a, b in steps]
    # An arc is stored counterclockwise.
    sweeps = [sweep[edge] if tail[edge] == a else -sweep[edge] for edge, (a, _) in zip(used, steps)]
    return Bound(math.fsum(length[used]), _circumscribed(points[nodes], on_circle[nodes], sweeps, centres, radii, blocked))


def _shortest_between(tail: np.ndarray, head: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Numbers of the edges that are the shortest between their two nodes. Of the others sparse matrices would make sums."""
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    order = np.lexsort([length, high, low])
    first = (np.diff(low[order], prepend=-1) != 0) | (np.diff(high[order], prepend=-1) != 0)
    return order[first]


def _outer_circles(blocked: CircleRegion) -> tuple[np.ndarray, np.ndarray]:
    """Centres and radii of the circles that lie inside no other one; of equal circles the first."""
    centres, radii = blocked.centres, blocked.radii
    distance = np.hypot(*(centres[:, None] - centres[None]).transpose(2, 0, 1))
    inside = distance + radii[:, None] <= radii[None]
    number = np.arange(len(radii))
    dropped = (inside & (~inside.T | (number[:, None] > number[None]))).any(axis=1)
    return centres[~dropped], radii[~dropped]


def _tangents(problem: Problem, centres: np.ndarray, radii: np.ndarray) -> _Tangents:
    """Nodes 0 and 1 are start and target. Where one of them lies on a circle, a node of the circle lies in the same place."""
    graph = _Tangents([problem.start, problem.target], [-1, -1], [math.nan, math.nan], [(0, 1)])
    for end, (x, y) in enumerate((problem.start, problem.target)):
        for k, (centre, radius) in enumerate(zip(centres, radii)):
            distance = math.hypot(x - centre[0], y - centre[1])
            towards = math.atan2(y - centre[1], x - centre[0])
            half = 0.0 if distance <= radius + TOLERANCE else math.acos(radius / distance)
            for side in (-1, 1) if half else (1,):
                graph.pairs.append((end, graph.add(centre, radius, k, towards + side * half)))
    for i in range(len(radii)):
        for j in range(i + 1, len(radii)):
            dx, dy = centres[j] - centres[i]
            distance = math.hypot(dx, dy)
            towards = math.atan2(dy, dx)
            tangents = []
            if distance > abs(radii[i] - radii[j]):
                tangents.append((math.acos((radii[i] - radii[j]) / distance), 0.0))
            if distance >= radii[i] + radii[j] - TOLERANCE:
                tangents.append((math.acos(min(1.0, (radii[i] + radii[j]) / distance)), math.pi))
            for half, opposite in tangents:
                for side in (-1, 1):
                    a = graph.add(centres[i], radii[i], i, towards + side * half)
                    b = graph.add(centres[j], radii[j], j, towards + side * half + opposite)
                    graph.pairs.append((a, b))
    return graph


def _straight_is_free(a: np.ndarray, b: np.ndarray, centres: np.ndarray, radii: np.ndarray, bounds: np.ndarray) -> np.ndarray:
    """Which segments from a to b, both (n, 2), are free: bool (n,)."""
    step = b - a
    square = np.maximum((step**2).sum(axis=1), _NO_LENGTH)[:, None]
    share = np.clip(((centres[None] - a[:, None]) * step[:, None]).sum(axis=2) / square, 0, 1)
    nearest = a[:, None] + share[:, :, None] * step[:, None] - centres[None]
    clear = (np.hypot(nearest[:, :, 0], nearest[:, :, 1]) >= radii - TOLERANCE).all(axis=1)
    left, right, bottom, top = bounds
    low, high = np.minimum(a, b), np.maximum(a, b)
    inside = (low >= np.array([left, bottom]) - TOLERANCE).all(axis=1) & (high <= np.array([right, top]) + TOLERANCE).all(axis=1)
    return clear & inside


def _free_arcs(tangents: _Tangents, centres: np.ndarray, radii: np.ndarray, bounds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Arcs between neighbouring nodes of a circle, counterclockwise: node pairs (n, 2) and angles (n,)."""
    circles, angles = np.array(tangents.circles), np.array(tangents.angles)
    pairs, sweeps = [np.empty((0, 2), dtype=np.int64)], [np.empty(0)]
    for k in range(len(radii)):
        nodes = np.flatnonzero(circles == k)
        nodes = nodes[np.argsort(angles[nodes])]
        if len(nodes) < 2:
            continue
        begin = angles[nodes]
        sweep = np.diff(begin, append=begin[0] + math.tau)
        middle, half = _covered_angles(k, centres, radii, bounds)
        after = (middle[None] - begin[:, None]) % math.tau
        overlap = np.full(after.shape, -math.inf)
        for turn in (-math.tau, 0.0, math.tau):
            shared = np.minimum(sweep[:, None], after + turn + half) - np.maximum(0, after + turn - half)
            overlap = np.maximum(overlap, shared)
        free = (overlap <= _SAME_ANGLE).all(axis=1)
        pairs.append(np.column_stack([nodes, np.roll(nodes, -1)])[free])
        sweeps.append(sweep[free])
    return np.concatenate(pairs), np.concatenate(sweeps)


def _covered_angles(k: int, centres: np.ndarray, radii: np.ndarray, bounds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parts of a circle that lie in other circles or outside of the border: middle and half of each angle."""
    radius = radii[k]
    step = np.delete(centres - centres[k], k, axis=0)
    other = np.delete(radii, k)
    distance = np.hypot(step[:, 0], step[:, 1])
    meets = distance < radius + other - TOLERANCE
    step, other, distance = step[meets], other[meets], distance[meets]
    cosine = (distance**2 + radius**2 - other**2) / (2 * distance * radius)
    left, right, bottom, top = bounds
    margin = np.array([right - centres[k, 0], top - centres[k, 1], centres[k, 0] - left, centres[k, 1] - bottom]) / radius
    outward = np.array([0.0, 0.5, 1.0, 1.5]) * math.pi
    middle = np.concatenate([np.arctan2(step[:, 1], step[:, 0]), outward[margin < 1]])
    return middle, np.arccos(np.clip(np.concatenate([cosine, margin[margin < 1]]), -1, 1))


def _circumscribed(
    points: np.ndarray, circles: np.ndarray, sweeps: list[float], centres: np.ndarray, radii: np.ndarray, blocked: CircleRegion
) -> np.ndarray:
    """The polyline (n, 2) along a path of straight pieces (sweep 0) and arcs: around the arcs, fine enough to be free."""
    runs = []
    for node, sweep in enumerate(sweeps):
        if runs and sweep * runs[-1][1] > 0:
            runs[-1] = (runs[-1][0], runs[-1][1] + sweep, node + 1)
        else:
            runs.append((node, sweep, node + 1))
    arc_length = sum(abs(sweep) * radii[circles[node]] for node, sweep, _ in runs if sweep)
    step = math.sqrt(12 * POLYLINE_EXCESS / arc_length) if arc_length else math.inf
    for _ in range(_REFINEMENTS):
        polyline = [points[:1]]
        for node, sweep, end in runs:
            if sweep:
                circle = circles[node]
                parts = math.ceil(abs(sweep) / step)
                from_centre = points[node] - centres[circle]
                middles = math.atan2(from_centre[1], from_centre[0]) + sweep / parts * (np.arange(parts) + 0.5)
                reach = radii[circle] / math.cos(0.5 * sweep / parts)
                polyline.append(centres[circle] + reach * np.column_stack([np.cos(middles), np.sin(middles)]))
            polyline.append(points[end : end + 1])
        line = np.concatenate(polyline)
        if check(np.stack([line[:-1], line[1:]], axis=1), blocked).feasible:
            break
        step *= 0.5
    return line
