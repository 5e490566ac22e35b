"""Shortest paths around circles: graphs of tangents, of no more circles than are in the way."""

import itertools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bezierplan.geometry.checker import TOLERANCE, find_first_collision
from bezierplan.geometry.checker.hulls import measure_distance, measure_distance_to_segment
from bezierplan.geometry.region import CircleRegion
from bezierplan.geometry.shortest_paths.graph import Bound, build_matrix, dijkstra_path, no_path
from bezierplan.kernels import compile_kernel
from bezierplan.workspaces.problem import Problem

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# The polyline along arcs is at most this much longer than they are, in units.
POLYLINE_EXCESS = 1e-6

# A polyline around an arc is refined at most this many times to keep clear of a neighbouring
# circle.
_REFINEMENTS = 20

# Arcs that overlap by less than this angle count as touching.
_SAME_ANGLE = 1e-8

# Ways that are longer than the shortest by at most this share are kept: rounding may decide.
_TIED = 1e-9

# A circle that is farther away from a path, as a share of its length, does not touch it: a way
# around that circle as well would be longer by more than `_TIED`.
_BESIDE = 1e-4


class _Scene(NamedTuple):
    """Start and target, as circles without a radius, and circles in the way.

    centres: (n, 2), start and target first.
    radii: (n,).
    bounds: (4,) of the border.
    """

    centres: np.ndarray
    radii: np.ndarray
    bounds: np.ndarray


class _Nodes(NamedTuple):
    """Start, target, and ends of tangents.

    circles: (n,) the circle of the scene that a node lies on.
    angles: (n,) its angle there.
    names: (n,) ascending numbers.
    points: (n, 2).
    """

    circles: np.ndarray
    angles: np.ndarray
    names: np.ndarray
    points: np.ndarray


class _Graph(NamedTuple):
    """Nodes, and the free tangents and arcs between them.

    ends: (e, 2) nodes; an arc leads counterclockwise from the first to the second.
    sweeps: (e,) angles of arcs, 0 of tangents.
    lengths: (e,).
    """

    nodes: _Nodes
    ends: np.ndarray
    sweeps: np.ndarray
    lengths: np.ndarray


def shortest_around_circles(problem: Problem, blocked: CircleRegion) -> Bound:
    """Find the shortest path around circles.

    The shortest path among some of the circles is the shortest among all if it is clear of the
    others. So the search begins without circles and adds those that the path meets, until there are
    no more.

    But the ends of all tangents cut the arcs, so that the sum of their lengths has the bits of the
    graph of all circles.
    """
    outer = _is_outer(blocked.centres, blocked.radii)
    scene = _Scene(
        np.concatenate([problem.ends, blocked.centres[outer]]),
        np.concatenate([np.zeros(2), blocked.radii[outer]]),
        blocked.bounds,
    )
    known = np.arange(2)
    while True:
        among = scene._replace(centres=scene.centres[known], radii=scene.radii[known])
        graph = _build_graph(np.arange(2, len(known)), among, whole=False)
        length, tied = _find_ties(graph)
        if math.isinf(length):
            return no_path()
        tail, head = graph.ends[tied].T
        # An arc lies within its own height of its chord.
        height = among.radii[graph.nodes.circles[tail]] * (1 - np.cos(0.5 * graph.sweeps[tied]))
        points = graph.nodes.points
        gaps = _measure_gaps(points[tail], points[head], height + _BESIDE * length, scene)
        gaps[known] = math.inf
        met = np.count_nonzero(gaps <= 0)
        if met == 0:
            break
        # As many of the nearest come along as are known: a wall of circles is not met one by one.
        known = np.union1d(known, np.argsort(gaps)[: max(met, len(known))])
    passed = known[np.unique(graph.nodes.circles[graph.ends[tied]])]
    return _find_shortest(_build_graph(passed[passed > 1], scene, whole=True), scene, blocked)


