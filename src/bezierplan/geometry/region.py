"""The blocked region of a workspace: the single description shared by the certified check and the
exact shortest paths.

The blocked region is open: the interior of the union of all obstacles and of the outside of the
border. A path may touch its boundary. The union is formed before any test, because a path along the
seam of two touching obstacles enters neither of them and yet is deep inside their union.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bezierplan.geometry.bins import Bins, sort_into_bins
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid, add_wall, find_occupied_around, find_runs
from bezierplan.workspaces.polygons import Polygons, cross, list_rings, list_sides, normalise
from bezierplan.workspaces.problem import Workspace

# Unit vectors whose cross product is at most this count as collinear: a vertex between them is a
# rounding artefact of the union, not a corner.
COLLINEAR = 1e-12

# The depth, in units, or on a grid in cells, up to which `is_blocked` calls a point free.
_TOLERANCE = 1e-9


class GridRegion(NamedTuple):
    """Occupied cells and the outside of the grid, as elements of the doubled grid.

    A doubled grid has an element for every cell, for every open edge between two cells, and for
    every vertex between four, each in its place: with a ring of cells around the grid to represent
    the outside, even indices are cells and odd indices are grid lines.

    Attributes
    ----------
    cell : float
        Side of a cell, in units.
    origin : (2,) array
        x and y of the grid's lower left corner, in units; everything else, including paths, is
        measured from it (`from_origin`).
    blocked : (2 rows + 3, 2 columns + 3) array of bool
        Whether all cells that touch an element are occupied.
    counts : (2 rows + 4, 2 columns + 4) array of int
        Prefix sums of `blocked`.
    edges : (n, 4) array
        Boundary of the region as x, y, x, y in units, collinear edges joined.
    bins : Bins
        The edges by place.
    """

    cell: float
    origin: np.ndarray
    blocked: np.ndarray
    counts: np.ndarray
    edges: np.ndarray
    bins: Bins


class CircleRegion(NamedTuple):
    """Open discs and the outside of the border.

    Attributes
    ----------
    centres : (n, 2) array
        In units.
    radii : (n,) array
        In units.
    bounds : (4,) array
        Lowest and highest x, lowest and highest y, in units.
    edges : (4, 4) array
        The border as x, y, x, y in units.
    bins : Bins
        The edges by place.
    """

    centres: np.ndarray
    radii: np.ndarray
    bounds: np.ndarray
    edges: np.ndarray
    bins: Bins


class PolygonRegion(NamedTuple):
    """The union of polygons and of the outside of the border, by its boundary.

    Attributes
    ----------
    edges : (n, 4) array
        As x, y, x, y in units, directed so that free space is on the left, without collinear
        vertices.
    normals : (n, 2) array
        Unit vectors to the free side.
    following : (n,) array of int
        Index of the edge that begins where this one ends.
    preceding : (n,) array of int
        Its inverse.
    convex : (n,) array of bool
        Whether the blocked region is convex at the end of an edge.
    bins : Bins
        The edges by place.
    """

    edges: np.ndarray
    normals: np.ndarray
    following: np.ndarray
    preceding: np.ndarray
    convex: np.ndarray
    bins: Bins


Region = GridRegion | CircleRegion | PolygonRegion


# Few: that of a map of 4,000 x 4,000 cells takes half a gigabyte.
@lru_cache(maxsize=4)
def build_region(workspace: Workspace) -> Region:
    """Build the blocked region of a workspace; cells drawn from polygons have the region of the
    polygons.

    Parameters
    ----------
    workspace : Grid, Circles or Polygons
        What the robot moves in.

    Returns
    -------
    GridRegion, CircleRegion or PolygonRegion
        It shares no memory with the workspace. Regions of the last maps are remembered.
    """
    if isinstance(workspace, Grid) and isinstance(workspace.shapes, Polygons):
        return _build_polygon_region(workspace.shapes)
    if isinstance(workspace, Grid):
        return _build_grid_region(workspace)
    if isinstance(workspace, Circles):
        return _build_circle_region(workspace)
    return _build_polygon_region(workspace)


def is_blocked(region: Region, point: tuple[float, float]) -> bool:
    """Tell whether a point lies in the blocked region.

    Meant for single points: it needs no compiled code.

    Parameters
    ----------
    region : Region
        The blocked region of a workspace.
    point : tuple of float
        (x, y) in units.

    Returns
    -------
    bool
        Whether it lies deeper than 1e-9.
    """
    if isinstance(region, GridRegion):
        column, row = (
            _element(value / region.cell) for value in from_origin(np.array(point), region)
        )
        inside = 0 <= row < region.blocked.shape[0] and 0 <= column < region.blocked.shape[1]
        return not inside or bool(region.blocked[row, column])
    x, y = point
    if isinstance(region, CircleRegion):
        left, right, bottom, top = region.bounds
        deepest = max(left - x, x - right, bottom - y, y - top)
        in_discs = region.radii - np.hypot(x - region.centres[:, 0], y - region.centres[:, 1])
        return in_discs.max(initial=deepest) > _TOLERANCE
    begin, end = region.edges[:, :2], region.edges[:, 2:]
    along = end - begin
    share = np.clip(((point - begin) * along).sum(axis=1) / (along**2).sum(axis=1), 0, 1)
    nearest = np.hypot(*(begin + share[:, None] * along - point).T).min(initial=np.inf)
    # Free space is bounded, so a ray from a free point leaves it and crosses the boundary an odd
    # number of times.
    across = (begin[:, 1] > y) != (end[:, 1] > y)
    crossing = begin[across, 0] + (y - begin[across, 1]) * along[across, 0] / along[across, 1]
    return nearest > _TOLERANCE and int((crossing > x).sum()) % 2 == 0


def from_origin(points: np.ndarray, region: Region) -> np.ndarray:
    """Return points (..., 2), in units, in the region's frame: on a grid, from its lower left
    corner.
    """
    return points - region.origin if isinstance(region, GridRegion) else points


def _element(coordinate: float) -> int:
    """Return the index in the doubled grid of a coordinate in cells: the grid line's if it lies on
    one, otherwise the cell's.
    """
    line = round(coordinate)
    return (
        2 * line + 1 if abs(coordinate - line) <= _TOLERANCE else 2 * int(np.floor(coordinate)) + 2
    )


def _build_grid_region(grid: Grid) -> GridRegion:
    """Build the region of cells, as elements of the doubled grid."""
    cells = add_wall(grid.occupied)
    blocked = np.empty((2 * cells.shape[0] - 1, 2 * cells.shape[1] - 1), bool)
    blocked[::2, ::2] = cells
    # A line or vertex is blocked only if all cells beside it are: a path may run along a wall.
    blocked[1::2, ::2] = cells[:-1] & cells[1:]
    blocked[::2, 1::2] = cells[:, :-1] & cells[:, 1:]
    blocked[1::2, 1::2] = find_occupied_around(cells).all(axis=0)
    horizontal = find_runs(cells[:-1, 1:-1] != cells[1:, 1:-1])
    # Columns become rows, because runs are found along rows.
    vertical = find_runs(np.ascontiguousarray((cells[1:-1, :-1] != cells[1:-1, 1:]).T))
    edges = np.ascontiguousarray(
        np.concatenate([horizontal[:, [1, 0, 2, 0]], vertical[:, [0, 1, 0, 2]]]) * grid.cell
    )

    return GridRegion(
        float(grid.cell),
        np.array(grid.origin, float),
        blocked,
        # Sums of what lies below and to the left of each corner.
        np.pad(blocked.cumsum(axis=0, dtype=np.int64).cumsum(axis=1), ((1, 0), (1, 0))),
        edges,
        sort_into_bins(edges),
    )


def _build_circle_region(circles: Circles) -> CircleRegion:
    """Build the region of discs and of the outside of the border."""
    left, right, bottom, top = circles.bounds
    corners = [[left, bottom], [right, bottom], [right, top], [left, top]]
    edges = list_sides(np.array(corners, float))
    # Copies: a region shares no memory with the workspace that a planner holds.
    return CircleRegion(
        np.array(circles.centres, float).reshape(-1, 2),
        np.array(circles.radii, float),
        np.array(circles.bounds, float),
        edges,
        sort_into_bins(edges),
    )


def _build_polygon_region(polygons: Polygons) -> PolygonRegion:
    """Build the blocked region of a map of polygons (the obstacles and all beyond the border) as
    edges with free space to their left.
    """
    cornered = [_list_corners(ring) for ring in list_rings(polygons.free())]
    begin = np.concatenate([np.empty((0, 2)), *cornered])
    following = np.empty(len(begin), np.int64)
    first = 0
    for ring in cornered:
        following[first : first + len(ring)] = first + np.roll(np.arange(len(ring)), -1)
        first += len(ring)
    preceding = np.argsort(following)
    end = begin[following]
    direction = normalise(end - begin)
    # To the left of an edge, where free space is.
    normals = np.column_stack([-direction[:, 1], direction[:, 0]])
    convex = cross(direction, direction[following]) < 0
    edges = np.hstack([begin, end])
    return PolygonRegion(edges, normals, following, preceding, convex, sort_into_bins(edges))


def _list_corners(ring: np.ndarray) -> np.ndarray:
    """Return a ring (n, 2) without repeated and collinear vertices."""
    ring = ring[np.any(ring != np.roll(ring, 1, axis=0), axis=1)]
    arriving = normalise(ring - np.roll(ring, 1, axis=0))
    leaving = normalise(np.roll(ring, -1, axis=0) - ring)
    return ring[np.abs(cross(arriving, leaving)) > COLLINEAR]
