"""Shortest paths around circles: the tangent graph."""

import math
from typing import NamedTuple

import numpy as np

from bezierplan.geometry.checker import TOLERANCE, check
from bezierplan.geometry.region import CircleRegion
from bezierplan.geometry.shortest_paths.graph import NO_LENGTH, Bound, dijkstra_path, no_path
from bezierplan.kernels import compiled
from bezierplan.workspaces.problem import Problem

# The polyline along arcs is at most this much longer than they are, in units.
POLYLINE_EXCESS = 1e-6

# Arcs that overlap by less than this angle count as touching.
_SAME_ANGLE = 1e-8

# A polyline around an arc is refined at most this many times to keep clear of a neighbouring
# circle.
_REFINEMENTS = 20


def shortest_around_circles(problem: Problem, blocked: CircleRegion) -> Bound:
    """The tangent graph: start, target, and the ends of all common tangents, joined by tangents and
    by the arcs between them.
    """
    from scipy.sparse import coo_array

    centres, radii = _outer_circles(blocked)
    tangents = _tangents(problem, centres, radii)
    points, on_circle = np.array(tangents.points), np.array(tangents.circles)
    pairs = np.array(tangents.pairs)
    pairs = pairs[
        _straight_is_free(points[pairs[:, 0]], points[pairs[:, 1]], centres, radii, blocked.bounds)
    ]
    arcs, angles = _free_arcs(tangents, centres, radii, blocked.bounds)

    tail, head = np.concatenate([pairs, arcs]).T
    sweep = np.concatenate([np.zeros(len(pairs)), angles])
    straight = np.hypot(*(points[pairs[:, 1]] - points[pairs[:, 0]]).T)
    length = np.concatenate([straight, radii[on_circle[arcs[:, 0]]] * angles])
    kept = _shortest_between(tail, head, length)
    tail, head, sweep, length = tail[kept], head[kept], sweep[kept], length[kept]
    graph = coo_array(
        (np.maximum(length, NO_LENGTH), (tail, head)), shape=(len(points), len(points))
    ).tocsr()
    _, nodes = dijkstra_path(graph, 0, 1)
    if not len(nodes):
        return no_path()

    edge_of = {pair: edge for edge, pair in enumerate(zip(tail.tolist(), head.tolist()))}
    steps = list(zip(nodes[:-1].tolist(), nodes[1:].tolist()))
    used = [edge_of.get((a, b), edge_of.get((b, a))) for a, b in steps]
    # An arc is stored counterclockwise.
    sweeps = [sweep[edge] if tail[edge] == a else -sweep[edge] for edge, (a, _) in zip(used, steps)]
    return Bound(
        math.fsum(length[used]),
        _circumscribed(points[nodes], on_circle[nodes], sweeps, centres, radii, blocked),
    )


class _Tangents(NamedTuple):
    """Nodes of a tangent graph and the pairs joined by a straight line, not yet tested.

    points: positions (x, y). circles: the circle that a node lies on, -1 for start and target.
    angles: its angle there. pairs: two nodes.
    """

    points: list[tuple[float, float]]
    circles: list[int]
    angles: list[float]
    pairs: list[tuple[int, int]]

    def add(self, centre: np.ndarray, radius: float, circle: int, angle: float) -> int:
        """Add a node on a circle and return its number."""
        self.points.append(
            (centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle))
        )
        self.circles.append(circle)
        self.angles.append(angle % math.tau)
        return len(self.points) - 1


