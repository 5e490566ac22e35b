"""The certified collision check: whether a path of Bezier pieces enters the blocked region, where first, how deep, and how near it comes.

The curve of a piece lies in the hull of its control points. A piece is halved until every part is either certified free, because its hull
is, or begins with a point that is certainly blocked. There are two thresholds, so that this always ends: a collision is certified by a
point deeper than `TOLERANCE`, freedom by a depth of at most twice that. (In a corner between two walls it is twice that from each wall.)

The search is written once. What it asks of a kind of region (`_is_blocked`, `_is_free`, `_depth`, `_depth_bound`) is chosen by the type of
the region when the kernel is compiled.
"""

import math
from typing import Literal, NamedTuple

import numpy as np
from numba import njit
from numba.extending import overload

from bezierplan.geometry.region import CircleRegion, GridRegion, PolygonRegion, Region, from_origin

# Depth in units above which a point is certainly blocked.
TOLERANCE = 1e-9

# Proven error of the clearance in units, and of the depth relative to it.
CLEARANCE_TOLERANCE = 1e-9
DEPTH_TOLERANCE = 1e-6

# Smaller than this, differences of coordinates are rounding.
_ROUNDING = 1e-12

# Coordinates beyond this would bring the rounding of halved control points near the tolerance.
LARGEST_COORDINATE = 1e5

# How far the cells around a grid reach, which stand for its outside: beyond every coordinate.
_FAR = 4 * LARGEST_COORDINATE

# Halving reaches the tolerance from the largest coordinate in some fifty levels; a level needs one place on the stack.
_STACK = 64

# A parameter interval this short that ends in a blocked point is reported as the collision.
_SHORTEST_INTERVAL = 1e-11

# A chord this much shorter than its hull does not show the hull's direction.
_SHORT_CHORD = 1e-3

# Hulls that span more doubled-grid elements than this are halved rather than tested against each blocked element.
_WIDEST_RANGE = 12

# An edge that keeps this distance from a hull cannot be passed within the tolerance of its ends, so it cannot matter to the hull.
_APART = 4 * TOLERANCE

# Radius of the disc around a contact in which the rule `closed` looks where a path comes from and goes to, in cells.
_CONTACT_RADIUS = 1e-6

_LARGEST_DEGREE = 60
# Halving adds up as many roundings as the degree. Above this degree coordinates have to be smaller, so that their sum grows no further.
_FULL_RANGE_DEGREE = 32
_BINOMIAL = np.array([[math.comb(n, k) for k in range(2 * _LARGEST_DEGREE + 1)] for n in range(2 * _LARGEST_DEGREE + 1)], dtype=float)


class Check(NamedTuple):
    """The verdict on a path.

    feasible: it does not enter the blocked region. collision_at: number of the piece plus parameter in it of the first collision; nan when
    free. depth: largest depth in the blocked region, in units; 0 when free, and where a path cuts a closed corner. Depth is the distance
    to free space; where discs overlap or reach over the border it is the largest of their depths, a lower bound. clearance: least distance
    to the blocked region, in units; 0 when colliding. tolerance: proven error, in units, of `clearance` when free, of `depth` when
    colliding. intervals: how many parameter intervals the verdict needed.
    """

    feasible: bool
    collision_at: float
    depth: float
    clearance: float
    tolerance: float
    intervals: int


