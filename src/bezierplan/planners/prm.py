"""Probabilistic roadmap: random free points, linked where they see each other, and the shortest
path along the links.

The baseline PRM of tharwat2018's Figure 22 (its reference 48) and of elhoseny2017's Tables 2, 3 and
6, which give no parameters. Among circles a link is a segment that enters none; on a grid, one that
touches no occupied cell.
"""

import heapq
from collections.abc import Callable
from enum import IntEnum
from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.geometry.cell_length import is_free_leg
from bezierplan.kernels import compile_kernel
from bezierplan.planners import About, Path, Plan, Problem, Range
from bezierplan.planners.parts.settings import UNITS, with_settings
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.trace import trace_back

extra = ("roads",)
workspaces = ("circles", "grid")
exact = True

# Number of points drawn for one free node before the field counts as full.
_MOST_DRAWS = 10_000

# A segment may be this deep in a circle, in units: to allow for rounding errors of a segment that
# touches it, such as one from a start on its edge.
_TOUCHING = 1e-9


Links = IntEnum("Links", "visible nearest")


class Settings(NamedTuple):
    """Settings of the roadmap; the papers give none."""

    nodes: Annotated[
        int,
        Range(0, 2000),
        About("random points of the free part of the field, beside start and target"),
    ]
    links: Annotated[
        Links,
        About(
            "a node is linked with every node that it sees, or with those of its nearest "
            "`neighbours` that it sees"
        ),
    ]
    neighbours: Annotated[int, Range(1), About("nearest nodes that a node may be linked with")]
    d_min: Annotated[
        float, Range(0), About("added to every radius; must be 0 on a grid", unit=UNITS)
    ]
    attempts: Annotated[int, Range(1), About("roadmaps drawn, until one connects start and target")]


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Return the shortest path along a random roadmap, a polyline.

    With the same generator, the nodes of a smaller roadmap are the first nodes of a larger one.

    Parameters
    ----------
    problem : Problem
        Among circles, or on a grid.
    rng : numpy.random.Generator
        The only source of random numbers.

    Returns
    -------
    Plan
        Its objective is its length in units, infinite if there is no path. Extra column: roads, the
        number of links of the last roadmap.

    References
    ----------
    tharwat2018, Figure 22; elhoseny2017, Tables 2, 3 and 6.
    """
    neighbours = settings.neighbours if settings.links == Links.nearest else None
    workspace, d_min = problem.workspace, settings.d_min
    low, high, is_free, sees = (
        _prepare_grid(workspace, d_min)
        if isinstance(workspace, Grid)
        else _prepare_circles(workspace, d_min)
    )
    drawn, way = 0, ()
    # Later roadmaps take further numbers of the same generator.
    while drawn < settings.attempts and not len(way):
        free = _draw_free_points(rng, settings.nodes, low, high, is_free)
        points = np.concatenate([problem.ends, free])
        one, other = _list_pairs(points, neighbours)
        seen = sees(points[one], points[other])
        one, other = one[seen], other[seen]
        lengths = np.hypot(*(points[one] - points[other]).T)
        length, nodes = _find_shortest_way(len(points), one, other, lengths)
        way = points[nodes]
        drawn += 1
    path = Path("polyline", way) if len(way) else None
    return Plan.of_one(path, length, "direct", {"roads": len(one)})._replace(evaluations=drawn)


def _prepare_circles(circles: Circles, d_min: float) -> tuple:
    """Return two corners (2,) between which nodes are drawn among circles, and functions that tell
    which points and segments (n,) are free.
    """
    radii = circles.radii + d_min
    low, high = np.reshape(circles.bounds, (2, 2)).T

    def is_free(points: np.ndarray) -> np.ndarray:
        apart = np.hypot(*(points[:, None] - circles.centres).transpose(2, 0, 1))
        return (apart >= radii).all(axis=1)

    return low, high, is_free, partial(_is_visible, centres=circles.centres, radii=radii)


def _prepare_grid(grid: Grid, d_min: float) -> tuple:
    """Return two corners (2,) between which nodes are drawn on a grid, and functions that tell
    which points and segments (n,) are free.

    The corners are the centres of two cells. Raises ValueError for a `d_min` above 0.
    """
    if d_min > 0:
        raise ValueError(f"d_min: {d_min:g}; on a grid expected 0, its cells cannot grow")
    low, high = grid.in_units(np.array([[0.5, 0.5], np.array(grid.occupied.shape[::-1]) - 0.5]))

    def is_free(points: np.ndarray) -> np.ndarray:
        column, row = np.floor(grid.in_cells(points)).astype(int).T
        return ~grid.occupied[row, column]

    def sees(starts: np.ndarray, targets: np.ndarray) -> np.ndarray:
        return _find_free_legs(grid.occupied, grid.in_cells(starts), grid.in_cells(targets))

    return low, high, is_free, sees


def _draw_free_points(
    rng: np.random.Generator,
    nodes: int,
    low: np.ndarray,
    high: np.ndarray,
    is_free: Callable[..., np.ndarray],
) -> np.ndarray:
    """Draw points (nodes, 2), uniform in a field's free part; fewer if almost none is free."""
    free = np.empty((0, 2))
    tries = 0
    while len(free) < nodes and tries < _MOST_DRAWS * nodes:
        # One stream, x before y: a smaller roadmap has the first nodes of a larger one.
        points = low + (high - low) * rng.random((nodes, 2))
        free = np.concatenate([free, points[is_free(points)]])
        tries += nodes
    return free[:nodes]


