"""Depth of a colliding path in the blocked region, and clearance of a free one: branch and bound
over halved pieces.
"""

import math

import numpy as np

from bezierplan.geometry.bins import Bins, columns_between, list_members, rows_near
from bezierplan.geometry.checker.certificates import (
    bound_depth,
    bound_distance_to_centre,
    is_free,
    measure_depth,
    measure_distance_to_edges,
)
from bezierplan.geometry.checker.hulls import (
    STACK,
    choose_resolution,
    compute_doubled_area,
    copy_points,
    halve,
    measure_bulge,
    measure_distance_to_segment,
    measure_size,
)
from bezierplan.geometry.region import Region
from bezierplan.kernels import allocation_free, compile_kernel

# Proven error of the clearance in units, and of the depth relative to it.
CLEARANCE_TOLERANCE = 1e-9
DEPTH_TOLERANCE = 1e-6


@compile_kernel
def find_largest_depth(pieces: np.ndarray, region: Region, collision_at: float) -> float:
    """Return the largest depth of a path, to a relative `DEPTH_TOLERANCE` or `choose_resolution` of
    the pieces.

    Branch and bound, starting with the piece of its first collision: all before it is free.
    """
    stack = np.empty((STACK, pieces.shape[1], 2))
    largest = 0.0
    # A whole number is a joint, and the piece that ends there may be the one that collides.
    for piece in range(max(0, math.ceil(collision_at) - 1), len(pieces)):
        copy_points(pieces[piece], stack[0])
        finest = choose_resolution(pieces[piece])
        for x, y in (pieces[piece, 0], pieces[piece, -1]):
            largest = max(largest, measure_depth(x, y, region))
        top = 0
        while top >= 0:
            points = stack[top]
            enough = largest + max(DEPTH_TOLERANCE * largest, finest)
            if (
                measure_size(points) <= finest
                or bound_depth(points, region) <= enough
                or is_free(points, region)
            ):
                top -= 1
            else:
                halve(points, stack[top + 1])
                largest = max(largest, measure_depth(points[0, 0], points[0, 1], region))
                top += 1
    return largest


@compile_kernel
def find_least_clearance(
    pieces: np.ndarray, edges: np.ndarray, bins: Bins, centres: np.ndarray, radii: np.ndarray
) -> float:
    """Return the least distance of a free path to edges (n, 4), with their bins, and discs, to
    `CLEARANCE_TOLERANCE`.

    Branch and bound: the curve is no nearer to an edge than its chord is, minus the largest
    deviation of the curve from its chord. A piece is compared with all discs, and with the edges in
    bins that are no farther away than the least distance found. Obstacles that are farther away are
    dropped for both halves: they are swapped to positions beyond those that the halves examine.
    """
    stack = np.empty((STACK, pieces.shape[1], 2))
    counts = np.empty(STACK, np.int64)
    obstacles = np.empty(len(edges) + len(radii), np.int64)
    piece_of = np.full(len(edges), -1)
    discs = np.arange(len(edges), len(edges) + len(radii))
    least = math.inf
    for piece in range(len(pieces)):
        copy_points(pieces[piece], stack[0])
        # The ends first: a known distance leaves fewer edges within reach.
        for x, y in (pieces[piece, 0], pieces[piece, -1]):
            least = min(
                least,
                measure_distance_to_edges(x, y, edges, bins),
                _measure_clearance_of_point(x, y, discs, edges, centres, radii),
            )
        reach = least + measure_bulge(stack[0])
        count = _find_edges_within(reach, pieces[piece], bins, piece, piece_of, obstacles)
        for disc in discs:
            obstacles[count] = disc
            count += 1
        counts[0] = count
        top = 0
        while top >= 0:
            points = stack[top]
            bulge = measure_bulge(points)
            near = 0
            for k in range(counts[top]):
                if (
                    _bound_clearance(points, bulge, obstacles[k], edges, centres, radii)
                    < least - CLEARANCE_TOLERANCE
                ):
                    obstacles[near], obstacles[k] = obstacles[k], obstacles[near]
                    near += 1
            if near == 0:
                top -= 1
            else:
                halve(points, stack[top + 1])
                least = min(
                    least,
                    _measure_clearance_of_point(
                        points[0, 0], points[0, 1], obstacles[:near], edges, centres, radii
                    ),
                )
                counts[top] = counts[top + 1] = near
                top += 1
    return least