def check(pieces: np.ndarray, region: Region, corner_cutting: Literal["open", "closed"] = "open") -> Check:
    """Check a path of Bezier pieces (pieces, degree + 1, 2), in the region's unit, each beginning where the last one ends.

    corner_cutting: whether a path may pass between two occupied cells that meet only by a corner; touching the corner is always allowed. It
    matters on grids only.

    A path deeper than 4e-9 is never called free, one no deeper than 1e-9 never colliding; between them either answer may come. In the tip
    of a notch between polygons that is sharper than 60 degrees, 2e-9 over the sine of half its angle stands for 4e-9.

    Raises ValueError for coordinates that are not finite or beyond 1e5, or 1e5 x 32 / degree for a degree above 32; for a degree above 60;
    and for an unknown rule of corner cutting.
    """
    pieces = np.ascontiguousarray(pieces, dtype=float)
    if corner_cutting not in ("open", "closed"):
        raise ValueError(f"unknown rule of corner cutting {corner_cutting!r}; known: open, closed")
    refuse_unfit(pieces)
    pieces = from_origin(pieces, region)
    collision_at, intervals = first_collision(pieces, region)
    if corner_cutting == "closed" and isinstance(region, GridRegion):
        cut_at = _first_corner_cut(pieces, region.contacts, _CONTACT_RADIUS * region.cell)
        if cut_at < collision_at:
            return Check(False, cut_at, 0.0, 0.0, 0.0, intervals)
    if collision_at < math.inf:
        depth = _largest_depth(pieces, region, collision_at)
        return Check(False, collision_at, depth, 0.0, max(DEPTH_TOLERANCE * depth, _ROUNDING), intervals)
    if isinstance(region, CircleRegion):
        clearance = _least_clearance(pieces, region.edges, region.centres, region.radii)
    else:
        clearance = _least_clearance(pieces, region.edges, np.empty((0, 2)), np.empty(0))
    return Check(True, math.nan, 0.0, clearance, CLEARANCE_TOLERANCE, intervals)


def refuse_unfit(pieces: np.ndarray) -> None:
    """Raise ValueError for pieces that `check` cannot judge: of another shape, of too high a degree, too far out, or not finite."""
    if pieces.ndim != 3 or pieces.shape[2] != 2 or not 2 <= pieces.shape[1] <= _LARGEST_DEGREE + 1:
        raise ValueError(f"pieces have the shape {pieces.shape}; expected (pieces, degree + 1, 2) with a degree of 1 to {_LARGEST_DEGREE}")
    # Written so that a coordinate that is not a number fails as well.
    largest = LARGEST_COORDINATE * min(1.0, _FULL_RANGE_DEGREE / (pieces.shape[1] - 1))
    if not np.abs(pieces).max(initial=0.0) <= largest:
        raise ValueError(f"a path has a coordinate that is not finite or beyond {largest:g}")


# ---------------------------------------------------------------------------------------------------------------------
# Hulls


@njit(cache=True)
def _copy(points: np.ndarray, place: np.ndarray) -> None:
    """Copy control points one by one. Assigning whole arrays does the same, but takes seconds to compile."""
    for i in range(len(points)):
        place[i, 0] = points[i, 0]
        place[i, 1] = points[i, 1]


@njit(cache=True)
def _halve(points: np.ndarray, left: np.ndarray) -> None:
    """Replace a piece by its right half and write its left half (de Casteljau's construction)."""
    n = len(points) - 1
    for level in range(n + 1):
        left[level, 0] = points[0, 0]
        left[level, 1] = points[0, 1]
        for i in range(n - level):
            points[i, 0] = 0.5 * (points[i, 0] + points[i + 1, 0])
            points[i, 1] = 0.5 * (points[i, 1] + points[i + 1, 1])


@njit(cache=True)
def _size(points: np.ndarray) -> float:
    """Largest distance of a control point from the first one."""
    largest = 0.0
    for i in range(1, len(points)):
        largest = max(largest, math.hypot(points[i, 0] - points[0, 0], points[i, 1] - points[0, 1]))
    return largest


@njit(cache=True)
def _direction(points: np.ndarray) -> tuple[float, float]:
    """Unit vector along a hull: its chord's or, where the chord is short, that to the point farthest from the first one."""
    farthest = len(points) - 1
    longest = _size(points)
    if math.hypot(points[-1, 0] - points[0, 0], points[-1, 1] - points[0, 1]) < _SHORT_CHORD * longest:
        for i in range(1, len(points)):
            if math.hypot(points[i, 0] - points[0, 0], points[i, 1] - points[0, 1]) == longest:
                farthest = i
    x = points[farthest, 0] - points[0, 0]
    y = points[farthest, 1] - points[0, 1]
    length = math.hypot(x, y)
    if length == 0.0:
        return 1.0, 0.0
    return x / length, y / length


