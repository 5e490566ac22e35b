"""Exact shortest paths around circles against a plain graph of all tangents, to the last bit: what
a search leaves out changes nothing.
"""

import itertools
import math

import numpy as np
import pytest
from fields import assert_is_bound
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from bezierplan.geometry.checker import TOLERANCE
from bezierplan.geometry.region import build_region, is_blocked
from bezierplan.geometry.shortest_paths import shortest_path
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem


def outer(circles):
    """Centres and radii without circles in other circles; of equal ones the first is kept."""
    table = [(x, y, r) for (x, y), r in zip(circles.centres.tolist(), circles.radii.tolist())]
    table = list(dict.fromkeys(table))
    kept = [
        one
        for one in table
        if not any(math.dist(one[:2], it[:2]) + one[2] <= it[2] for it in table if it != one)
    ]
    table = np.array(kept).reshape(-1, 3)
    return table[:, :2], table[:, 2]


def nodes_of(problem, centres, radii):
    """Positions, circles and angles of the ends of all tangents, and the pairs that they join."""
    nodes, pairs = [(*problem.start, -1, 0.0), (*problem.target, -1, 0.0)], [(0, 1)]

    def add(k, angle):
        x, y = centres[k]
        nodes.append((x + radii[k] * math.cos(angle), y + radii[k] * math.sin(angle), k, angle))
        return len(nodes) - 1

    for end, (x, y) in enumerate((problem.start, problem.target)):
        for k, ((to_x, to_y), radius) in enumerate(zip(centres, radii)):
            distance = math.hypot(x - to_x, y - to_y)
            half = 0.0 if distance <= radius + TOLERANCE else math.acos(radius / distance)
            for side in (-1, 1) if half else (1,):
                pairs.append((end, add(k, math.atan2(y - to_y, x - to_x) + side * half)))
    for i, j in itertools.combinations(range(len(radii)), 2):
        dx, dy = centres[j] - centres[i]
        distance, towards = math.hypot(dx, dy), math.atan2(dy, dx)
        tangents = []
        if distance > abs(radii[i] - radii[j]):
            tangents.append((math.acos((radii[i] - radii[j]) / distance), 0.0))
        if distance >= radii[i] + radii[j] - TOLERANCE:
            cosine = min(1.0, (radii[i] + radii[j]) / distance)
            tangents.append((math.acos(cosine), math.pi))
        for (half, opposite), side in itertools.product(tangents, (-1, 1)):
            angle = towards + side * half
            pairs.append((add(i, angle), add(j, angle + opposite)))
    x, y, circles, angles = np.array(nodes).T
    return np.column_stack([x, y]), circles, angles % math.tau, np.array(pairs)


def is_free(a, b, centres, radii, bounds):
    left, right, bottom, top = np.array(bounds) + TOLERANCE * np.array([-1, 1, -1, 1])
    x, y = np.sort([a, b], axis=0).T
    if x[0] < left or x[1] > right or y[0] < bottom or y[1] > top:
        return False
    share = (centres - a) @ (b - a) / max((b - a) @ (b - a), 1e-300)
    nearest = a + np.clip(share, 0, 1)[:, None] * (b - a)
    return (np.hypot(*(nearest - centres).T) >= radii - TOLERANCE).all()


def covered(k, centres, radii, bounds):
    """Middles and half widths of the angles at which a circle lies in others or over the border."""
    (x, y), radius, found = centres[k], radii[k], []
    for other, ((to_x, to_y), size) in enumerate(zip(centres, radii)):
        distance = math.hypot(to_x - x, to_y - y)
        if other != k and distance < radius + size - TOLERANCE:
            cosine = (distance**2 + radius**2 - size**2) / (2 * distance * radius)
            found.append((math.atan2(to_y - y, to_x - x), math.acos(np.clip(cosine, -1, 1))))
    left, right, bottom, top = bounds
    for quarters, margin in enumerate((right - x, top - y, x - left, y - bottom)):
        if margin < radius:
            found.append((quarters * math.pi / 2, math.acos(max(margin / radius, -1))))
    return np.array(found).reshape(-1, 2).T


