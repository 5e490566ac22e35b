"""Shortest paths around circles: the tangent graph, or what of it a shortest path can need."""

import math
from typing import NamedTuple

import numpy as np

from bezierplan.geometry.bins import Bins, bins_of_discs
from bezierplan.geometry.checker import TOLERANCE, first_collision
from bezierplan.geometry.region import CircleRegion
from bezierplan.geometry.shortest_paths.graph import NO_LENGTH, Bound, dijkstra_path, no_path
from bezierplan.geometry.shortest_paths.tangents import SAME_ANGLE, Scene, circles_beside, search
from bezierplan.kernels import allocation_free, compiled
from bezierplan.workspaces.problem import Problem

# The polyline along arcs is at most this much longer than they are, in units.
POLYLINE_EXCESS = 1e-6

# What lies within this angle of an arc's ends is counted as part of it.
_END_OF_ARC = 1e-6

# A polyline around an arc is refined at most this many times to keep clear of a neighbouring
# circle.
_REFINEMENTS = 20


def shortest_around_circles(problem: Problem, blocked: CircleRegion) -> Bound:
    """The tangent graph: start, target, and the ends of all common tangents, joined by tangents and
    by the arcs between them.

    A search finds what of it a shortest path can need, and the rest is left out. But the ends of
    all tangents cut the arcs, so that the sum of their lengths has the bits of the whole graph.
    """
    from scipy.sparse import coo_array

    bins = bins_of_discs(blocked.centres, blocked.radii, blocked.bounds)
    outer = _is_outer(blocked.centres, blocked.radii, bins)
    centres = np.concatenate([[problem.start, problem.target], blocked.centres[outer]])
    radii = np.concatenate([np.zeros(2), blocked.radii[outer]])
    scene = Scene(centres, radii, blocked.bounds, bins_of_discs(centres, radii, blocked.bounds))
    tangents, ways = search(scene)
    if not len(tangents):
        return no_path()
    nodes = _nodes(np.unique(tangents[:, [0, 2]]), scene)
    pairs = _pairs(tangents, nodes, scene)
    arcs, angles = _free_arcs(nodes, ways, scene)

    # The nodes of the graph, start and target first, and the ends of its edges among them.
    used, ends = np.unique(np.concatenate([[[0, 1]], pairs, arcs]), return_inverse=True)
    tail, head = ends.reshape(-1, 2)[1:].T
    on_circle = nodes.circles[used]
    points = _points(on_circle, nodes.angles[used], scene)
    sweep = np.concatenate([np.zeros(len(pairs)), angles])
    straight = np.hypot(*(points[head[: len(pairs)]] - points[tail[: len(pairs)]]).T)
    length = np.concatenate([straight, radii[on_circle[tail[len(pairs) :]]] * angles])
    kept = _shortest_between(tail, head, length)
    tail, head, sweep, length = tail[kept], head[kept], sweep[kept], length[kept]
    graph = coo_array(
        (np.maximum(length, NO_LENGTH), (tail, head)), shape=(len(points), len(points))
    ).tocsr()
    _, path = dijkstra_path(graph, 0, 1)

    edge_of = {pair: edge for edge, pair in enumerate(zip(tail.tolist(), head.tolist()))}
    steps = list(zip(path[:-1].tolist(), path[1:].tolist()))
    taken = [edge_of.get((a, b), edge_of.get((b, a))) for a, b in steps]
    # An arc is stored counterclockwise.
    sweeps = [
        sweep[edge] if tail[edge] == a else -sweep[edge] for edge, (a, _) in zip(taken, steps)
    ]
    return Bound(
        math.fsum(length[taken]),
        _circumscribed(points[path], on_circle[path], sweeps, scene, blocked, bins),
    )