@compile_kernel
def _find_free_legs(occupied, starts, targets):
    """Tell which legs between two arrays of points (n, 2), in cells, touch no occupied cell."""
    free = np.empty(len(starts), np.bool_)
    for i in range(len(starts)):
        free[i] = is_free_leg(occupied, starts[i], targets[i])
    return free


def _list_pairs(points: np.ndarray, neighbours: int | None) -> tuple[np.ndarray, np.ndarray]:
    """List pairs of different nodes, as two index arrays (pairs,), each pair once.

    These are all pairs, or those in which one node is among the other's nearest.
    """
    count = len(points)
    if neighbours is None or neighbours >= count - 1:
        return np.triu_indices(count, 1)
    from scipy.spatial import KDTree

    # Every node is the nearest to itself.
    nearest, node = KDTree(points).query(points, neighbours + 1)[1], np.arange(count)[:, None]
    linked = np.zeros(count * count, bool)
    linked[np.minimum(node, nearest) * count + np.maximum(node, nearest)] = True
    linked[:: count + 1] = False
    return np.divmod(np.flatnonzero(linked), count)


def _is_visible(
    starts: np.ndarray, targets: np.ndarray, centres: np.ndarray, radii: np.ndarray
) -> np.ndarray:
    """Tell which segments between two arrays of points (n, 2) enter no circle; touching is
    allowed.
    """
    way = targets - starts
    # For a single point any share along it is valid.
    square = np.maximum((way**2).sum(axis=1), np.finfo(float).tiny)
    visible = np.ones(len(way), bool)
    for centre, radius in zip(centres, radii):
        share = np.clip(((centre - starts) * way).sum(axis=1) / square, 0, 1)
        nearest = starts + share[:, None] * way
        visible &= np.hypot(*(nearest - centre).T) >= radius - _TOUCHING
    return visible


@compile_kernel
def _find_shortest_way(count, tails, heads, lengths):
    """Run Dijkstra's algorithm along links (n,) of `count` nodes.

    Returns the length of the shortest path from node 0 to node 1, and its nodes; infinite and empty
    if they are not connected.
    """
    links = len(tails)
    ends = np.concatenate((tails, heads))
    # The links of a node: its newest one, by either end, and before each the next older one.
    newest, older = np.full(count, -1), np.empty_like(ends)
    for k in range(len(ends)):
        older[k], newest[ends[k]] = newest[ends[k]], k
    far, before = np.full(count, np.inf), np.full(count, -1)
    far[0] = 0.0
    heap = [(0.0, 0)]
    while len(heap) > 0 and heap[0][1] != 1:
        length, node = heapq.heappop(heap)
        # An outdated entry: a shorter way to the node was found after it.
        if length > far[node]:
            continue
        k = newest[node]
        while k >= 0:
            other, so_far = ends[k - links], length + lengths[k % links]
            if so_far < far[other]:
                far[other], before[other] = so_far, node
                heapq.heappush(heap, (so_far, other))
            k = older[k]
    return far[1], trace_back(before, 1, far[1])
