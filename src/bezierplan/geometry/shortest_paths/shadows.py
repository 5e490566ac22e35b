"""Shortest paths on grids: the corners that a node sees are found by casting shadows, and only when
a search reaches the node.

A graph of all pairs would need memory for each of them. Here a node looks up and down, row of cells
by row of cells. It keeps the intervals of directions in which nothing has been in the way yet; each
block of occupied cells in a row takes an open interval out of them, so the remaining intervals are
closed, down to single rays that touch corners on both sides. A direction is its slope, steps in x
for each step in y: a fraction of two whole numbers, so all comparisons are exact.
"""

import heapq
import math
from typing import NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.workspaces.grid import find_occupied_around, find_runs
from bezierplan.workspaces.trace import trace_back


class Scene(NamedTuple):
    """The cells and corners that can be seen, in whole numbers: `scale` stands for one cell.

    cells: bool (rows + 2, columns + 2), occupied cells with a ring around them.
    first_run: (rows + 3,) where the runs of occupied cells of each row of `cells` begin in `runs`.
    runs: (r, 2) grid lines at which a run begins and ends, in cells.
    corners: (n, 2) x and y in cells, row by row, each from left to right.
    first_corner: (rows + 2,) where the corners of each horizontal grid line begin.
    slopes: (n,) signs of dx dy of the directions that a shortest path can take from a corner.
    sides: (n,) whether the occupied cell beside a corner lies above it (1) or below it (-1); 0 at a
        contact, which has both.
    """

    cells: np.ndarray
    first_run: np.ndarray
    runs: np.ndarray
    corners: np.ndarray
    first_corner: np.ndarray
    slopes: np.ndarray
    sides: np.ndarray
    scale: int


def build_scene(cells: np.ndarray, corners: np.ndarray, slopes: np.ndarray, scale: int) -> Scene:
    """Build the scene of occupied cells with a ring around them and corners found by `grid`."""
    row, begin, end = find_runs(cells).astype(np.int64).T
    runs = np.column_stack([begin, end]) - 1
    first_run = np.searchsorted(row, np.arange(len(cells) + 1))
    first_corner = np.searchsorted(corners[:, 1], np.arange(len(cells)))
    column, row = corners.T
    around = find_occupied_around(cells)[:, row, column].astype(np.int64)
    below_left, below_right, above_left, above_right = around
    sides = above_left + above_right - below_left - below_right
    return Scene(cells, first_run, runs, corners, first_corner, slopes, sides, scale)


@compile_kernel
def search(scene: Scene, ends: np.ndarray, points: np.ndarray, direct: bool) -> np.ndarray:
    """Find a shortest path from start to target by A*; return its nodes, none if there is no path.

    Node 0 is the start, node 1 the target, then come the corners.

    ends: (2, 2) start and target in whole numbers.
    points: (n + 2, 2) all nodes in cells.
    direct: true if start and target see each other.
    """
    ahead = np.hypot(points[:, 0] - points[1, 0], points[:, 1] - points[1, 1])
    at = np.concatenate((ends, scene.corners * scene.scale))
    length = np.full(len(points), np.inf)
    came_by = np.full(len(points), -1)
    settled = np.zeros(len(points), np.bool_)
    view = np.empty(len(scene.corners), np.int64)
    fans = np.empty((2, scene.cells.shape[1] + 1, 4), np.int64)
    sees_target = np.zeros(len(points), np.bool_)
    sees_target[0] = direct
    # Sight is mutual: one look around from the target tells which nodes see it.
    for k in range(_look_around(at[1], scene, fans, view)):
        sees_target[view[k] + 2] = True

    length[0] = 0.0
    heap = [(ahead[0], 0)]
    while len(heap) > 0:
        _, i = heapq.heappop(heap)
        if settled[i]:
            continue
        settled[i] = True
        if i == 1:
            return trace_back(came_by, 1, length[1])
        count = (
            _look(at[i], at[i] - at[came_by[i]], i - 2, scene, fans, view)
            if i
            else _look_around(at[0], scene, fans, view)
        )
        # The target comes first, if it is seen.
        for k in range(-1 if sees_target[i] else 0, count):
            j = 1 if k < 0 else view[k] + 2
            so_far = length[i] + math.sqrt(
                (points[j, 0] - points[i, 0]) ** 2 + (points[j, 1] - points[i, 1]) ** 2
            )
            if so_far < length[j]:
                length[j] = so_far
                came_by[j] = i
                heapq.heappush(heap, (so_far + ahead[j], j))
    return np.empty(0, np.int64)


@allocation_free
def _look_around(point: np.ndarray, scene: Scene, fans: np.ndarray, view: np.ndarray) -> int:
    """Find the corners that a point sees and a shortest path can pass in that direction.

    Returns their number, and writes them to `view`.

    fans: (2, columns + 3, 4) room for intervals.
    """
    x, y = point
    count = _look_along(x, y, 0, scene, view)
    for side in (-1, 1):
        count = _look_across(x, y, side, (-1, 0, 1, 0), scene, fans, view, count)
    return count


