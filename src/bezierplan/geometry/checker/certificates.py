"""The questions of the searches about a region: whether a point is blocked, whether a hull is free,
and how deep they are.

Each kind of region has its own answers. The overloads at the end select them by its type.
"""

import math

import numpy as np
from numba.extending import overload

from bezierplan.geometry.bins import (
    Bins,
    columns_between,
    list_members,
    rows_between,
    rows_near,
)
from bezierplan.geometry.checker.hulls import (
    BINOMIAL,
    LARGEST_COORDINATE,
    TOLERANCE,
    bound_box,
    choose_direction,
    measure_bulge,
    measure_distance_to_segment,
    measure_range_along,
)
from bezierplan.geometry.region import CircleRegion, GridRegion, PolygonRegion
from bezierplan.kernels import allocation_free

# Extent of the cells around a grid that represent its outside: beyond every coordinate.
_FAR = 4 * LARGEST_COORDINATE

# Hulls that span more doubled-grid elements than this are halved instead of tested against each
# blocked element.
_WIDEST_RANGE = 12

# An edge at this distance from a hull cannot be passed within the tolerance of its ends, so it is
# irrelevant to the hull.
_APART = 4 * TOLERANCE

# Share of a bin's side by which an edge's bins may miss its own, by rounding.
_RING_MARGIN = 0.01

# --------------------------------------------------------------------------------------------------
# The questions. numba compiles the answer for a kind of region in their place, by the overloads
# below; without compilation (NUMBA_DISABLE_JIT) their bodies find the same answers.


def is_blocked(x, y, region):
    """Tell whether a point is certainly blocked: its depth is above the tolerance."""
    return _IS_BLOCKED[type(region)](x, y, region)


def is_free(points, region):
    """Tell whether the curve of some control points is certified free.

    The answer may be false for a free curve, but not indefinitely as the curve is halved.
    """
    return _IS_FREE[type(region)](points, region)


def measure_depth(x, y, region):
    """Return the depth of a point in the blocked region, 0 outside."""
    return _DEPTH_AT[type(region)](x, y, region)


def bound_depth(points, region):
    """Return an upper bound of the depth of the curve of some control points."""
    return _DEPTH_BOUND[type(region)](points, region)


# --------------------------------------------------------------------------------------------------
# Cells: elements of the doubled grid, and separating axes


@allocation_free
def _find_element(x: float, cell: float, last: int) -> int:
    """Return the index in the doubled grid of a coordinate.

    It is odd on a grid line (within the tolerance), even in a cell; the outside is 0 and `last`.
    """
    line = round(x / cell)
    index = 2 * math.floor(x / cell) + 2
    if abs(x - line * cell) <= TOLERANCE:
        index = 2 * line + 1
    return min(max(index, 0), last)