@njit(cache=True)
def _range(points: np.ndarray, x: float, y: float) -> tuple[float, float]:
    """Least and largest component of the control points in a direction, seen from the first one."""
    low = high = 0.0
    for i in range(1, len(points)):
        component = (points[i, 0] - points[0, 0]) * x + (points[i, 1] - points[0, 1]) * y
        low = min(low, component)
        high = max(high, component)
    return low, high


@njit(cache=True)
def _box(points: np.ndarray) -> tuple[float, float, float, float]:
    """Lowest and highest x, lowest and highest y of the control points."""
    left = right = points[0, 0]
    bottom = top = points[0, 1]
    for i in range(1, len(points)):
        left = min(left, points[i, 0])
        right = max(right, points[i, 0])
        bottom = min(bottom, points[i, 1])
        top = max(top, points[i, 1])
    return left, right, bottom, top


@njit(cache=True)
def _distance_to_segment(x: float, y: float, ax: float, ay: float, bx: float, by: float) -> float:
    dx = bx - ax
    dy = by - ay
    square = dx * dx + dy * dy
    share = 0.0
    if square > 0.0:
        share = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / square))
    dx = x - ax - share * dx
    dy = y - ay - share * dy
    return math.sqrt(dx * dx + dy * dy)


@njit(cache=True)
def _bulge(points: np.ndarray) -> float:
    """Largest distance of a control point from the chord."""
    largest = 0.0
    for i in range(1, len(points) - 1):
        distance = _distance_to_segment(points[i, 0], points[i, 1], points[0, 0], points[0, 1], points[-1, 0], points[-1, 1])
        largest = max(largest, distance)
    return largest


# ---------------------------------------------------------------------------------------------------------------------
# What the search asks of a region. The kinds of regions follow; which is meant is told by the type, in the overloads. The four functions
# here are only names for numba to attach those overloads to: compiled code never enters their bodies, and plain Python must not.


def _is_blocked(x, y, region):
    """Whether a point is certainly blocked: its depth is above the tolerance."""
    raise NotImplementedError


def _is_free(points, region):
    """Whether the curve of some control points is certified free. May be false for a free curve, but not for ever when it is halved."""
    raise NotImplementedError


def _depth(x, y, region):
    """Depth of a point in the blocked region, 0 outside."""
    raise NotImplementedError


def _depth_bound(points, region):
    """Upper bound of the depth of the curve of some control points."""
    raise NotImplementedError


# ---------------------------------------------------------------------------------------------------------------------
# Cells: elements of the doubled grid, and separating axes


@njit(cache=True)
def _element(x: float, cell: float, last: int) -> int:
    """Index in the doubled grid of a coordinate: odd on a grid line (within the tolerance), even in a cell; the outside is 0 and `last`."""
    line = round(x / cell)
    index = 2 * math.floor(x / cell) + 2
    if abs(x - line * cell) <= TOLERANCE:
        index = 2 * line + 1
    return min(max(index, 0), last)


