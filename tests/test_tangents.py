"""Exact shortest paths around circles against a plain graph of all tangents: what a search leaves
out changes nothing.
"""

import itertools
import math

import numpy as np
import pytest
import shapely
from fields import assert_is_bound
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from bezierplan.geometry.checker import TOLERANCE
from bezierplan.geometry.region import build_region, is_blocked
from bezierplan.geometry.shortest_paths import shortest_path
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem

# An arc is free if its middle and so many other points are.
ALONG = np.linspace(0, 1, 51)[1:-1]


def list_tangents(centres, radii):
    """Circles that a tangent joins, and the angles at which it touches each."""
    for i, j in itertools.combinations(range(len(radii)), 2):
        dx, dy = centres[j] - centres[i]
        apart, towards = math.hypot(dx, dy), math.atan2(dy, dx)
        for beside, turn in ((radii[j], 0.0), (-radii[j], math.pi)):
            if apart > 0 and abs(radii[i] - beside) <= apart + TOLERANCE:
                half = math.acos(np.clip((radii[i] - beside) / apart, -1, 1))
                for angle in (towards - half, towards + half):
                    yield (i, angle), (j, angle + turn)


def of_all_tangents(problem):
    """Length of the shortest path in the graph of all tangents and of the arcs between them; start
    and target are circles without a radius.
    """
    home = problem.workspace
    centres = np.concatenate([[problem.start, problem.target], home.centres])
    radii = np.concatenate([[0.0, 0.0], home.radii])
    low, high = np.reshape(home.bounds, (2, 2)).T

    def place(circle, angle):
        return centres[circle] + radii[circle, None] * np.stack([np.cos(angle), np.sin(angle)], -1)

    def is_free(points, distances):
        within = (points >= low - TOLERANCE) & (points <= high + TOLERANCE)
        return within.all(axis=(1, 2)) & (distances >= radii - TOLERANCE).all(axis=1)

    tangents = np.array([((0, 0.0), (1, 0.0)), *list_tangents(centres, radii)])
    lines = place(tangents[..., 0].astype(int).ravel(), tangents[..., 1].ravel()).reshape(-1, 2, 2)
    apart = shapely.distance(shapely.linestrings(lines)[:, None], shapely.points(centres))
    free = is_free(lines, apart)
    circles, angles = tangents[free].reshape(-1, 2).T
    edges = [(2 * k, 2 * k + 1, math.dist(*line)) for k, line in enumerate(lines[free])]
    for k, radius in enumerate(radii):
        nodes = np.flatnonzero(circles == k)
        nodes = nodes[np.argsort(angles[nodes] % math.tau)]
        sweep = np.diff(angles[nodes] % math.tau, append=angles[nodes[:1]] % math.tau + math.tau)
        along = place(np.array([k]), angles[nodes, None] + sweep[:, None] * ALONG)
        apart = np.linalg.norm(along[:, :, None] - centres, axis=-1).min(axis=1, initial=math.inf)
        arcs = np.stack([nodes, np.roll(nodes, -1), radius * sweep], axis=1)
        edges += arcs[is_free(along, apart)].tolist()
    tails, heads, lengths = np.array(edges).reshape(-1, 3).T
    size = (max(len(circles), 2),) * 2
    graph = coo_array((np.maximum(lengths, 1e-300), (tails.astype(int), heads.astype(int))), size)
    ends = [np.flatnonzero(circles == end)[:1] for end in (0, 1)]
    if not all(map(len, ends)):
        return math.inf
    return dijkstra(graph.tocsr(), directed=False, indices=ends[0].item())[ends[1].item()]


def assert_same(problem):
    found = shortest_path(problem)
    assert found.length == pytest.approx(of_all_tangents(problem), rel=1e-13)
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
