"""Shortest paths in visibility graphs, and the paths that they give."""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bezierplan.workspaces.trace import trace_back

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# Sparse matrices treat a zero entry as no edge.
NO_LENGTH = 1e-300


class Bound(NamedTuple):
    """A shortest path.

    Attributes
    ----------
    length : float
        In the problem's unit; infinite if there is no path.
    points : (n, 2) array
        A polyline along it from start to target; (0, 2) if there is no path.
    """

    length: float
    points: np.ndarray


def no_path() -> Bound:
    """Return the result of a search that finds no path."""
    return Bound(math.inf, np.empty((0, 2)))


def move_bound(bound: Bound, by: np.ndarray | tuple[float, float]) -> Bound:
    """Move a path from coordinates relative to a grid's corner to those relative to the origin."""
    return bound._replace(points=bound.points + by)


def follow_nodes(points: np.ndarray, nodes: np.ndarray) -> Bound:
    """Return the polyline along some points (n, 2), without repetitions; no path without nodes."""
    if not len(nodes):
        return no_path()
    path = points[nodes]
    moving = np.any(np.diff(path, axis=0) != 0, axis=1)
    path = np.concatenate([path[:1], path[1:][moving]]) if moving.any() else path[:2]
    # An exact sum: the bound does not depend on the order of the legs.
    return Bound(math.fsum(np.hypot(*np.diff(path, axis=0).T)), path)


def shortest_in_graph(points: np.ndarray, visible: np.ndarray) -> Bound:
    """Find the shortest polyline from the first to the second of some points (n, 2).

    visible: bool (n, n), which pairs i < j of points see each other.
    """
    ends = np.array(np.nonzero(visible))
    tail, head = ends
    lengths = np.hypot(*(points[head] - points[tail]).T)
    return follow_nodes(points, dijkstra_path(build_matrix(lengths, ends, len(points))))


def build_matrix(lengths: np.ndarray, ends: np.ndarray, count: int) -> "csr_array":
    """Return the lengths (e,) of edges between nodes (2, e) as a sparse matrix (count, count)."""
    from scipy.sparse import coo_array

    ends = ends.astype(np.int32)  # older versions of scipy take no wider ones
    return coo_array((np.maximum(lengths, NO_LENGTH), tuple(ends)), shape=(count, count)).tocsr()


def dijkstra_path(graph: "csr_array") -> np.ndarray:
    """Return the nodes of a shortest path from node 0 to node 1 in a sparse, undirected graph.

    There are none if there is no path.
    """
    from scipy.sparse.csgraph import dijkstra

    distances, predecessors = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
    # As whole numbers of the kernels that use it, too: for others it would compile once more.
    return trace_back(predecessors.astype(np.int64), 1, distances[1])