@allocation_free
def _look(
    point: np.ndarray,
    came: np.ndarray,
    corner: int,
    scene: Scene,
    fans: np.ndarray,
    view: np.ndarray,
) -> int:
    """Look around (`_look_around`) from a corner that a path has come to along a vector.

    It goes on in the same quadrant, or it would have been shorter past the corner; and it turns
    towards the occupied cell beside the corner or not at all. At a contact it can turn both ways.
    """
    x, y = point
    right, up = abs(came[0]), abs(came[1])
    if right == 0 and up == 0:
        return _look_around(point, scene, fans, view)
    slope, cell = scene.slopes[corner], scene.sides[corner]
    to_right = came[0] + slope * came[1] > 0
    side = slope if to_right else -slope
    # The steepest direction and the flattest one, as slopes from the vertical.
    low, low_y = (0, 1) if cell in (0, side) else (right, up)
    high, high_y = (right, up) if cell == side else (1, 0)
    count = 0
    if high_y == 0:
        count = _look_along(x, y, 1 if to_right else -1, scene, view)
    cone = (low, low_y, high, high_y) if to_right else (-high, high_y, -low, low_y)
    return _look_across(x, y, side, cone, scene, fans, view, count)


@allocation_free
def _look_along(x: int, y: int, to: int, scene: Scene, view: np.ndarray) -> int:
    """Find the corners that a point sees along its horizontal grid line, if it lies on one.

    to: to the right (1), to the left (-1), or both (0). An edge ends the view if both of its cells
        are occupied.
    """
    if y % scene.scale:
        return 0
    below, above = scene.cells[y // scene.scale], scene.cells[y // scene.scale + 1]
    left, right = -(-x // scene.scale), x // scene.scale
    while to <= 0 and not (below[left] and above[left]):
        left -= 1
    while to >= 0 and not (below[right + 1] and above[right + 1]):
        right += 1
    return _gather(left, right, y // scene.scale, x, 0, scene, view, 0)


@allocation_free
def _look_across(x, y, side, cone, scene, fans, view, count):
    """Add to `view` the corners within a cone above a point (side 1) or below it (-1), and return
    how many there are now.

    cone: its lowest and its highest slope, each by numerator and denominator, which may be 0; so
        are the intervals.
    """
    band = y // scene.scale if side > 0 else -(-y // scene.scale) - 1
    far = (band + 1) * scene.scale - y if side > 0 else y - band * scene.scale
    # In the first row the nearest block on each side hides all others.
    run = _find_first_run_beyond(x // scene.scale, band, scene)
    if scene.runs[run, 0] * scene.scale < x:
        return count
    fan, following = fans[0], fans[1]
    low, low_y, high, high_y = cone
    begin, end = scene.runs[run - 1, 1] * scene.scale - x, scene.runs[run, 0] * scene.scale - x
    if begin * low_y >= low * far:
        low, low_y = begin, far
    if end * high_y <= high * far:
        high, high_y = end, far
    fan[0] = low, low_y, high, high_y
    intervals = 1 if low * high_y <= high * low_y else 0
    while intervals > 0:
        line = band + 1 if side > 0 else band
        for k in range(intervals):
            left = -((-fan[k, 0] * far // fan[k, 1] - x) // scene.scale)
            right = (fan[k, 2] * far // fan[k, 3] + x) // scene.scale
            count = _gather(left, right, line, x, side, scene, view, count)
        band += side
        intervals = _cast_shadows(x, band, far, fan, intervals, scene, following)
        fan, following = following, fan
        far += scene.scale
    return count


@allocation_free
def _cast_shadows(x, band, near, fan, intervals, scene, following):
    """Take out of the intervals all that a row of cells hides, and write the rest; return how many
    intervals there are.

    near: distance of the line before the row, in y, above 0.
    """
    far = near + scene.scale
    count = 0
    for k in range(intervals):
        low, low_y, high, high_y = fan[k]
        nearest = low * (near if low > 0 else far) // low_y + x
        run = _find_first_run_beyond(nearest // scene.scale, band, scene)
        while True:
            begin, end = scene.runs[run, 0] * scene.scale - x, scene.runs[run, 1] * scene.scale - x
            # A block hides the open interval between the slopes to two of its corners.
            begin_y = far if begin > 0 else near
            end_y = near if end > 0 else far
            if begin * high_y >= high * begin_y:
                break
            if begin * low_y >= low * begin_y:
                following[count] = low, low_y, begin, begin_y
                count += 1
            if end * low_y > low * end_y:
                low, low_y = end, end_y
            if low * high_y > high * low_y:
                break
            run += 1
        if low * high_y <= high * low_y:
            following[count] = low, low_y, high, high_y
            count += 1
    return count


@allocation_free
def _find_first_run_beyond(column: int, band: int, scene: Scene) -> int:
    """Return the number of the first run of a row that ends right of a grid line; there is one,
    because the ring ends each row.
    """
    low, high = scene.first_run[band + 1], scene.first_run[band + 2] - 1
    while low < high:
        middle = (low + high) // 2
        if scene.runs[middle, 1] > column:
            high = middle
        else:
            low = middle + 1
    return low


@allocation_free
def _gather(left, right, line, x, side, scene, view, count):
    """Add to `view` the corners on a horizontal grid line between two vertical ones that a shortest
    path from x can pass, and return how many there are now.
    """
    corner, end = scene.first_corner[line], scene.first_corner[line + 1]
    high = end
    while corner < high:
        middle = (corner + high) // 2
        if scene.corners[middle, 0] >= left:
            high = middle
        else:
            corner = middle + 1
    while corner < end and scene.corners[corner, 0] <= right:
        if scene.slopes[corner] * side * (scene.corners[corner, 0] * scene.scale - x) >= 0:
            view[count] = corner
            count += 1
        corner += 1
    return count
