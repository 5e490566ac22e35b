"""The certified check of a footprint, a convex polygon that turns as it travels.

While a part of a path is driven, each corner of the footprint moves along a curve that deviates
from the line between its places at both ends by at most an eighth of its largest acceleration (with
the part's parameter from 0 to 1). So the footprint stays within that distance of the convex hull of
its two places. A part whose hull is farther from all obstacles is free; others are halved. On
straight lines the hull is what the footprint sweeps.

Two footprints, smaller by a share and by twice that, guarantee that this always ends: a collision
is certified by a place of the larger one that meets an obstacle, freedom by the parts of the
smaller one. At a corner of the path the robot turns on the spot, the shorter way round; where a
curve stands still, its heading is not known, and the circle around the footprint must be free.
"""

import math
from typing import NamedTuple

import numpy as np

from bezierplan.geometry.checker.hulls import (
    STACK,
    TOLERANCE,
    box,
    copy_points,
    distance_to_segment,
    size,
    split_top,
)
from bezierplan.geometry.region import CircleRegion, Region, blocks, from_origin
from bezierplan.kernels import allocation_free, compiled
from bezierplan.workspaces.footprint import Footprint

SHARE = 1e-6
"""By which share of its distance from the centroid a point of the footprint that meets an obstacle
is certainly a collision, at most; up to twice that can be called free. Of footprints below a few
millimetres, in units of a metre, it is more.
"""

CLEARANCE_SHARE = 1e-6
"""Proven error of the clearance, as a share of the radius of the circle around the footprint."""

# Directions that differ by less, in radians, are one.
_SAME_HEADING = 1e-9

# A part of a curve this short, as a share of the radius of the circle around the footprint, without
# a known direction stands still.
_STANDSTILL = 1e-7

# A share of a piece this short that is still undecided counts as a collision.
_SHORTEST = 1e-13


class FootprintCheck(NamedTuple):
    """feasible: whether the footprint enters no obstacle and stays within the border. collision_at:
    number of the piece plus the parameter within it of the first collision; nan when free.
    clearance: least distance of the footprint to obstacles and border, in units; 0 when colliding.
    tolerance: its proven error.
    """

    feasible: bool
    collision_at: float
    clearance: float
    tolerance: float


def check_footprint(pieces: np.ndarray, region: Region, footprint: Footprint) -> FootprintCheck:
    """Check the footprint along Bézier pieces (pieces, degree + 1, 2) that are free (`check`)."""
    reach = footprint.circumscribed
    tolerance = CLEARANCE_SHARE * reach
    share = max(SHARE, 4 * TOLERANCE / footprint.thickness)
    moves, headings, numbers = _moves(
        from_origin(np.ascontiguousarray(pieces, dtype=float), region)
    )
    if isinstance(region, CircleRegion):
        obstacles = region.edges, region.centres, region.radii
    else:
        obstacles = region.edges, np.empty((0, 2)), np.empty(0)
    outer, inner = (
        footprint.middle + (1 - smaller) * (footprint.corners - footprint.middle)
        for smaller in (share, 2 * share)
    )
    at = 0.0
    if not blocks(region, _middle_at_start(pieces, footprint)):
        at = first_entry(moves, headings, outer, inner, reach, *obstacles)
    if at < math.inf:
        move = min(int(at), len(moves) - 1)
        return FootprintCheck(
            False, float(numbers[move] + (at - move) * np.isnan(headings[move, 0])), 0.0, 0.0
        )
    clearance = footprint_clearance(
        moves, headings, footprint.corners, reach, tolerance, *obstacles
    )
    return FootprintCheck(True, math.nan, clearance, tolerance)


def _middle_at_start(pieces: np.ndarray, footprint: Footprint) -> tuple[float, float]:
    """Where the centroid is at the start; the reference point where the heading is not known."""
    x, y = pieces[0, 0]
    along = pieces[0, 1] - pieces[0, 0]
    length = math.hypot(*along)
    if length == 0:
        return x, y
    (ahead, left), (east, north) = footprint.middle, along / length
    return x + east * ahead - north * left, y + north * ahead + east * left