@njit(cache=True)
def _sides(index: int, cell: float, last: int) -> tuple[float, float]:
    """Lowest and highest coordinate of the cells that touch an element: one cell for even indices, two for odd ones."""
    low = -_FAR if index <= 1 else (index // 2 - 1) * cell
    high = _FAR if index >= last - 1 else ((index + 1) // 2) * cell
    return low, high


@njit(cache=True)
def _blocked_elements(counts: np.ndarray, bottom: int, top: int, left: int, right: int) -> int:
    """Number of blocked elements in a range of the doubled grid, both ends included."""
    return counts[top + 1, right + 1] - counts[bottom, right + 1] - counts[top + 1, left] + counts[bottom, left]


def _is_blocked_in_grid(x, y, region):
    rows, columns = region.blocked.shape
    return region.blocked[_element(y, region.cell, rows - 1), _element(x, region.cell, columns - 1)]


def _is_free_in_grid(points, region):
    rows, columns = region.blocked.shape
    cell = region.cell
    x_low, x_high, y_low, y_high = _box(points)
    left, right = _element(x_low, cell, columns - 1), _element(x_high, cell, columns - 1)
    bottom, top = _element(y_low, cell, rows - 1), _element(y_high, cell, rows - 1)
    if _blocked_elements(region.counts, bottom, top, left, right) == 0:
        return True

    # The rectangle of an edge or vertex covers the cells on both sides of a seam. So that no seam is overlooked, the range reaches as far
    # beyond the hull as a hull may reach into a rectangle.
    reach = 2.0 * TOLERANCE
    left, right = _element(x_low - reach, cell, columns - 1), _element(x_high + reach, cell, columns - 1)
    bottom, top = _element(y_low - reach, cell, rows - 1), _element(y_high + reach, cell, rows - 1)
    if right - left >= _WIDEST_RANGE or top - bottom >= _WIDEST_RANGE:
        return False
    along_x, along_y = _direction(points)
    across_low, across_high = _range(points, -along_y, along_x)
    for row in range(bottom, top + 1):
        rectangle_bottom, rectangle_top = _sides(row, cell, rows - 1)
        if y_high <= rectangle_bottom + reach or y_low >= rectangle_top - reach:
            continue
        for column in range(left, right + 1):
            if not region.blocked[row, column]:
                continue
            rectangle_left, rectangle_right = _sides(column, cell, columns - 1)
            if x_high <= rectangle_left + reach or x_low >= rectangle_right - reach:
                continue
            x = 0.5 * (rectangle_left + rectangle_right) - points[0, 0]
            y = 0.5 * (rectangle_bottom + rectangle_top) - points[0, 1]
            middle = along_x * y - along_y * x
            half = 0.5 * (abs(along_y) * (rectangle_right - rectangle_left) + abs(along_x) * (rectangle_top - rectangle_bottom))
            if across_high > middle - half + reach and across_low < middle + half - reach:
                return False
    return True


def _depth_in_grid(x, y, region):
    return _distance_to_edges(x, y, region.edges) if _is_blocked(x, y, region) else 0.0


# ---------------------------------------------------------------------------------------------------------------------
# Distance to boundary edges, for cells and polygons


@njit(cache=True)
def _distance_to_edges(x: float, y: float, edges: np.ndarray) -> float:
    least = math.inf
    for ax, ay, bx, by in edges:
        least = min(least, _distance_to_segment(x, y, ax, ay, bx, by))
    return least


def _depth_bound_by_edges(points, region):
    """No blocked point is deeper than it is far from an edge, which on a chord is greatest at one of its ends."""
    least = math.inf
    for ax, ay, bx, by in region.edges:
        first = _distance_to_segment(points[0, 0], points[0, 1], ax, ay, bx, by)
        if first < least:
            least = min(least, max(first, _distance_to_segment(points[-1, 0], points[-1, 1], ax, ay, bx, by)))
    return least + _bulge(points)


# ---------------------------------------------------------------------------------------------------------------------
# Circles: the Bernstein form of the squared distance


@njit(cache=True)
def _least_distance_to_centre(points: np.ndarray, x: float, y: float) -> float:
    """Lower bound of the distance of a curve to a point: the root of the smallest Bernstein coefficient of the squared distance.

    The differences to the point are taken first, so that the error stays relative to the distance.
    """
    n = len(points) - 1
    least = math.inf
    for k in range(2 * n + 1):
        coefficient = 0.0
        for i in range(max(0, k - n), min(n, k) + 1):
            j = k - i
            product = (points[i, 0] - x) * (points[j, 0] - x) + (points[i, 1] - y) * (points[j, 1] - y)
            coefficient += _BINOMIAL[n, i] * _BINOMIAL[n, j] * product
        least = min(least, coefficient / _BINOMIAL[2 * n, k])
    return math.sqrt(max(0.0, least))


def _depth_in_circles(x, y, region):
    left, right, bottom, top = region.bounds
    depth = math.hypot(max(0.0, left - x, x - right), max(0.0, bottom - y, y - top))
    for k in range(len(region.radii)):
        depth = max(depth, region.radii[k] - math.hypot(x - region.centres[k, 0], y - region.centres[k, 1]))
    return depth


def _is_blocked_in_circles(x, y, region):
    return _depth(x, y, region) > TOLERANCE


def _is_free_in_circles(points, region):
    x_low, x_high, y_low, y_high = _box(points)
    left, right, bottom, top = region.bounds
    reach = 2.0 * TOLERANCE
    if x_low < left - reach or x_high > right + reach or y_low < bottom - reach or y_high > top + reach:
        return False
    along_x, along_y = _direction(points)
    along_low, along_high = _range(points, along_x, along_y)
    across_low, across_high = _range(points, -along_y, along_x)
    for k in range(len(region.radii)):
        radius = region.radii[k] - reach
        x = region.centres[k, 0] - points[0, 0]
        y = region.centres[k, 1] - points[0, 1]
        along = along_x * x + along_y * y
        across = along_x * y - along_y * x
        outside_along = max(0.0, along_low - along, along - along_high)
        outside_across = max(0.0, across_low - across, across - across_high)
        if math.hypot(outside_along, outside_across) >= radius:
            continue
        if _least_distance_to_centre(points, region.centres[k, 0], region.centres[k, 1]) < radius:
            return False
    return True


def _depth_bound_in_circles(points, region):
    bound = 0.0
    left, right, bottom, top = region.bounds
    for x, y in points:
        bound = max(bound, math.hypot(max(0.0, left - x, x - right), max(0.0, bottom - y, y - top)))
    for k in range(len(region.radii)):
        if region.radii[k] > bound:
            bound = max(bound, region.radii[k] - _least_distance_to_centre(points, region.centres[k, 0], region.centres[k, 1]))
    return bound


# ---------------------------------------------------------------------------------------------------------------------
# Polygons: chains of the boundary edges that a hull touches


def _depth_in_polygons(x, y, region):
    """Free space is where a ray crosses the boundary an odd number of times."""
    inside_free = False
    for ax, ay, bx, by in region.edges:
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            inside_free = not inside_free
    return 0.0 if inside_free else _distance_to_edges(x, y, region.edges)


def _is_blocked_in_polygons(x, y, region):
    return _depth(x, y, region) > TOLERANCE


@njit(cache=True)
def _sides_of_edge(points, edge, normal) -> tuple[float, float]:
    """Least and largest distance of control points from the line of an edge, positive on its free side."""
    low = math.inf
    high = -math.inf
    for x, y in points:
        distance = (x - edge[0]) * normal[0] + (y - edge[1]) * normal[1]
        low = min(low, distance)
        high = max(high, distance)
    return low, high


def _is_free_in_polygons(points, region):
    """A hull is free if it begins in free space and crosses none of the boundary.

    Edges that keep apart from the hull do not matter, on whichever side it lies. The others form chains of consecutive edges: see
    `_passes_chain`.
    """
    x_low, x_high, y_low, y_high = _box(points)
    along_x, along_y = _direction(points)
    across_low, across_high = _range(points, -along_y, along_x)
    touched = np.zeros(len(region.edges), dtype=np.bool_)
    remaining = 0
    for e in range(len(region.edges)):
        ax, ay, bx, by = region.edges[e]
        if max(ax, bx) < x_low - _APART or min(ax, bx) > x_high + _APART or max(ay, by) < y_low - _APART or min(ay, by) > y_high + _APART:
            continue
        across_a = along_x * (ay - points[0, 1]) - along_y * (ax - points[0, 0])
        across_b = along_x * (by - points[0, 1]) - along_y * (bx - points[0, 0])
        if max(across_a, across_b) < across_low - _APART or min(across_a, across_b) > across_high + _APART:
            continue
        low, high = _sides_of_edge(points, region.edges[e], region.normals[e])
        if low > _APART or high < -_APART:
            continue
        touched[e] = True
        remaining += 1

    for e in range(len(region.edges)):
        if touched[e] and not touched[region.preceding[e]]:
            length = _passes_chain(points, region, touched, e, along_x, along_y, across_low, across_high)
            if length == 0:
                return False
            remaining -= length
    # What remains are rings that the hull touches all around: not decided.
    return remaining == 0 and not _is_blocked(points[0, 0], points[0, 1], region)


@njit(cache=True)
def _passes_chain(points, region, touched, first, along_x, along_y, across_low, across_high) -> int:
    """Number of edges of a chain of touched edges if a hull passes it on the free side, else 0.

    It does if it lies on the free side of all lines of the chain. Where the blocked region is convex at the chain's corners, one of them is
    enough, or any line between hull and chain, with free space on the hull's side; the one along the hull is tried.
    """
    reach = 2.0 * TOLERANCE
    length = 0
    beside_all = True
    beside_one = False
    only_convex = True
    chain_low = facing_low = math.inf
    chain_high = facing_high = -math.inf
    e = first
    while touched[e]:
        if length > 0:
            only_convex &= region.convex[region.preceding[e]]
        length += 1
        low, _ = _sides_of_edge(points, region.edges[e], region.normals[e])
        beside_all &= low >= -reach
        beside_one |= low >= -reach
        facing = along_x * region.normals[e, 1] - along_y * region.normals[e, 0]
        facing_low = min(facing_low, facing)
        facing_high = max(facing_high, facing)
        for k in (0, 2):
            across = along_x * (region.edges[e, k + 1] - points[0, 1]) - along_y * (region.edges[e, k] - points[0, 0])
            chain_low = min(chain_low, across)
            chain_high = max(chain_high, across)
        e = region.following[e]
    above = across_low >= chain_high - reach and facing_high > 0.0
    below = across_high <= chain_low + reach and facing_low < 0.0
    return length if beside_all or (only_convex and (beside_one or above or below)) else 0


@overload(_is_blocked)
def _choose_is_blocked(x, y, region):
    return {GridRegion: _is_blocked_in_grid, CircleRegion: _is_blocked_in_circles, PolygonRegion: _is_blocked_in_polygons}[
        region.instance_class
    ]


@overload(_is_free)
def _choose_is_free(points, region):
    return {GridRegion: _is_free_in_grid, CircleRegion: _is_free_in_circles, PolygonRegion: _is_free_in_polygons}[region.instance_class]


@overload(_depth)
def _choose_depth(x, y, region):
    return {GridRegion: _depth_in_grid, CircleRegion: _depth_in_circles, PolygonRegion: _depth_in_polygons}[region.instance_class]


@overload(_depth_bound)
def _choose_depth_bound(points, region):
    return {GridRegion: _depth_bound_by_edges, CircleRegion: _depth_bound_in_circles, PolygonRegion: _depth_bound_by_edges}[
        region.instance_class
    ]


# ---------------------------------------------------------------------------------------------------------------------
# The searches


@njit(cache=True)
def first_collision(pieces: np.ndarray, region: Region) -> tuple[float, int]:
    """Piece number plus parameter of the first collision (infinite without one), and the number of intervals examined.

    Depth first, left half first: what lies before the interval in hand is certified free.
    """
    stack = np.empty((_STACK, pieces.shape[1], 2))
    begin = np.empty(_STACK)
    width = np.empty(_STACK)
    intervals = 0
    for piece in range(len(pieces)):
        _copy(pieces[piece], stack[0])
        begin[0] = 0.0
        width[0] = 1.0
        top = 0
        while top >= 0:
            points = stack[top]
            intervals += 1
            if _is_free(points, region):
                top -= 1
            elif _is_blocked(points[0, 0], points[0, 1], region):
                return piece + begin[top], intervals
            elif width[top] < _SHORTEST_INTERVAL and _is_blocked(points[-1, 0], points[-1, 1], region):
                return piece + begin[top] + width[top], intervals
            elif _size(points) <= TOLERANCE:
                top -= 1
            else:
                _halve(points, stack[top + 1])
                width[top] *= 0.5
                width[top + 1] = width[top]
                begin[top + 1] = begin[top]
                begin[top] += width[top]
                top += 1
    return math.inf, intervals


@njit(cache=True)
def _largest_depth(pieces: np.ndarray, region: Region, collision_at: float) -> float:
    """Largest depth of a path, to a relative `DEPTH_TOLERANCE`, by branch and bound from the piece of its first collision on."""
    stack = np.empty((_STACK, pieces.shape[1], 2))
    largest = 0.0
    for piece in range(max(0, math.ceil(collision_at) - 1), len(pieces)):
        _copy(pieces[piece], stack[0])
        for x, y in (pieces[piece, 0], pieces[piece, -1]):
            largest = max(largest, _depth(x, y, region))
        top = 0
        while top >= 0:
            points = stack[top]
            enough = largest + max(DEPTH_TOLERANCE * largest, _ROUNDING)
            if _size(points) <= _ROUNDING or _depth_bound(points, region) <= enough or _is_free(points, region):
                top -= 1
            else:
                _halve(points, stack[top + 1])
                largest = max(largest, _depth(points[0, 0], points[0, 1], region))
                top += 1
    return largest


@njit(cache=True)
def _least_clearance(pieces: np.ndarray, edges: np.ndarray, centres: np.ndarray, radii: np.ndarray) -> float:
    """Least distance of a free path to edges (n, 4) and discs, to `CLEARANCE_TOLERANCE`, by branch and bound.

    An edge is no nearer to the curve than to its chord, less what the curve may leave its chord by. Obstacles farther away than the least
    distance found are dropped for both halves: they change places with others, behind the number that the halves look at.
    """
    stack = np.empty((_STACK, pieces.shape[1], 2))
    considered = np.empty(_STACK, dtype=np.int64)
    obstacles = np.arange(len(edges) + len(radii))
    least = math.inf
    for piece in range(len(pieces)):
        _copy(pieces[piece], stack[0])
        considered[0] = len(obstacles)
        for x, y in (pieces[piece, 0], pieces[piece, -1]):
            least = min(least, _clearance_of_point(x, y, obstacles, edges, centres, radii))
        top = 0
        while top >= 0:
            points = stack[top]
            bulge = _bulge(points)
            near = 0
            for k in range(considered[top]):
                if _clearance_bound(points, bulge, obstacles[k], edges, centres, radii) < least - CLEARANCE_TOLERANCE:
                    obstacles[near], obstacles[k] = obstacles[k], obstacles[near]
                    near += 1
            if near == 0:
                top -= 1
            else:
                _halve(points, stack[top + 1])
                least = min(least, _clearance_of_point(points[0, 0], points[0, 1], obstacles[:near], edges, centres, radii))
                considered[top] = considered[top + 1] = near
                top += 1
    return least


@njit(cache=True)
def _clearance_of_point(x: float, y: float, obstacles: np.ndarray, edges: np.ndarray, centres: np.ndarray, radii: np.ndarray) -> float:
    """Least distance of a point to some of the obstacles: numbers of edges, and after them of discs."""
    least = math.inf
    for obstacle in obstacles:
        disc = obstacle - len(edges)
        if disc < 0:
            ax, ay, bx, by = edges[obstacle]
            least = min(least, _distance_to_segment(x, y, ax, ay, bx, by))
        else:
            least = min(least, max(0.0, math.hypot(x - centres[disc, 0], y - centres[disc, 1]) - radii[disc]))
    return least


@njit(cache=True)
def _clearance_bound(points: np.ndarray, bulge: float, obstacle: int, edges: np.ndarray, centres: np.ndarray, radii: np.ndarray) -> float:
    """Lower bound of the distance of a curve to an obstacle. A curve leaves its chord by `bulge` at most."""
    ax, ay = points[0]
    bx, by = points[-1]
    disc = obstacle - len(edges)
    if disc < 0:
        return max(0.0, _distance_of_segments(points[0], points[-1], edges[obstacle, :2], edges[obstacle, 2:]) - bulge)
    x, y = centres[disc]
    from_chord = _distance_to_segment(x, y, ax, ay, bx, by) - bulge
    if bulge > 0.0:
        from_chord = max(from_chord, _least_distance_to_centre(points, x, y))
    return max(0.0, from_chord - radii[disc])


@njit(cache=True)
def _turn(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    """Twice the signed area of a triangle, positive if it is counterclockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@njit(cache=True)
def _distance_of_segments(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> float:
    if _turn(a, b, c) * _turn(a, b, d) < 0.0 and _turn(c, d, a) * _turn(c, d, b) < 0.0:
        return 0.0
    return min(
        _distance_to_segment(a[0], a[1], c[0], c[1], d[0], d[1]),
        _distance_to_segment(b[0], b[1], c[0], c[1], d[0], d[1]),
        _distance_to_segment(c[0], c[1], a[0], a[1], b[0], b[1]),
        _distance_to_segment(d[0], d[1], a[0], a[1], b[0], b[1]),
    )


@njit(cache=True)
def _first_corner_cut(pieces: np.ndarray, contacts: np.ndarray, radius: float) -> float:
    """Piece number plus parameter at which a path first passes a closed contact of two occupied cells, infinite if it never does."""
    first = math.inf
    for k in range(len(contacts)):
        first = min(first, _corner_cut_at(pieces, contacts[k, 0], contacts[k, 1], contacts[k, 2], radius))
    return first


@njit(cache=True)
def _corner_cut_at(pieces: np.ndarray, x: float, y: float, slope: float, radius: float) -> float:
    """Piece number plus parameter at which a path first passes one contact, infinite if it never does.

    Around a contact a free path stays in the two free quadrants, which meet in the contact alone. So it passes the contact if it leaves a
    small disc around it on another side of the diagonal through the occupied cells than it came in. A path that begins in the disc may
    leave it on either side.
    """
    stack = np.empty((_STACK, pieces.shape[1], 2))
    begin = np.empty(_STACK)
    width = np.empty(_STACK)
    inside = math.hypot(pieces[0, 0, 0] - x, pieces[0, 0, 1] - y) < radius
    came_from = 0.0 if inside else pieces[0, 0, 0] - x + slope * (pieces[0, 0, 1] - y)
    nearest = math.inf
    nearest_at = 0.0
    for piece in range(len(pieces)):
        _copy(pieces[piece], stack[0])
        begin[0] = 0.0
        width[0] = 1.0
        top = 0
        while top >= 0:
            points = stack[top]
            left, right, bottom, upper = _box(points)
            apart = left > x + radius or right < x - radius or bottom > y + radius or upper < y - radius
            if not apart and _size(points) > radius / 8:
                _halve(points, stack[top + 1])
                width[top] *= 0.5
                width[top + 1] = width[top]
                begin[top + 1] = begin[top]
                begin[top] += width[top]
                top += 1
                continue
            distance = math.hypot(points[-1, 0] - x, points[-1, 1] - y)
            side = points[-1, 0] - x + slope * (points[-1, 1] - y)
            if distance >= radius:
                if inside and came_from * side < 0.0:
                    return nearest_at
                inside = False
                came_from = side
                nearest = math.inf
            else:
                inside = True
                if distance < nearest:
                    nearest = distance
                    nearest_at = piece + begin[top] + width[top]
            top -= 1
    return math.inf