@compiled
def _is_outer(centres: np.ndarray, radii: np.ndarray, bins: Bins) -> np.ndarray:
    """Which circles do not lie inside another; of equal circles only the first: bool (n,)."""
    outer = np.ones(len(radii), dtype=np.bool_)
    for i in range(len(radii)):
        column = int((centres[i, 0] - bins.low[0]) // bins.side)
        row = int((centres[i, 1] - bins.low[1]) // bins.side)
        place = column * bins.rows + row
        for j in bins.members[bins.first[place] : bins.first[place + 1]]:
            distance = math.hypot(centres[i, 0] - centres[j, 0], centres[i, 1] - centres[j, 1])
            if i != j and distance + radii[i] <= radii[j]:
                outer[i] &= distance + radii[j] <= radii[i] and i < j
    return outer


class _Nodes(NamedTuple):
    """Start, target, and the ends of all tangents at some circles, each with a name.

    circles: (n,) the circle of the scene that a node lies on. angles: (n,) its angle there. names:
    (n,) ascending numbers.
    """

    circles: np.ndarray
    angles: np.ndarray
    names: np.ndarray


def _nodes(circles: np.ndarray, scene: Scene) -> _Nodes:
    """The nodes at some circles (m,), ascending; the first two are start and target."""
    parts = []
    for circle in circles[circles > 1].tolist():
        # Python's own `hypot` is a last bit more exact than that of kernels.
        step = (scene.centres - scene.centres[circle]).T.tolist()
        parts.append(_nodes_at(circle, np.array(list(map(math.hypot, *step))), scene))
    angles = np.concatenate([[0.0, 0.0], *(part[0] for part in parts)])
    names = np.concatenate([[0, 1], *(part[1] for part in parts)])
    circles = names // (4 * len(scene.radii))
    circles[1] = 1
    return _Nodes(circles, angles, names)


@allocation_free
def _name(circle: int, other: int, crossing: bool, side: int, count: int) -> int:
    """The name of a node at one of `count` circles: the end of a tangent to another, or to an end,
    that is `crossing` the line between their centres or not, and on one side of it (1 or -1).
    """
    return ((circle * count + other) * 2 + int(crossing)) * 2 + int(side > 0)


@compiled
def _nodes_at(circle: int, distances: np.ndarray, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """The ends of all tangents at a circle: angles (n,) and names (n,). distances: of all
    circles' centres, (m,).
    """
    centres, radii = scene.centres, scene.radii
    count = 0
    angles, names = np.empty(4 * len(radii)), np.empty(4 * len(radii), dtype=np.int64)
    for neighbour in range(len(radii)):
        if neighbour == circle:
            continue
        # Of two circles, the tangents are computed from the first: rounding may depend on it.
        i, j = (circle, neighbour) if circle < neighbour or neighbour < 2 else (neighbour, circle)
        dx, dy = centres[j, 0] - centres[i, 0], centres[j, 1] - centres[i, 1]
        distance = distances[neighbour]
        towards = math.atan2(dy, dx)
        for crossing in range(1 if neighbour < 2 else 2):
            opposite = 0.0
            if neighbour < 2:
                half = 0.0
                if distance > radii[i] + TOLERANCE:
                    half = math.acos(radii[i] / distance)
            elif crossing:
                if distance < radii[i] + radii[j] - TOLERANCE:
                    continue
                half = math.acos(min(1.0, (radii[i] + radii[j]) / distance))
                opposite = math.pi if circle == j else 0.0
            else:
                if distance <= abs(radii[i] - radii[j]):
                    continue
                half = math.acos((radii[i] - radii[j]) / distance)
            for side in range(-1, 2, 2):
                if neighbour < 2 and half == 0.0 and side < 0:
                    continue
                angles[count] = towards + side * half + opposite
                names[count] = _name(circle, neighbour, crossing == 1, side, len(radii))
                count += 1
    return angles[:count], names[:count]


@compiled
def _points(circles: np.ndarray, angles: np.ndarray, scene: Scene) -> np.ndarray:
    """The points (n, 2) at some angles of circles."""
    points = np.empty((len(circles), 2))
    for i in range(len(circles)):
        k = circles[i]
        points[i, 0] = scene.centres[k, 0] + scene.radii[k] * math.cos(angles[i])
        points[i, 1] = scene.centres[k, 1] + scene.radii[k] * math.sin(angles[i])
    return points


def _pairs(tangents: np.ndarray, nodes: _Nodes, scene: Scene) -> np.ndarray:
    """The two nodes that each tangent (t, 4) joins, as `search` gives it: (p, 2)."""
    names = []
    for a, sense, b, other_sense in tangents.tolist():
        crossing = sense != other_sense and min(a, b) > 1
        # A path leaves a circle to the right of the line to the other centre if it turns left.
        seen_from = min(a, b) if min(a, b) > 1 else max(a, b)
        side = -sense if seen_from == a else other_sense
        names.append(
            [
                one if one < 2 else _name(one, other, crossing, side, len(scene.radii))
                for one, other in sorted([(a, b), (b, a)])
            ]
        )
    # An end on a circle has one node there, whichever side was asked for.
    return np.unique(np.searchsorted(nodes.names, names), axis=0)


def _free_arcs(nodes: _Nodes, ways: np.ndarray, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Free arcs between neighbouring nodes of a circle, counterclockwise, that some ways (w, 3)
    around circles need, as `search` gives them: node pairs (n, 2) and angles (n,).
    """
    pairs, sweeps = [np.empty((0, 2), dtype=np.int64)], [np.empty(0)]
    for circle in np.unique(ways[:, 0]).astype(int).tolist():
        if circle < 2:
            continue
        first, end = np.searchsorted(nodes.circles, [circle, circle + 1])
        angles = nodes.angles[first:end] % math.tau
        order = np.argsort(angles)
        number, begin = order + first, angles[order]
        sweep = np.diff(begin, append=begin[0] + math.tau)
        _, way_begin, way_sweep = ways[ways[:, 0] == circle, :, None].transpose(1, 0, 2)
        needed = ((begin - way_begin + _END_OF_ARC) % math.tau <= way_sweep + 2 * _END_OF_ARC).any(
            axis=0
        )
        middle, half = _covered_angles(circle, scene)
        after = (middle - begin[needed, None]) % math.tau
        overlap = np.full(after.shape, -math.inf)
        for turn in (-math.tau, 0.0, math.tau):
            shared = np.minimum(sweep[needed, None], after + turn + half) - np.maximum(
                0, after + turn - half
            )
            overlap = np.maximum(overlap, shared)
        needed[needed] = (overlap <= SAME_ANGLE).all(axis=1)
        pairs.append(np.column_stack([number, np.roll(number, -1)])[needed])
        sweeps.append(sweep[needed])
    return np.concatenate(pairs), np.concatenate(sweeps)


def _shortest_between(tail: np.ndarray, head: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Indices of the edges that are the shortest between their two nodes. Sparse matrices would sum
    duplicate edges.
    """
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    order = np.lexsort([length, high, low])
    first = (np.diff(low[order], prepend=-1) != 0) | (np.diff(high[order], prepend=-1) != 0)
    return order[first]


def _covered_angles(k: int, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Parts of a circle in other circles or outside the border: middle and half-width of each."""
    centres, radii = scene.centres, scene.radii
    radius = radii[k]
    others = np.delete(np.arange(2, len(radii)), k - 2)
    step, other = centres[others] - centres[k], radii[others]
    distance = np.hypot(step[:, 0], step[:, 1])
    meets = distance < radius + other - TOLERANCE
    step, other, distance = step[meets], other[meets], distance[meets]
    cosine = (distance**2 + radius**2 - other**2) / (2 * distance * radius)
    left, right, bottom, top = scene.bounds
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
    scene: Scene,
    blocked: CircleRegion,
    bins: Bins,
) -> np.ndarray:
    """The polyline (n, 2) along a path of straight pieces (sweep 0) and arcs: around the arcs, fine
    enough to be free.

    bins: those of the blocked circles.
    """
    centres, radii = scene.centres, scene.radii
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
        near = circles_beside(line, bins, len(blocked.radii))
        nearby = blocked._replace(centres=blocked.centres[near], radii=blocked.radii[near])
        if first_collision(np.stack([line[:-1], line[1:]], axis=1), nearby)[0] == math.inf:
            break
        step *= 0.5
    return line
