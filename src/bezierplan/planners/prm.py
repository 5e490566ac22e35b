"""Probabilistic road map: random free points, linked where they see each other, and the shortest way along the links.

The baseline of tharwat2018's Figure 22 (its reference 48), which gives no parameters.
"""

import math
from typing import Annotated, Literal

import numpy as np

from bezierplan.problem import Path, Plan, Problem, Range
from bezierplan.workspaces.circles import Circles

workspaces = ("circles",)
exact = True

# Points drawn for one free node before the field counts as full.
_MOST_DRAWS = 10_000

# A segment may be this deep in a circle, in units: rounding errors of one that touches it, as from a start on its edge.
_TOUCHING = 1e-9


def plan(
    problem: Problem,
    rng: np.random.Generator,
    *,
    nodes: Annotated[int, Range(0, 2000)],
    links: Literal["visible", "nearest"],
    neighbours: Annotated[int, Range(1)],
    d_min: Annotated[float, Range(0)],
) -> Plan:
    """Shortest path along a random road map, a polyline; its objective is its length in units, infinite without a path.

    nodes: random points of the free part of the field, beside start and target. links: a node is linked with every node that it sees, or
    with those that it sees of its nearest `neighbours`. d_min: added to every radius, in units.

    Fewer nodes of one generator are the first of more. Extra column: roads, the number of links.
    """
    field = problem.workspace
    radii = field.radii + d_min
    points = np.concatenate([[problem.start, problem.target], _free_points(rng, nodes, field, radii)])
    one, other = _pairs(points, None if links == "visible" else neighbours)
    seen = _visible(points[one], points[other], field.centres, radii)
    one, other = one[seen], other[seen]
    length, way = _shortest_way(points, one, other)
    path = Path("polyline", points[way]) if way else None
    found = path is not None
    history = np.array([length])
    return Plan(path, length, claimed_feasible=found, evaluations=1, history=history, stop="direct", extra={"roads": len(one)})


def _free_points(rng: np.random.Generator, nodes: int, field: Circles, radii: np.ndarray) -> np.ndarray:
    """Points (nodes or fewer, 2), uniform in the field outside all circles; fewer if next to nothing of it is free."""
    low, high = np.reshape(field.bounds, (2, 2)).T
    free = np.empty((0, 2))
    tries = 0
    while len(free) < nodes and tries < _MOST_DRAWS * nodes:
        points = low + (high - low) * rng.random((nodes, 2))
        outside = np.hypot(*(points[:, None] - field.centres).transpose(2, 0, 1)) >= radii
        free = np.concatenate([free, points[outside.all(axis=1)]])
        tries += nodes
    return free[:nodes]


def _pairs(points: np.ndarray, neighbours: int | None) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of different nodes, as two index arrays (pairs,), each pair once: all, or those of which one is among the other's nearest."""
    count = len(points)
    if neighbours is None or neighbours >= count - 1:
        return np.triu_indices(count, 1)
    distances = np.hypot(*(points[:, None] - points).transpose(2, 0, 1))
    np.fill_diagonal(distances, np.inf)
    near = np.zeros((count, count), dtype=bool)
    np.put_along_axis(near, np.argsort(distances, axis=1, kind="stable")[:, :neighbours], True, axis=1)
    return np.nonzero(np.triu(near | near.T))


def _visible(starts: np.ndarray, targets: np.ndarray, centres: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Whether the segments between two arrays of points (n, 2) enter no circle; touching is allowed."""
    way = targets - starts
    square = np.maximum((way**2).sum(axis=1), np.finfo(float).tiny)  # of a point, any share along it is right
    visible = np.ones(len(way), dtype=bool)
    for centre, radius in zip(centres, radii):
        share = np.clip(((centre - starts) * way).sum(axis=1) / square, 0, 1)
        nearest = starts + share[:, None] * way
        visible &= np.hypot(*(nearest - centre).T) >= radius - _TOUCHING
    return visible


def _shortest_way(points: np.ndarray, one: np.ndarray, other: np.ndarray) -> tuple[float, list[int]]:
    """Length of the shortest way from node 0 to node 1 along links, and its nodes; infinite and none if they are not connected."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    roads = csr_array((np.hypot(*(points[one] - points[other]).T), (one, other)), shape=(len(points), len(points)))
    lengths, before = dijkstra(roads, directed=False, indices=0, return_predecessors=True)
    if math.isinf(lengths[1]):
        return math.inf, []
    way = [1]
    while way[-1] != 0:
        way.append(int(before[way[-1]]))
    return float(lengths[1]), way[::-1]