def _find_shortest(graph: _Graph, scene: _Scene, blocked: CircleRegion) -> Bound:
    """Find the shortest path from node 0 to node 1."""
    path = dijkstra_path(_build_matrix(graph))
    near = np.flatnonzero(np.isin(graph.ends, path).all(axis=1))
    edge_of = {tuple(ends): edge for edge, ends in zip(near, graph.ends[near].tolist())}
    taken, sweeps = [], []
    for a, b in itertools.pairwise(path.tolist()):
        forth = (a, b) in edge_of
        edge = edge_of[(a, b) if forth else (b, a)]
        taken.append(edge)
        sweeps.append(graph.sweeps[edge] if forth else -graph.sweeps[edge])
    on_circle = graph.nodes.circles[path]
    return Bound(
        math.fsum(graph.lengths[taken]),
        _circumscribe(graph.nodes.points[path], on_circle, sweeps, scene, blocked),
    )


def _build_graph(circles: np.ndarray, scene: _Scene, whole: bool) -> _Graph:
    """Build the free tangents and arcs of some circles (m,) of a scene, ascending.

    whole: cut the arcs at the ends of all their tangents, and not only of the free ones.
    """
    nodes = _list_nodes(circles, scene)
    tangents = _list_tangents(nodes, len(scene.radii))
    begin, end = nodes.points[tangents].transpose(1, 0, 2)
    tangents = tangents[_find_free(begin, end, scene)]
    if not whole:
        used = np.union1d([0, 1], tangents)
        nodes = _Nodes(*(column[used] for column in nodes))
        tangents = np.searchsorted(used, tangents)
    arcs, sweeps = _list_free_arcs(nodes, scene)
    ends = np.concatenate([tangents, arcs])
    straight = np.hypot(*(nodes.points[tangents[:, 1]] - nodes.points[tangents[:, 0]]).T)
    lengths = np.concatenate([straight, scene.radii[nodes.circles[arcs[:, 0]]] * sweeps])
    kept = _shortest_between(ends, lengths)
    sweeps = np.concatenate([np.zeros(len(tangents)), sweeps])
    return _Graph(nodes, ends[kept], sweeps[kept], lengths[kept])


def _find_ties(graph: _Graph) -> tuple[float, np.ndarray]:
    """Return the length of the shortest way from node 0 to node 1, and which edges (e,) are part of
    it.

    Edges of a way that is as long but for `_TIED` are among them.
    """
    from scipy.sparse.csgraph import dijkstra

    from_start, from_target = dijkstra(_build_matrix(graph), directed=False, indices=[0, 1])
    tail, head = graph.ends.T
    through = graph.lengths + np.minimum(
        from_start[tail] + from_target[head], from_start[head] + from_target[tail]
    )
    return from_start[1], through <= from_start[1] * (1 + _TIED)


def _build_matrix(graph: _Graph) -> "csr_array":
    """Return the lengths of edges by their ends, as a sparse matrix."""
    return build_matrix(graph.lengths, graph.ends.T, len(graph.nodes.names))