def _shortest_between(tail: np.ndarray, head: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Indices of the edges that are the shortest between their two nodes. Sparse matrices would sum
    duplicate edges.
    """
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    order = np.lexsort([length, high, low])
    first = (np.diff(low[order], prepend=-1) != 0) | (np.diff(high[order], prepend=-1) != 0)
    return order[first]


def _outer_circles(blocked: CircleRegion) -> tuple[np.ndarray, np.ndarray]:
    """Centres and radii of the circles that do not lie inside another; of equal circles only the
    first.
    """
    centres, radii = blocked.centres, blocked.radii
    distance = np.hypot(*(centres[:, None] - centres[None]).transpose(2, 0, 1))
    inside = distance + radii[:, None] <= radii[None]
    number = np.arange(len(radii))
    dropped = (inside & (~inside.T | (number[:, None] > number[None]))).any(axis=1)
    return centres[~dropped], radii[~dropped]


def _tangents(problem: Problem, centres: np.ndarray, radii: np.ndarray) -> _Tangents:
    """Nodes 0 and 1 are start and target. Where one of them lies on a circle, a node of the circle
    has the same position.
    """
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


@compiled
def _straight_is_free(
    a: np.ndarray, b: np.ndarray, centres: np.ndarray, radii: np.ndarray, bounds: np.ndarray
) -> np.ndarray:
    """Which segments from a to b, both (n, 2), are free: bool (n,). Most are blocked by one of the
    first circles that are looked at.
    """
    free = np.empty(len(a), dtype=np.bool_)
    left, right, bottom, top = (
        bounds[0] - TOLERANCE,
        bounds[1] + TOLERANCE,
        bounds[2] - TOLERANCE,
        bounds[3] + TOLERANCE,
    )
    for i in range(len(a)):
        (x, y), (end_x, end_y) = a[i], b[i]
        step_x, step_y = end_x - x, end_y - y
        square = max(step_x * step_x + step_y * step_y, NO_LENGTH)
        free[i] = (
            min(x, end_x) >= left
            and max(x, end_x) <= right
            and min(y, end_y) >= bottom
            and max(y, end_y) <= top
        )
        for k in range(len(radii)):
            if not free[i]:
                break
            share = ((centres[k, 0] - x) * step_x + (centres[k, 1] - y) * step_y) / square
            share = min(max(share, 0.0), 1.0)
            distance = math.hypot(
                x + share * step_x - centres[k, 0], y + share * step_y - centres[k, 1]
            )
            free[i] = distance >= radii[k] - TOLERANCE
    return free


def _free_arcs(
    tangents: _Tangents, centres: np.ndarray, radii: np.ndarray, bounds: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Arcs between neighbouring nodes of a circle, counterclockwise: node pairs (n, 2) and angles
    (n,).
    """
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
            shared = np.minimum(sweep[:, None], after + turn + half) - np.maximum(
                0, after + turn - half
            )
            overlap = np.maximum(overlap, shared)
        free = (overlap <= _SAME_ANGLE).all(axis=1)
        pairs.append(np.column_stack([nodes, np.roll(nodes, -1)])[free])
        sweeps.append(sweep[free])
    return np.concatenate(pairs), np.concatenate(sweeps)


def _covered_angles(
    k: int, centres: np.ndarray, radii: np.ndarray, bounds: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Parts of a circle that lie in other circles or outside the border: middle and half-width of
    each angular interval.
    """
    radius = radii[k]
    step = np.delete(centres - centres[k], k, axis=0)
    other = np.delete(radii, k)
    distance = np.hypot(step[:, 0], step[:, 1])
    meets = distance < radius + other - TOLERANCE
    step, other, distance = step[meets], other[meets], distance[meets]
    cosine = (distance**2 + radius**2 - other**2) / (2 * distance * radius)
    left, right, bottom, top = bounds
    margin = (
        np.array(
            [
                right - centres[k, 0],
                top - centres[k, 1],
                centres[k, 0] - left,
                centres[k, 1] - bottom,
            ]
        )
        / radius
    )
    outward = np.array([0.0, 0.5, 1.0, 1.5]) * math.pi
    middle = np.concatenate([np.arctan2(step[:, 1], step[:, 0]), outward[margin < 1]])
    return middle, np.arccos(np.clip(np.concatenate([cosine, margin[margin < 1]]), -1, 1))


def _circumscribed(
    points: np.ndarray,
    circles: np.ndarray,
    sweeps: list[float],
    centres: np.ndarray,
    radii: np.ndarray,
    blocked: CircleRegion,
) -> np.ndarray:
    """The polyline (n, 2) along a path of straight pieces (sweep 0) and arcs: around the arcs, fine
    enough to be free.
    """
    runs: list[tuple[int, float, int]] = []
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
                middles = math.atan2(from_centre[1], from_centre[0]) + sweep / parts * (
                    np.arange(parts) + 0.5
                )
                reach = radii[circle] / math.cos(0.5 * sweep / parts)
                polyline.append(
                    centres[circle] + reach * np.column_stack([np.cos(middles), np.sin(middles)])
                )
            polyline.append(points[end : end + 1])
        line = np.concatenate(polyline)
        if check(np.stack([line[:-1], line[1:]], axis=1), blocked).feasible:
            break
        step *= 0.5
    return line