def _moves(pieces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What the robot does: pieces (n, degree + 1, 2) along which it drives, or on whose one point
    it turns; its headings (n, 2) at both ends of a turn, nan of a drive; and the number (n,) of the
    piece of the path.
    """
    moving = np.flatnonzero(np.any(pieces != pieces[:, :1], axis=(1, 2)))
    if not len(moving):
        return pieces[:1], np.full((1, 2), math.nan), np.zeros(1, dtype=np.int64)
    driven = pieces[moving]
    leaving, arriving = driven[1:, 1] - driven[1:, 0], driven[:-1, -1] - driven[:-1, -2]
    known = np.any(leaving != 0, axis=1) & np.any(arriving != 0, axis=1)
    before, after = (np.arctan2(each[:, 1], each[:, 0]) for each in (arriving, leaving))
    turn = np.remainder(after - before + math.pi, math.tau) - math.pi
    turns = np.flatnonzero(known & (np.abs(turn) > _SAME_HEADING))
    spots = np.repeat(driven[turns + 1, :1], pieces.shape[1], axis=1)
    at = turns + 1
    return (
        np.ascontiguousarray(np.insert(driven, at, spots, axis=0)),
        np.insert(
            np.full((len(driven), 2), math.nan),
            at,
            np.column_stack([before, before + turn])[turns],
            axis=0,
        ),
        np.insert(moving, at, moving[at]),
    )


# --------------------------------------------------------------------------------------------------
# The searches


@compiled
def first_entry(moves, headings, outer, inner, reach, edges, centres, radii):
    """Number of the move plus the share of it at which the footprint first meets an obstacle;
    infinite if it does not.

    outer, inner: (n, 2) corners of the footprint that certifies collisions and of the smaller one
    that is certified free. Depth first, left half first.
    """
    stack, begin, width, turn, considered, places, hull = _room(moves, inner)
    obstacles = np.arange(len(edges) + len(radii))
    for move in range(len(moves)):
        top = _put_whole(
            moves[move], headings[move], len(obstacles), stack, begin, width, turn, considered
        )
        while top >= 0:
            first, last, deviation = _motion(stack[top], turn[top], reach)
            near = considered[top]
            if deviation < np.inf:
                count = _swept(stack[top], first, last, inner, places, hull)
                near = _nearer(obstacles, near, hull[:count], deviation, edges, centres, radii)
                if near == 0:
                    top -= 1
                    continue
                count = _swept(stack[top, :1], first, first, outer, places, hull)
                if _least_distance(obstacles[:near], hull[:count], edges, centres, radii) == 0.0:
                    return move + begin[top]
            elif size(stack[top]) <= _STANDSTILL * reach:
                if _least_distance(obstacles[:near], stack[top, :1], edges, centres, radii) < reach:
                    return move + begin[top]
                top -= 1
                continue
            if width[top] < _SHORTEST:
                return move + begin[top]
            _split(stack, begin, width, turn, top)
            considered[top] = considered[top + 1] = near
            top += 1
    return np.inf


@compiled
def footprint_clearance(moves, headings, corners, reach, tolerance, edges, centres, radii):
    """Least distance of a free footprint from edges (n, 4) and discs, to a tolerance."""
    stack, begin, width, turn, considered, places, hull = _room(moves, corners)
    obstacles = np.arange(len(edges) + len(radii))
    least = np.inf
    for move in range(len(moves)):
        top = _put_whole(
            moves[move], headings[move], len(obstacles), stack, begin, width, turn, considered
        )
        while top >= 0:
            first, last, deviation = _motion(stack[top], turn[top], reach)
            near = considered[top]
            if deviation < np.inf:
                for end in range(2):
                    place, heading = (
                        (stack[top, :1], first) if end == 0 else (stack[top, -1:], last)
                    )
                    count = _swept(place, heading, heading, corners, places, hull)
                    least = min(
                        least,
                        _least_distance(obstacles[:near], hull[:count], edges, centres, radii),
                    )
                count = _swept(stack[top], first, last, corners, places, hull)
                near = _nearer(
                    obstacles,
                    near,
                    hull[:count],
                    least + deviation - tolerance,
                    edges,
                    centres,
                    radii,
                )
                if near == 0 or width[top] < _SHORTEST:
                    top -= 1
                    continue
            elif size(stack[top]) <= _STANDSTILL * reach:
                least = min(
                    least,
                    max(
                        0.0,
                        _least_distance(obstacles[:near], stack[top, :1], edges, centres, radii)
                        - reach,
                    ),
                )
                top -= 1
                continue
            _split(stack, begin, width, turn, top)
            considered[top] = considered[top + 1] = near
            top += 1
    return least


@compiled
def _room(moves, corners):
    """Arrays of a search: of each part on its stack the points, where it begins in its move, its
    share of it, its headings at both ends and how many obstacles come near it; and scratch for the
    places of a footprint's corners (n, 2) and their hull.
    """
    parts, begin, width = np.empty((STACK, moves.shape[1], 2)), np.empty(STACK), np.empty(STACK)
    turn, considered = np.empty((STACK, 2)), np.empty(STACK, dtype=np.int64)
    return (
        parts,
        begin,
        width,
        turn,
        considered,
        np.empty((2 * len(corners), 2)),
        np.empty((4 * len(corners) + 2, 2)),
    )


@allocation_free
def _put_whole(points, headings, obstacles, stack, begin, width, turn, considered):
    """Put a whole move at the bottom of the stack; returns its place there."""
    copy_points(points, stack[0])
    begin[0], width[0], considered[0] = 0.0, 1.0, obstacles
    turn[0, 0], turn[0, 1] = headings[0], headings[1]
    return 0


@allocation_free
def _split(stack, begin, width, turn, top):
    """Split the uppermost part, its headings too."""
    split_top(stack, begin, width, top)
    middle = 0.5 * (turn[top, 0] + turn[top, 1])
    turn[top + 1, 0], turn[top + 1, 1] = turn[top, 0], middle
    turn[top, 0] = middle


# --------------------------------------------------------------------------------------------------
# What the footprint sweeps


@allocation_free
def _motion(points, turn, reach):
    """Headings at both ends of a part of the way, and how far the footprint is from the hull of its
    places there, at most.

    The distance is infinite where the direction of travel cannot be bounded. With p' along the
    chord at least v, the heading changes at a rate of |p' x p''| / v^2 at most, and that rate at
    one of |p' x p'''| / v^2 + 2 |p' x p''| |p' . p''| / v^4.
    """
    if not math.isnan(turn[0]):
        return turn[0], turn[1], 0.125 * reach * (turn[1] - turn[0]) ** 2
    n = len(points) - 1
    x, y = points[-1, 0] - points[0, 0], points[-1, 1] - points[0, 1]
    length = math.hypot(x, y)
    if length == 0.0:
        return 0.0, 0.0, np.inf
    x, y = x / length, y / length
    slowest, speed, drift = _derivative(points, 1, x, y)
    if slowest <= 0.0:
        return 0.0, 0.0, np.inf
    _, pull, sway = _derivative(points, 2, x, y)
    _, jerk, swing = _derivative(points, 3, x, y)
    bend = speed * sway + drift * pull
    rate = bend / slowest**2
    change = (speed * swing + drift * jerk) / slowest**2 + 2.0 * bend * (
        speed * pull + drift * sway
    ) / slowest**4
    deviation = 0.125 * (math.hypot(pull, sway) + reach * (rate**2 + change))
    # From the place in which it begins, moved along the chord.
    deviation = min(deviation, 0.125 * sway + reach * rate)
    first = math.atan2(points[1, 1] - points[0, 1], points[1, 0] - points[0, 0])
    return (
        first,
        math.atan2(points[n, 1] - points[n - 1, 1], points[n, 0] - points[n - 1, 0]),
        deviation,
    )


@allocation_free
def _derivative(points, order, x, y):
    """Of a derivative along a piece, the smallest component in a direction and the largest sizes
    along it and across, at most.
    """
    n = len(points) - 1
    low, along, across = np.inf, 0.0, 0.0
    scale = n if order == 1 else n * (n - 1) if order == 2 else n * (n - 1) * (n - 2)
    for k in range(n + 1 - order):
        east, north = points[k + 1, 0] - points[k, 0], points[k + 1, 1] - points[k, 1]
        if order > 1:
            east = points[k + 2, 0] - points[k + 1, 0] - east
            north = points[k + 2, 1] - points[k + 1, 1] - north
        if order > 2:
            east = points[k + 3, 0] - 3.0 * points[k + 2, 0] + 3.0 * points[k + 1, 0] - points[k, 0]
            north = (
                points[k + 3, 1] - 3.0 * points[k + 2, 1] + 3.0 * points[k + 1, 1] - points[k, 1]
            )
        component = scale * (x * east + y * north)
        low = min(low, component)
        along = max(along, abs(component))
        across = max(across, abs(scale * (x * north - y * east)))
    return low, along, across


@allocation_free
def _swept(points, first, last, corners, places, hull):
    """Write the convex hull of the footprint's places at the beginning and the end of a part of the
    way; returns its number of corners.
    """
    count = len(corners)
    for end in range(2):
        heading, point = (first, points[0]) if end == 0 else (last, points[-1])
        cosine, sine = math.cos(heading), math.sin(heading)
        for k in range(count):
            places[end * count + k, 0] = point[0] + cosine * corners[k, 0] - sine * corners[k, 1]
            places[end * count + k, 1] = point[1] + sine * corners[k, 0] + cosine * corners[k, 1]
    return _hull(places, hull)


@allocation_free
def _hull(points, hull):
    """Write the convex hull of some points (n, 2), counterclockwise; sorts the points. Returns its
    number of corners (Andrew 1979).
    """
    for i in range(1, len(points)):
        x, y = points[i, 0], points[i, 1]
        j = i
        while j > 0 and (points[j - 1, 0] > x or (points[j - 1, 0] == x and points[j - 1, 1] > y)):
            points[j, 0], points[j, 1] = points[j - 1, 0], points[j - 1, 1]
            j -= 1
        points[j, 0], points[j, 1] = x, y
    count = 0
    for half in range(2):
        kept = count + 1
        for step in range(len(points)):
            x, y = points[step if half == 0 else len(points) - 1 - step]
            while count > kept and _left_of(hull[count - 2], hull[count - 1], x, y) <= 0.0:
                count -= 1
            hull[count, 0], hull[count, 1] = x, y
            count += 1
        count -= 1  # the last point of one half is the first of the other
    return count


@allocation_free
def _left_of(a, b, x, y):
    """Twice the area of the triangle of a, b and a point, positive if that lies to the left."""
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])


# --------------------------------------------------------------------------------------------------
# Distances from obstacles, which have numbers: edges first, then discs


@allocation_free
def _nearer(obstacles, count, hull, limit, edges, centres, radii):
    """Sort those of the first obstacles that are no farther from a convex polygon than a limit to
    the beginning; returns their number.
    """
    around = box(hull)
    near = 0
    for k in range(count):
        beside = _beside(obstacles[k], around, edges, centres, radii)
        if beside <= limit and _distance(obstacles[k], hull, edges, centres, radii) <= limit:
            obstacles[near], obstacles[k] = obstacles[k], obstacles[near]
            near += 1
    return near


@allocation_free
def _least_distance(obstacles, hull, edges, centres, radii):
    """Distance of a convex polygon, or a point, from the nearest of some obstacles."""
    around = box(hull)
    least = np.inf
    for obstacle in obstacles:
        if _beside(obstacle, around, edges, centres, radii) < least:
            least = min(least, _distance(obstacle, hull, edges, centres, radii))
    return least


@allocation_free
def _beside(obstacle, around, edges, centres, radii):
    """A lower bound of the distance of an obstacle from what a box is around."""
    left, right, bottom, top = around
    disc = obstacle - len(edges)
    if disc < 0:
        ax, ay, bx, by = edges[obstacle]
        return max(left - max(ax, bx), min(ax, bx) - right, bottom - max(ay, by), min(ay, by) - top)
    x, y = centres[disc, 0], centres[disc, 1]
    return max(left - x, x - right, bottom - y, y - top) - radii[disc]


@allocation_free
def _distance(obstacle, hull, edges, centres, radii):
    """Distance of a convex polygon (n, 2), counterclockwise, or a point from an obstacle; 0 if they
    meet.
    """
    disc = obstacle - len(edges)
    if disc < 0:
        ax, ay, bx, by = edges[obstacle]
        radius = 0.0
    else:
        ax, ay, radius = centres[disc, 0], centres[disc, 1], radii[disc]
        bx, by = ax, ay
    inside = len(hull) > 2
    least = np.inf
    for k in range(len(hull)):
        corner, next_corner = hull[k], hull[(k + 1) % len(hull)]
        inside &= _left_of(corner, next_corner, ax, ay) >= 0.0
        least = min(
            least,
            distance_to_segment(corner[0], corner[1], ax, ay, bx, by),
            distance_to_segment(ax, ay, corner[0], corner[1], next_corner[0], next_corner[1]),
        )
        least = min(
            least, distance_to_segment(bx, by, corner[0], corner[1], next_corner[0], next_corner[1])
        )
        if _left_of(corner, next_corner, ax, ay) * _left_of(corner, next_corner, bx, by) < 0.0:
            across = (
                (bx - ax) * (corner[1] - ay) - (by - ay) * (corner[0] - ax),
                (bx - ax) * (next_corner[1] - ay) - (by - ay) * (next_corner[0] - ax),
            )
            if across[0] * across[1] < 0.0:
                return 0.0
    return 0.0 if inside else max(0.0, least - radius)