@compile_kernel
def _is_outer(centres: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Tell which circles (n,) do not lie inside another; the first of equal circles does not."""
    outer = np.ones(len(radii), np.bool_)
    for i in range(len(radii)):
        for j in range(len(radii)):
            if i == j or radii[i] > radii[j]:
                continue
            distance = measure_distance(centres[i], centres[j])
            if distance + radii[i] <= radii[j]:
                outer[i] &= distance + radii[j] <= radii[i] and i < j
    return outer


def _list_nodes(circles: np.ndarray, scene: _Scene) -> _Nodes:
    """List start, target, and the ends of all tangents at some circles (m,), ascending."""
    parts = [(np.zeros(2), np.arange(2), scene.centres[:2])]
    for circle in circles.tolist():
        # Python's own `hypot` is a last bit more exact than that of kernels.
        step = (scene.centres - scene.centres[circle]).T.tolist()
        parts.append(_list_nodes_at(circle, np.array(list(map(math.hypot, *step))), scene))
    angles, names, points = map(np.concatenate, zip(*parts))
    on_circle = names // (4 * len(scene.radii))
    # Start and target are named 0 and 1, so the division takes both for circle 0.
    on_circle[1] = 1
    return _Nodes(on_circle, angles, names, points)


@compile_kernel
def _list_nodes_at(
    circle: int, distances: np.ndarray, scene: _Scene
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """List the ends of all tangents at a circle: angles (n,), names (n,) and points (n, 2).

    distances: (m,) of the circles' centres. A name tells the circle, the other one or the end to
        which the tangent leads, whether it crosses the line between their centres, and its side of
        it.
    """
    centres, radii = scene.centres, scene.radii
    count = 0
    angles, names = np.empty(4 * len(radii)), np.empty(4 * len(radii), np.int64)
    points = np.empty((4 * len(radii), 2))
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
                angle = towards + side * half + opposite
                angles[count] = angle
                names[count] = 4 * (circle * len(radii) + neighbour) + 2 * crossing + (side > 0)
                points[count, 0] = centres[circle, 0] + radii[circle] * math.cos(angle)
                points[count, 1] = centres[circle, 1] + radii[circle] * math.sin(angle)
                count += 1
    return angles[:count], names[:count], points[:count]


def _list_tangents(nodes: _Nodes, count: int) -> np.ndarray:
    """List the pairs of nodes that a tangent joins, free or not, among so many circles: (t, 2)."""
    other, kind = nodes.names // 4 % count, nodes.names % 4
    name = np.where(other < 2, other, 4 * (other * count + nodes.circles) + kind)
    number = np.arange(len(name))
    found = np.minimum(np.searchsorted(nodes.names, name), number)
    # Start and target are joined too: the name of target's node leads to start.
    joined = (nodes.names[found] == name) & (found < number)
    return np.column_stack([found, number])[joined]


@compile_kernel
def _find_free(begin: np.ndarray, end: np.ndarray, scene: _Scene) -> np.ndarray:
    """Tell which segments, from points (n, 2) to points (n, 2), are free: bool (n,)."""
    left, right, bottom, top = scene.bounds
    free = np.empty(len(begin), np.bool_)
    for i in range(len(begin)):
        (ax, ay), (bx, by) = begin[i], end[i]
        free[i] = (
            min(ax, bx) >= left - TOLERANCE
            and max(ax, bx) <= right + TOLERANCE
            and min(ay, by) >= bottom - TOLERANCE
            and max(ay, by) <= top + TOLERANCE
        )
        for k in range(len(scene.radii)):
            if not free[i]:
                break
            x, y = scene.centres[k]
            free[i] = (
                measure_distance_to_segment(x, y, ax, ay, bx, by) >= scene.radii[k] - TOLERANCE
            )
    return free


@compile_kernel
def _measure_gaps(
    begin: np.ndarray, end: np.ndarray, width: np.ndarray, scene: _Scene
) -> np.ndarray:
    """Return how far circles (m,) lie from segments, at most 0 where they meet one.

    Segments lead from points (n, 2) to points (n, 2) and reach to both sides by a width (n,).
    """
    gaps = np.full(len(scene.radii), np.inf)
    for k in range(len(gaps)):
        x, y = scene.centres[k]
        for i in range(len(begin)):
            (ax, ay), (bx, by) = begin[i], end[i]
            gap = measure_distance_to_segment(x, y, ax, ay, bx, by) - scene.radii[k] - width[i]
            gaps[k] = min(gaps[k], gap)
    return gaps


def _list_free_arcs(nodes: _Nodes, scene: _Scene) -> tuple[np.ndarray, np.ndarray]:
    """List free arcs between neighbouring nodes of a circle, counterclockwise: node pairs (n, 2)
    and angles (n,).
    """
    pairs, sweeps = [np.empty((0, 2), np.int64)], [np.empty(0)]
    for circle in np.unique(nodes.circles)[2:].tolist():
        first, end = np.searchsorted(nodes.circles, [circle, circle + 1])
        angles = nodes.angles[first:end] % math.tau
        order = np.argsort(angles)
        number, begin = order + first, angles[order]
        sweep = np.diff(begin, append=begin[0] + math.tau)
        middle, half = _find_covered_angles(circle, scene)
        after = (middle - begin[:, None]) % math.tau
        overlap = np.full(after.shape, -math.inf)
        for turn in (-math.tau, 0.0, math.tau):
            shared = np.minimum(sweep[:, None], after + turn + half) - np.maximum(
                0, after + turn - half
            )
            overlap = np.maximum(overlap, shared)
        free = (overlap <= _SAME_ANGLE).all(axis=1)
        pairs.append(np.column_stack([number, np.roll(number, -1)])[free])
        sweeps.append(sweep[free])
    return np.concatenate(pairs), np.concatenate(sweeps)


def _shortest_between(ends: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Return the indices of the edges that are the shortest between their two nodes.

    Sparse matrices would sum duplicate edges.
    """
    low, high = np.sort(ends, axis=1).T
    order = np.lexsort([lengths, high, low])
    first = (np.diff(low[order], prepend=-1) != 0) | (np.diff(high[order], prepend=-1) != 0)
    return order[first]


def _find_covered_angles(k: int, scene: _Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return the parts of a circle in other circles or outside the border, by middle and
    half-width.
    """
    centres, radii = scene.centres, scene.radii
    radius = radii[k]
    others = np.delete(np.arange(2, len(radii)), k - 2)
    step, other = centres[others] - centres[k], radii[others]
    distance = np.hypot(*step.T)
    meets = distance < radius + other - TOLERANCE
    step, other, distance = step[meets], other[meets], distance[meets]
    cosine = (distance**2 + radius**2 - other**2) / (2 * distance * radius)
    left, right, bottom, top = scene.bounds
    x, y = centres[k]
    margin = np.array([right - x, top - y, x - left, y - bottom]) / radius
    outward = np.array([0.0, 0.5, 1.0, 1.5]) * math.pi
    middle = np.concatenate([np.arctan2(step[:, 1], step[:, 0]), outward[margin < 1]])
    return middle, np.arccos(np.clip(np.concatenate([cosine, margin[margin < 1]]), -1, 1))


def _circumscribe(
    points: np.ndarray,
    circles: np.ndarray,
    sweeps: list[float],
    scene: _Scene,
    blocked: CircleRegion,
) -> np.ndarray:
    """Draw the polyline (n, 2) along a path of straight pieces (sweep 0) and arcs: around the arcs,
    fine enough to be free.
    """
    centres, radii = scene.centres, scene.radii
    runs: list[tuple[int, float, int]] = []
    # The ends of all tangents have cut the arcs; joined again, these need fewer corners.
    for node, sweep in enumerate(sweeps):
        if runs and sweep * runs[-1][1] > 0:
            runs[-1] = (runs[-1][0], runs[-1][1] + sweep, node + 1)
        else:
            runs.append((node, sweep, node + 1))
    arc_length = sum(abs(sweep) * radii[circles[node]] for node, sweep, _ in runs if sweep)
    # Tangents at angles of `step` are longer than the arc by a share of step**2 / 12.
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
                # Corners of tangents, not points of the arc: chords between those would cut the
                # circle.
                reach = radii[circle] / math.cos(0.5 * sweep / parts)
                polyline.append(
                    centres[circle] + reach * np.column_stack([np.cos(middles), np.sin(middles)])
                )
            polyline.append(points[end : end + 1])
        line = np.concatenate(polyline)
        if find_first_collision(np.stack([line[:-1], line[1:]], axis=1), blocked)[0] == math.inf:
            break
        # Those corners stand out, and may enter a circle that touches this one; finer ones less.
        step *= 0.5
    return line