def of_all_tangents(problem):
    """Length of the shortest path in the graph of all tangents, each arc cut at all their ends."""
    circles = problem.workspace
    centres, radii = outer(circles)
    points, on_circle, angles, pairs = nodes_of(problem, centres, radii)
    edges = {}
    for i, j in pairs.tolist():
        if is_free(points[i], points[j], centres, radii, circles.bounds):
            edges[i, j] = np.hypot(*(points[j] - points[i]))
    for k in range(len(radii)):
        nodes = np.flatnonzero(on_circle == k)
        nodes = nodes[np.argsort(angles[nodes])]
        begin = angles[nodes]
        middle, half = covered(k, centres, radii, circles.bounds)
        for i, j, at, sweep in zip(
            nodes, np.roll(nodes, -1), begin, np.diff(begin, append=begin[0] + math.tau)
        ):
            after = np.add.outer([-math.tau, 0, math.tau], (middle - at) % math.tau)
            overlap = np.minimum(sweep, after + half) - np.maximum(0, after - half)
            if (overlap <= 1e-8).all() and radii[k] * sweep < edges.get((i, j), math.inf):
                edges[i, j] = radii[k] * sweep
    tail, head = np.array(list(edges)).reshape(-1, 2).T
    length = np.maximum(list(edges.values()), 1e-300)
    graph = coo_array((length, (tail, head)), shape=(len(points), len(points))).tocsr()
    distance, before = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
    if math.isinf(distance[1]):
        return math.inf
    path = [1]
    while path[-1] != 0:
        path.append(before[path[-1]])
    return math.fsum(
        min(edges.get(pair, math.inf) for pair in (step, step[::-1]))
        for step in itertools.pairwise(path)
    )


def assert_same(problem):
    found = shortest_path(problem)
    assert found.length == of_all_tangents(problem)
    if math.isfinite(found.length):
        assert_is_bound(found, problem)
    return found


def drawn(rng, kind, count, side=10.0):
    """A problem among random circles; on a lattice they touch, overlap and line up."""
    if kind == "anywhere":
        centres, radii = rng.uniform(0, side, (count, 2)), rng.uniform(0.1, 0.9, count)
        start, target = rng.uniform(0, side, (2, 2))
    else:
        centres = rng.integers(0, 2 * side + 1, (count, 2)) / 2
        start, target = rng.integers(0, 2 * side + 1, (2, 2)) / 2
        radii = rng.choice([0.25, 0.5, 0.5, 1.0, 1.25] if kind == "lattice" else [0.5], count)
    return Problem(
        "", Circles((0.0, side, 0.0, side), centres, radii, "m"), tuple(start), tuple(target)
    )


@pytest.mark.parametrize("kind", ["anywhere", "lattice", "equal"])
def test_the_length_is_that_of_the_graph_of_all_tangents(kind):
    rng = np.random.default_rng(5)
    bends = none = 0
    for _ in range(60):
        problem = drawn(rng, kind, rng.integers(0, 25))
        blocked = build_region(problem.workspace)
        if is_blocked(blocked, problem.start) or is_blocked(blocked, problem.target):
            continue
        found = assert_same(problem)
        bends += len(found.points) > 2
        none += math.isinf(found.length)
    assert bends > 5
    assert none < 30


def test_so_it_is_in_a_field_where_most_circles_are_hidden():
    rng = np.random.default_rng(1)
    centres, radii = rng.uniform(0, 9, (81, 2)), rng.uniform(0.2, 0.35, 81)
    ends = np.array([(0.1, 0.1), (8.9, 8.9)])
    clear = (np.hypot(*(centres[:, None] - ends).T) > radii + 0.01).all(axis=0)
    circles = Circles((0.0, 9.0, 0.0, 9.0), centres[clear], radii[clear], "m")
    assert len(assert_same(Problem("", circles, *map(tuple, ends))).points) > 20