@allocation_free
def _find_edges_within(
    reach: float,
    points: np.ndarray,
    bins: Bins,
    piece: int,
    piece_of: np.ndarray,
    edges: np.ndarray,
) -> int:
    """Find the edges in the bins within reach of a piece's chord, a few more rather than less.

    Their numbers go into `edges`; returns how many there are.

    piece_of: the last piece to which an edge was near, which keeps it from being counted twice.
    """
    count = 0
    reach += CLEARANCE_TOLERANCE
    x, end_x, y, end_y = points[0, 0], points[-1, 0], points[0, 1], points[-1, 1]
    first, last = columns_between(min(x, end_x) - reach, max(x, end_x) + reach, bins)
    low, high = rows_near(min(y, end_y) - reach, max(y, end_y) + reach, bins)
    for column in range(first, last + 1):
        for edge in list_members(column, low, high, bins):
            if piece_of[edge] != piece:
                piece_of[edge] = piece
                edges[count] = edge
                count += 1
    return count


@allocation_free
def _measure_clearance_of_point(
    x: float,
    y: float,
    obstacles: np.ndarray,
    edges: np.ndarray,
    centres: np.ndarray,
    radii: np.ndarray,
) -> float:
    """Return the least distance of a point to some obstacles, by number: edges, then discs."""
    least = math.inf
    for obstacle in obstacles:
        disc = obstacle - len(edges)
        if disc < 0:
            ax, ay, bx, by = edges[obstacle]
            least = min(least, measure_distance_to_segment(x, y, ax, ay, bx, by))
        else:
            least = min(
                least,
                max(0.0, math.hypot(x - centres[disc, 0], y - centres[disc, 1]) - radii[disc]),
            )
    return least


@allocation_free
def _bound_clearance(
    points: np.ndarray,
    bulge: float,
    obstacle: int,
    edges: np.ndarray,
    centres: np.ndarray,
    radii: np.ndarray,
) -> float:
    """Return a lower bound of the distance of a curve to an obstacle.

    A curve deviates from its chord by at most `bulge`.
    """
    (ax, ay), (bx, by) = points[0], points[-1]
    disc = obstacle - len(edges)
    if disc < 0:
        return max(
            0.0,
            _measure_distance_of_segments(
                points[0], points[-1], edges[obstacle, :2], edges[obstacle, 2:]
            )
            - bulge,
        )
    x, y = centres[disc, 0], centres[disc, 1]
    from_chord = measure_distance_to_segment(x, y, ax, ay, bx, by) - bulge
    # Near a disc the Bernstein form is the sharper of the two bounds; a straight curve needs none.
    if bulge > 0.0:
        from_chord = max(from_chord, bound_distance_to_centre(points, x, y))
    return max(0.0, from_chord - radii[disc])


@allocation_free
def _measure_distance_of_segments(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray
) -> float:
    """Return the distance of two segments, 0 if they cross."""
    if (
        compute_doubled_area(a, b, c) * compute_doubled_area(a, b, d) < 0.0
        and compute_doubled_area(c, d, a) * compute_doubled_area(c, d, b) < 0.0
    ):
        return 0.0
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = a, b, c, d
    return min(
        measure_distance_to_segment(ax, ay, cx, cy, dx, dy),
        measure_distance_to_segment(bx, by, cx, cy, dx, dy),
        measure_distance_to_segment(cx, cy, ax, ay, bx, by),
        measure_distance_to_segment(dx, dy, ax, ay, bx, by),
    )
