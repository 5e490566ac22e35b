"""Maps for a robot with a width: obstacles grow by its radius and the border shrinks by it, so that
the robot's centre moves like a point.

Circles grow exactly. The sides of polygons and cells move outwards by exactly the radius, and at a
corner two of them are joined by tangents around the arc of the radius, which lie outside it by at
most `ARC_EXCESS` of the radius. So every path of the centre that is free on the grown map keeps the
radius, and none that keeps it by that share more is lost. Maps of cells with many corners grow by
whole cells.
"""

import math
from collections.abc import Collection
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.workspaces import raster
from bezierplan.workspaces.arrays import read_only
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.files import Workspace
from bezierplan.workspaces.grid import Grid, add_wall, find_occupied_around, find_runs
from bezierplan.workspaces.grown import Growth, find_growth
from bezierplan.workspaces.limits import SMALLEST_FEATURE, Bounds
from bezierplan.workspaces.polygons import (
    Polygons,
    build_box,
    cross,
    list_rings,
    list_rings_of_polygon,
    normalise,
)

if TYPE_CHECKING:
    import shapely

ARC_EXCESS = 1e-4
"""How far the tangents at a corner lie outside the arc at most, as a share of the radius; they are
longer by two thirds of that.
"""

SLACK = 1e-9
"""By how much less than the radius polygons grow, in units, so that a slot exactly as wide as the
robot stays open.
"""

TOLERANCE = 1e-8
"""By how much the clearance of a free path may fall short of the radius, in units: `SLACK`, and
what the certified checker tolerates.
"""

MOST_CORNERS = 1_000
"""Most corners of cells that grow as polygons: with more, the shortest path would take minutes."""

# Points of a boundary this close together, in units, are one.
_SAME_POINT = 1e-10

# A corner that turns by less than this, in radians, needs no arc.
_STRAIGHT = 1e-9


# Remembered, because each further path on the map would wait for it again.
@lru_cache(maxsize=4)
def grow(workspace: Workspace, radius: float) -> Workspace:
    """Return the map for the centre of a robot of a radius, in units, with its original as
    `growth`.

    A grid keeps its cells, with the grown polygons as `shapes`: the cells that these overlap are
    occupied.

    Raises ValueError for a radius that is no number, 0 < radius < `SMALLEST_FEATURE`, or so large
    that nothing is free; and for a map that has grown before.

    >>> room = Circles((0.0, 4.0, 0.0, 3.0), np.array([[2.0, 1.5]]), np.array([0.5]), "m")
    >>> grow(room, 0.25).radii.tolist(), grow(room, 0.25).bounds
    ([0.75], (0.25, 3.75, 0.25, 2.75))
    """
    # Written so that nan fails as well.
    if not (0 <= radius < math.inf) or 0 < radius < SMALLEST_FEATURE:
        raise ValueError(
            f"robot_radius: {radius:g}; expected 0 or a number of at least {SMALLEST_FEATURE:g}"
        )
    if radius == 0:
        return workspace
    # A second growth would take the grown map for the original.
    if before := find_growth(workspace):
        raise ValueError(
            f"robot_radius: {radius:g}: "
            f"the map has grown by {before.radius:g} before; expected it once"
        )
    if isinstance(workspace, Circles):
        bounds = _shrink(workspace.bounds, radius)
        growth = Growth(radius, workspace, workspace.centres)
        return replace(workspace, bounds=bounds, radii=workspace.radii + radius, growth=growth)
    shapes = workspace.shapes if isinstance(workspace, Grid) else workspace
    if isinstance(shapes, Polygons):
        polygons = _grow_polygons(workspace, _clean(shapes.union()), shapes.bounds, radius)
        if isinstance(workspace, Polygons):
            return polygons
        return raster.from_polygons(polygons, workspace.cell, "overlap")
    assert isinstance(workspace, Grid)  # neither circles nor polygons
    shape = _join_cells(workspace)
    if shape is None:
        return by_cells(workspace, radius)
    polygons = _grow_polygons(workspace, shape, workspace.bounds, radius)
    return replace(workspace, occupied=raster.find_overlap(polygons, workspace), shapes=polygons)


def choose_suitable(workspace: Workspace, kinds: Collection[str] | None) -> Workspace:
    """Choose the form of a grown map for a planner: the polygons themselves, unless it needs cells.

    kinds: the kinds of workspace that the planner serves, None for all.
    """
    shapes = getattr(workspace, "shapes", None)
    suits = kinds is None or "polygons" in kinds
    return shapes if suits and shapes and shapes.growth else workspace


def _shrink(bounds: Bounds, radius: float) -> Bounds:
    """Return bounds that are smaller by the radius on each side.

    Raises ValueError if nothing is left.
    """
    left, right, bottom, top = bounds
    if min(right - left, top - bottom) < 2 * radius + SMALLEST_FEATURE:
        raise _describe_nothing_free(radius)
    return left + radius, right - radius, bottom + radius, top - radius


def _describe_nothing_free(radius: float) -> ValueError:
    """Return the error for a radius with which no place is free."""
    return ValueError(
        f"robot_radius: {radius:g}: no place of the map is that far from its obstacles and its "
        "border; expected a smaller one"
    )