@allocation_free
def _find_sides(index: int, cell: float, last: int) -> tuple[float, float]:
    """Return the lowest and highest coordinate of the cells that touch an element: one cell for
    even indices, two for odd ones.
    """
    low = -_FAR if index <= 1 else (index // 2 - 1) * cell
    high = _FAR if index >= last - 1 else ((index + 1) // 2) * cell
    return low, high


def _is_blocked_in_grid(x, y, region):
    """Tell whether a point's element of the doubled grid is blocked."""
    rows, columns = region.blocked.shape
    return region.blocked[
        _find_element(y, region.cell, rows - 1), _find_element(x, region.cell, columns - 1)
    ]


def _is_free_in_grid(points, region):
    """Tell whether a hull is free, by its bounding box or by its own direction as separating
    axis.
    """
    rows, columns = region.blocked.shape
    cell, counts = region.cell, region.counts
    x_low, x_high, y_low, y_high = bound_box(points)
    # The rectangle of an edge or vertex covers the cells on both sides of a seam. To catch every
    # seam, the second range extends as far beyond the hull as a hull may reach into a rectangle.
    for reach in (0.0, 2.0 * TOLERANCE):
        left = _find_element(x_low - reach, cell, columns - 1)
        right = _find_element(x_high + reach, cell, columns - 1)
        bottom = _find_element(y_low - reach, cell, rows - 1)
        top = _find_element(y_high + reach, cell, rows - 1)
        # As many blocked elements lie below and left of the range as with it: none is in it.
        if reach == 0.0 and (
            counts[top + 1, right + 1] - counts[bottom, right + 1]
            == counts[top + 1, left] - counts[bottom, left]
        ):
            return True
    # Halves of the hull span fewer elements, so this is no verdict.
    if right - left >= _WIDEST_RANGE or top - bottom >= _WIDEST_RANGE:
        return False
    along_x, along_y = choose_direction(points)
    across_low, across_high = measure_range_along(points, -along_y, along_x)
    for row in range(bottom, top + 1):
        rectangle_bottom, rectangle_top = _find_sides(row, cell, rows - 1)
        if y_high <= rectangle_bottom + reach or y_low >= rectangle_top - reach:
            continue
        for column in range(left, right + 1):
            if not region.blocked[row, column]:
                continue
            rectangle_left, rectangle_right = _find_sides(column, cell, columns - 1)
            if x_high <= rectangle_left + reach or x_low >= rectangle_right - reach:
                continue
            # The box was tested above, so the axis across the hull is left: it separates a slanted
            # hull.
            x = 0.5 * (rectangle_left + rectangle_right) - points[0, 0]
            y = 0.5 * (rectangle_bottom + rectangle_top) - points[0, 1]
            middle = along_x * y - along_y * x
            half = 0.5 * (
                abs(along_y) * (rectangle_right - rectangle_left)
                + abs(along_x) * (rectangle_top - rectangle_bottom)
            )
            if across_high > middle - half + reach and across_low < middle + half - reach:
                return False
    return True


# --------------------------------------------------------------------------------------------------
# Distance to boundary edges, for cells and polygons


@allocation_free
def measure_distance_to_edges(x: float, y: float, edges: np.ndarray, bins: Bins) -> float:
    """Return the distance of a point from the nearest edge."""
    return _bound_distance_to_edges(x, y, x, y, edges, bins)


@allocation_free
def _bound_distance_to_edges(
    x: float, y: float, other_x: float, other_y: float, edges: np.ndarray, bins: Bins
) -> float:
    """Return the least of all edges' larger distance from two points.

    Bins are looked at in square rings around the first point. Beyond a ring, edges are at least as
    far from the point, or from the place among the bins that is nearest to it, as the ring is wide.
    """
    middle_column, _ = columns_between(x, x, bins)
    middle_row, _ = rows_near(y, y, bins)
    middle_column, middle_row = min(middle_column, bins.columns - 1), min(middle_row, bins.rows - 1)
    least = math.inf
    for ring in range(max(bins.columns, bins.rows)):
        if least <= (ring - 1 - _RING_MARGIN) * bins.side:
            break
        left, right = max(middle_column - ring, 0), min(middle_column + ring, bins.columns - 1)
        for column in range(left, right + 1):
            # Of the columns in between, only both ends are in the ring.
            step = 1 if abs(column - middle_column) == ring else 2 * ring
            for row in range(middle_row - ring, middle_row + ring + 1, step):
                if not 0 <= row < bins.rows:
                    continue
                for e in list_members(column, row, row, bins):
                    ax, ay, bx, by = edges[e]
                    first = measure_distance_to_segment(x, y, ax, ay, bx, by)
                    if first < least:
                        other = measure_distance_to_segment(other_x, other_y, ax, ay, bx, by)
                        least = min(least, max(first, other))
    return least


def _measure_depth_by_edges(x, y, region):
    """Return a point's depth as its distance from the boundary."""
    return (
        measure_distance_to_edges(x, y, region.edges, region.bins)
        if is_blocked(x, y, region)
        else 0.0
    )


def _bound_depth_by_edges(points, region):
    """Return an upper bound of a curve's depth by the boundary edges.

    No blocked point is deeper than its distance from any edge, which along a chord is greatest at
    one of its ends.
    """
    largest = _bound_distance_to_edges(
        points[0, 0], points[0, 1], points[-1, 0], points[-1, 1], region.edges, region.bins
    )
    return largest + measure_bulge(points)


# --------------------------------------------------------------------------------------------------
# Circles: the Bernstein form of the squared distance


@allocation_free
def bound_distance_to_centre(points: np.ndarray, x: float, y: float) -> float:
    """Return a lower bound of the distance of a curve to a point.

    It is the square root of the smallest Bernstein coefficient of the squared distance. The point
    is subtracted first, so that the error stays relative to the distance.
    """
    # The squared distance is a polynomial of twice the degree, and no polynomial lies below its
    # least Bernstein coefficient. Those of a product are sums over all i + j = k.
    n = len(points) - 1
    least = math.inf
    for k in range(2 * n + 1):
        coefficient = 0.0
        for i in range(max(0, k - n), min(n, k) + 1):
            j = k - i
            product = (points[i, 0] - x) * (points[j, 0] - x) + (points[i, 1] - y) * (
                points[j, 1] - y
            )
            coefficient += BINOMIAL[n, i] * BINOMIAL[n, j] * product
        least = min(least, coefficient / BINOMIAL[2 * n, k])
    return math.sqrt(max(0.0, least))


@allocation_free
def _measure_depth_beyond_border(x: float, y: float, bounds: np.ndarray) -> float:
    """Return how far a point lies beyond the border, 0 within it."""
    left, right, bottom, top = bounds
    return math.hypot(max(0.0, left - x, x - right), max(0.0, bottom - y, y - top))


def _measure_depth_in_circles(x, y, region):
    """Return a point's depth: the largest beyond the border or in a disc."""
    depth = _measure_depth_beyond_border(x, y, region.bounds)
    for k in range(len(region.radii)):
        depth = max(
            depth, region.radii[k] - math.hypot(x - region.centres[k, 0], y - region.centres[k, 1])
        )
    return depth


def _is_blocked_in_circles(x, y, region):
    """Tell whether a point's depth is above the tolerance."""
    return measure_depth(x, y, region) > TOLERANCE


def _is_free_in_circles(points, region):
    """Tell whether a hull keeps within the border and clear of all discs."""
    x_low, x_high, y_low, y_high = bound_box(points)
    left, right, bottom, top = region.bounds
    reach = 2.0 * TOLERANCE
    if (
        x_low < left - reach
        or x_high > right + reach
        or y_low < bottom - reach
        or y_high > top + reach
    ):
        return False
    along_x, along_y = choose_direction(points)
    along_low, along_high = measure_range_along(points, along_x, along_y)
    across_low, across_high = measure_range_along(points, -along_y, along_x)
    for k in range(len(region.radii)):
        radius = region.radii[k] - reach
        x = region.centres[k, 0] - points[0, 0]
        y = region.centres[k, 1] - points[0, 1]
        along = along_x * x + along_y * y
        across = along_x * y - along_y * x
        outside_along = max(0.0, along_low - along, along - along_high)
        outside_across = max(0.0, across_low - across, across - across_high)
        # The rectangle around the hull clears most discs; the Bernstein form costs the square of
        # the degree.
        if math.hypot(outside_along, outside_across) >= radius:
            continue
        if bound_distance_to_centre(points, region.centres[k, 0], region.centres[k, 1]) < radius:
            return False
    return True


def _bound_depth_in_circles(points, region):
    """Return an upper bound of a curve's depth beyond the border and in discs."""
    bound = 0.0
    for x, y in points:
        bound = max(bound, _measure_depth_beyond_border(x, y, region.bounds))
    for k in range(len(region.radii)):
        # No disc is deeper than its radius.
        if region.radii[k] > bound:
            bound = max(
                bound,
                region.radii[k]
                - bound_distance_to_centre(points, region.centres[k, 0], region.centres[k, 1]),
            )
    return bound


# --------------------------------------------------------------------------------------------------
# Polygons: chains of the boundary edges that a hull touches


def _is_blocked_in_polygons(x, y, region):
    """Tell whether a point is certainly blocked.

    It is in free space if a ray from it crosses the boundary an odd number of times; only edges
    near the point and its ray are looked at.
    """
    bins, edges = region.bins, region.edges
    row = int((y - bins.low[1]) // bins.side)
    begin, _ = columns_between(x, x, bins)
    inside_free = False
    # Below and above all edges, as by rounding on the border, the ray meets none.
    for column in range(begin, bins.columns if 0 <= row < bins.rows else 0):
        for e in list_members(column, row, row, bins):
            ax, ay, bx, by = edges[e]
            if (ay > y) != (by > y):
                at = ax + (y - ay) / (by - ay) * (bx - ax)
                # An edge lies in several bins; it counts in the one of the crossing.
                first, last = columns_between(ax, bx, bins)
                crossed, _ = columns_between(at, at, bins)
                if x < at and min(max(crossed, first), last) == column:
                    inside_free = not inside_free
    if inside_free:
        return False
    reach = 2.0 * TOLERANCE
    begin, end = columns_between(x - reach, x + reach, bins)
    low, high = rows_near(y - reach, y + reach, bins)
    for column in range(begin, end + 1):
        for e in list_members(column, low, high, bins):
            ax, ay, bx, by = edges[e]
            if measure_distance_to_segment(x, y, ax, ay, bx, by) <= TOLERANCE:
                return False
    return True


@allocation_free
def _measure_sides_of_edge(points, edge, normal) -> tuple[float, float]:
    """Return the range of distances of control points from an edge's line, positive where free."""
    low = math.inf
    high = -math.inf
    for x, y in points:
        distance = (x - edge[0]) * normal[0] + (y - edge[1]) * normal[1]
        low = min(low, distance)
        high = max(high, distance)
    return low, high


def _is_free_in_polygons(points, region):
    """Tell whether a hull is free: it begins in free space and does not cross the boundary.

    Edges away from the hull do not matter, whichever side it is on. The others form chains of
    consecutive edges: see `_pass_chain`.
    """
    x_low, x_high, y_low, y_high = hull_box = bound_box(points)
    along_x, along_y = choose_direction(points)
    across_low, across_high = measure_range_along(points, -along_y, along_x)
    contacts = np.zeros(len(region.edges), np.bool_)
    near = np.empty(len(region.edges), np.int64)
    count = 0
    bins = region.bins
    # So thin a hull meets only edges in the bins along its chord, not in all of its box.
    is_straight = measure_bulge(points) <= _APART
    first, last = columns_between(x_low, x_high, bins)
    begin, end = columns_between(x_low - 2.0 * _APART, x_high + 2.0 * _APART, bins)
    low, high = rows_near(y_low - 2.0 * _APART, y_high + 2.0 * _APART, bins)
    for column in range(begin, end + 1):
        if is_straight:
            within = min(max(column, first), last)
            low, high = rows_between(points[0], points[-1], within, bins)
        for e in list_members(column, low, high, bins):
            if not contacts[e] and _can_touch(
                points, hull_box, along_x, along_y, across_low, across_high, region, e
            ):
                contacts[e] = True
                near[count] = e
                count += 1

    remaining = count
    for e in near[:count]:
        if not contacts[region.preceding[e]]:
            length = _pass_chain(
                points, region, contacts, e, along_x, along_y, across_low, across_high
            )
            if length == 0:
                return False
            remaining -= length
    # Only rings that the hull touches all around remain: undecided.
    return remaining == 0 and not is_blocked(points[0, 0], points[0, 1], region)


@allocation_free
def _can_touch(points, hull_box, along_x, along_y, across_low, across_high, region, e) -> bool:
    """Tell whether an edge may touch a hull with a bounding box, and a range across its
    direction.
    """
    x_low, x_high, y_low, y_high = hull_box
    ax, ay, bx, by = region.edges[e]
    if (
        max(ax, bx) < x_low - _APART
        or min(ax, bx) > x_high + _APART
        or max(ay, by) < y_low - _APART
        or min(ay, by) > y_high + _APART
    ):
        return False
    across_a = along_x * (ay - points[0, 1]) - along_y * (ax - points[0, 0])
    across_b = along_x * (by - points[0, 1]) - along_y * (bx - points[0, 0])
    if (
        max(across_a, across_b) < across_low - _APART
        or min(across_a, across_b) > across_high + _APART
    ):
        return False
    low, high = _measure_sides_of_edge(points, region.edges[e], region.normals[e])
    return low <= _APART and high >= -_APART


@allocation_free
def _pass_chain(points, region, contacts, first, along_x, along_y, across_low, across_high) -> int:
    """Return the number of edges of a chain of touched edges if a hull passes it on the free side,
    or 0.

    It does if it lies on the free side of all lines of the chain. Where the blocked region is
    convex at the chain's corners, one of these lines is enough, or any line between hull and chain
    with free space on the hull's side; the line along the hull is tried.
    """
    reach = 2.0 * TOLERANCE
    length = 0
    beside_all = True
    beside_one = False
    only_convex = True
    chain_low = facing_low = math.inf
    chain_high = facing_high = -math.inf
    e = first
    while contacts[e]:
        if length > 0:
            only_convex &= region.convex[region.preceding[e]]
        length += 1
        low, _ = _measure_sides_of_edge(points, region.edges[e], region.normals[e])
        beside_all &= low >= -reach
        beside_one |= low >= -reach
        facing = along_x * region.normals[e, 1] - along_y * region.normals[e, 0]
        facing_low = min(facing_low, facing)
        facing_high = max(facing_high, facing)
        for k in (0, 2):
            across = along_x * (region.edges[e, k + 1] - points[0, 1]) - along_y * (
                region.edges[e, k] - points[0, 0]
            )
            chain_low = min(chain_low, across)
            chain_high = max(chain_high, across)
        e = region.following[e]
    above = across_low >= chain_high - reach and facing_high > 0.0
    below = across_high <= chain_low + reach and facing_low < 0.0
    return length if beside_all or (only_convex and (beside_one or above or below)) else 0


# --------------------------------------------------------------------------------------------------
# The answers by kind of region

_IS_BLOCKED = {
    GridRegion: _is_blocked_in_grid,
    CircleRegion: _is_blocked_in_circles,
    PolygonRegion: _is_blocked_in_polygons,
}
_IS_FREE = {
    GridRegion: _is_free_in_grid,
    CircleRegion: _is_free_in_circles,
    PolygonRegion: _is_free_in_polygons,
}
_DEPTH_AT = {
    GridRegion: _measure_depth_by_edges,
    CircleRegion: _measure_depth_in_circles,
    PolygonRegion: _measure_depth_by_edges,
}
_DEPTH_BOUND = {
    GridRegion: _bound_depth_by_edges,
    CircleRegion: _bound_depth_in_circles,
    PolygonRegion: _bound_depth_by_edges,
}


overload(is_blocked)(lambda x, y, region: _IS_BLOCKED[region.instance_class])
overload(is_free)(lambda points, region: _IS_FREE[region.instance_class])
overload(measure_depth)(lambda x, y, region: _DEPTH_AT[region.instance_class])
overload(bound_depth)(lambda points, region: _DEPTH_BOUND[region.instance_class])
