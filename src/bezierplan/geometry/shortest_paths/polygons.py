"""Shortest paths among polygons: visibility between convex corners."""

import heapq
import math

import numpy as np

from bezierplan.geometry.bins import Bins, columns_between, list_members, rows_between
from bezierplan.geometry.checker import TOLERANCE, find_first_collision
from bezierplan.geometry.checker.hulls import compute_doubled_area, measure_distance
from bezierplan.geometry.region import PolygonRegion
from bezierplan.geometry.shortest_paths.graph import Bound, follow_nodes
from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.trace import trace_back


def shortest_among_polygons(problem: Problem, blocked: PolygonRegion) -> Bound:
    """Find the shortest path along start, target, the convex corners of the blocked region, and the
    points at which its corners meet.
    """
    begin = blocked.edges[:, :2]
    corner = np.flatnonzero(blocked.convex)
    repeated, count = np.unique(begin, axis=0, return_counts=True)
    # Where corners meet, a path may pass between them and turn either way.
    anywhere = np.concatenate([problem.ends, repeated[count > 1]])
    nodes = np.concatenate([anywhere, blocked.edges[corner, 2:]])
    before = np.concatenate([anywhere, begin[corner]])
    after = np.concatenate([anywhere, blocked.edges[blocked.following[corner], 2:]])
    return follow_nodes(nodes, _search(nodes, before, after, blocked))


@compile_kernel
def _search(nodes, before, after, region):
    """Find a shortest path from node 0 to node 1 by A*; return its nodes, none if there is no path.

    Pairs are tested only when needed: the edges from a node to all others wait in a heap, and each
    is tested once it is the most promising.

    before, after: (n, 2) the neighbours of a corner along the boundary; the node itself where a
        path may turn in any direction.
    """
    came_by = np.full(len(nodes), -1)
    settled = np.zeros(len(nodes), np.bool_)
    # The straight distance to the target is never more than what is left, so the first path that
    # settles the target is a shortest one.
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
            if (
                _is_crossing_any(nodes[tail], nodes[i], region.edges, region.bins)
                or find_first_collision(segment, region)[0] < math.inf
            ):
                continue
        settled[i] = True
        came_by[i] = tail
        if i == 1:
            return trace_back(came_by, 1, length)
        turn = _turn_at(nodes, tail, i, before, after)
        for j in range(len(nodes)):
            if settled[j]:
                continue
            if not (_is_taut(nodes, i, j, before, after) and _is_taut(nodes, j, i, before, after)):
                continue
            if turn and turn * _offset(nodes[tail], nodes[i], nodes[j]) < -TOLERANCE:
                continue
            so_far = length + measure_distance(nodes[i], nodes[j])
            heapq.heappush(heap, (so_far + ahead[j], so_far, i, j))
    return np.empty(0, np.int64)


@allocation_free
def _turn_at(nodes: np.ndarray, tail: int, i: int, before: np.ndarray, after: np.ndarray) -> int:
    """Return to which side a shortest path turns at corner i, where the obstacle is: to the left
    (1), to the right (-1), or both (0).
    """
    if tail < 0:
        return 0
    one, other = _offset(nodes[tail], nodes[i], before[i]), _offset(nodes[tail], nodes[i], after[i])
    return int(max(one, other) > TOLERANCE) - int(min(one, other) < -TOLERANCE)


@allocation_free
def _is_taut(nodes: np.ndarray, i: int, j: int, before: np.ndarray, after: np.ndarray) -> bool:
    """Tell whether a shortest path can turn at corner i on its way to or from j: the corner lies on
    one side of the line.
    """
    x, y = nodes[i, 0], nodes[i, 1]
    dx, dy = nodes[j, 0] - x, nodes[j, 1] - y
    turn_before = dx * (before[i, 1] - y) - dy * (before[i, 0] - x)
    turn_after = dx * (after[i, 1] - y) - dy * (after[i, 0] - x)
    # Most corners are refused here, without a root or a division.
    clearly = 2.0 * TOLERANCE * (abs(dx) + abs(dy))
    if min(turn_before, turn_after) < -clearly and max(turn_before, turn_after) > clearly:
        return False
    length = math.hypot(dx, dy)
    return length == 0.0 or not _is_apart(turn_before / length, turn_after / length)


@allocation_free
def _is_crossing_any(a: np.ndarray, b: np.ndarray, edges: np.ndarray, bins: Bins) -> bool:
    """Tell whether a segment crosses an edge strictly; mere touching is left to the certified
    check.

    Edges near its beginning come first.
    """
    left, right, bottom, top = min(a[0], b[0]), max(a[0], b[0]), min(a[1], b[1]), max(a[1], b[1])
    begin, end = columns_between(left, right, bins)
    for step in range(end - begin + 1):
        column = begin + step if b[0] >= a[0] else end - step
        low, high = rows_between(a, b, column, bins)
        for step_y in range(high - low + 1):
            row = low + step_y if b[1] >= a[1] else high - step_y
            for e in list_members(column, row, row, bins):
                beside = (
                    max(edges[e, 0], edges[e, 2]) < left or min(edges[e, 0], edges[e, 2]) > right
                )
                beside |= (
                    max(edges[e, 1], edges[e, 3]) < bottom or min(edges[e, 1], edges[e, 3]) > top
                )
                if not beside and _is_crossing(a, b, edges[e, :2], edges[e, 2:]):
                    return True
    return False


@allocation_free
def _is_crossing(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> bool:
    """Tell whether two segments cross strictly."""
    return _is_apart(_offset(a, b, c), _offset(a, b, d)) and _is_apart(
        _offset(c, d, a), _offset(c, d, b)
    )


@allocation_free
def _is_apart(first: float, second: float) -> bool:
    """Tell whether two offsets lie strictly on opposite sides of a line."""
    return min(first, second) < -TOLERANCE and max(first, second) > TOLERANCE


@allocation_free
def _offset(a: np.ndarray, b: np.ndarray, point: np.ndarray) -> float:
    """Return the distance of a point from the line through a and b, positive on its left.

    It is 0 if a equals b.
    """
    length = measure_distance(a, b)
    return 0.0 if length == 0.0 else compute_doubled_area(a, b, point) / length