def _grow_polygons(
    workspace: Workspace,
    shape: "shapely.Geometry",
    bounds: Bounds,
    radius: float,
) -> Polygons:
    """Build polygons around everything closer to a shape than the radius."""
    import shapely

    reach = radius - SLACK
    limits = _shrink(bounds, reach)
    outline, centres = _find_outline(shape, reach)
    inside = build_box(limits)
    if inside.difference(outline).area == 0:
        raise _describe_nothing_free(radius)
    # A part beyond the shrunken border blocks nothing.
    parts = [part for part in shapely.get_parts(outline) if part.intersects(inside)]
    growth = Growth(radius, workspace, read_only(centres, float))
    return Polygons(limits, tuple(map(list_rings_of_polygon, parts)), workspace.unit, growth)


def _clean(union: "shapely.Geometry") -> "shapely.Geometry":
    """Remove from a union what rounding leaves between shapes that share a side.

    These are holes without room for a point, and points that repeat.
    """
    import shapely

    parts = []
    for part in shapely.get_parts(union):
        # The area of a narrow hole over its length is half its width.
        holes = [
            hole for hole in part.interiors if shapely.Polygon(hole).area > TOLERANCE * hole.length
        ]
        parts.append(shapely.Polygon(part.exterior, holes))
    return shapely.remove_repeated_points(shapely.MultiPolygon(parts), _SAME_POINT)


def _find_outline(shape: "shapely.Geometry", reach: float) -> tuple["shapely.Geometry", np.ndarray]:
    """Return a shape with all that is closer to it than the reach, and its convex corners (n, 2).

    It is the union of the shape, of a rectangle outside each side, and of a sector at each convex
    corner, which begins and ends at the rectangles' own corners. A buffer of GEOS would simplify
    the shape by a hundredth of the distance first.
    """
    import shapely

    corners, before, after = _list_corners(shape)
    if not len(corners):
        return shape, corners
    along = normalise(after - corners)
    out = np.column_stack([along[:, 1], -along[:, 0]])  # the shape lies to the left
    sides = shapely.polygons(
        np.stack([corners, corners + reach * out, after + reach * out, after], axis=1)
    )
    arriving = normalise(corners - before)
    first = np.column_stack([arriving[:, 1], -arriving[:, 0]])
    turn = np.arctan2(cross(arriving, along), (arriving * along).sum(axis=1))
    convex = np.flatnonzero(turn > _STRAIGHT)
    sectors = [
        shapely.Polygon(_build_sector(corners[k], reach, first[k], out[k], turn[k])) for k in convex
    ]
    return _clean(shapely.union_all([shape, *sides, *sectors])), corners[convex]


def _build_sector(
    corner: np.ndarray, reach: float, first: np.ndarray, last: np.ndarray, turn: float
) -> np.ndarray:
    """Build a corner's sector: the corner, and the tangents (n, 2) around its arc, from one unit
    vector to another.
    """
    # Tangents meet at 1 / cos(half) of the radius: at most 1 + ARC_EXCESS.
    parts = math.ceil(turn / (2 * math.acos(1 / (1 + ARC_EXCESS))))
    half = 0.5 * turn / parts
    angles = math.atan2(first[1], first[0]) + half * (2 * np.arange(parts) + 1)
    around = np.column_stack([np.cos(angles), np.sin(angles)]) / math.cos(half)
    return corner + reach * np.vstack([[0.0, 0.0], first, around, last])


def _list_corners(shape: "shapely.Geometry") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """List the corners (n, 2) of a shape, which lies to the left of its boundary, and the ones
    before and after each.
    """
    every = [np.empty((0, 2)), *list_rings(shape)]
    corners, before, after = (
        np.concatenate([np.roll(ring, by, axis=0) for ring in every]) for by in (0, 1, -1)
    )
    return corners, before, after


def _join_cells(grid: Grid) -> "shapely.Geometry | None":
    """Join the occupied cells to one shape; None if it has more than `MOST_CORNERS` corners."""
    import shapely

    cells = np.pad(grid.occupied, 1)
    around = find_occupied_around(cells).sum(axis=0)
    diagonal = (around == 2) & (cells[:-1, :-1] == cells[1:, 1:])
    if ((around % 2 == 1) | diagonal).sum() > MOST_CORNERS:
        return None
    # A rectangle for each run of cells in a row: there are far fewer of them than cells.
    row, begin, end = find_runs(grid.occupied).T
    # Whole numbers: exact.
    whole = shapely.simplify(shapely.union_all(shapely.box(begin, row, end, row + 1)), 0)
    return shapely.transform(whole, grid.in_units)


def by_cells(grid: Grid, radius: float) -> Grid:
    """Return a grid in which each cell closer than the radius to an occupied one or to the border
    is occupied too.
    """
    from scipy.ndimage import binary_dilation, distance_transform_edt

    walled = add_wall(grid.occupied)
    # Two squares are as far apart as their centres would be if one of them were a cell nearer in
    # both directions.
    touching = binary_dilation(walled, np.ones((3, 3), bool))
    occupied = walled | (distance_transform_edt(~touching) * grid.cell < radius - SLACK)
    if occupied.all():
        raise _describe_nothing_free(radius)
    return replace(
        grid, occupied=occupied[1:-1, 1:-1], growth=Growth(radius, grid, np.empty((0, 2)))
    )
