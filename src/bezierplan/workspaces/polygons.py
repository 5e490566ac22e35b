"""Polygonal obstacles, with or without holes, in a rectangle."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.workspaces.arrays import read_only
from bezierplan.workspaces.grown import Growth
from bezierplan.workspaces.limits import Bounds

if TYPE_CHECKING:
    import shapely


@dataclass(frozen=True, eq=False)
class Polygons:
    """Polygons in a rectangle.

    bounds: lowest and highest x, lowest and highest y, in units.
    obstacles: one tuple of rings per obstacle, outer ring first, then its holes; a ring is (n, 2)
    in units, not closed.
    unit: name of the unit of length.
    growth: the polygons before they grew by a robot's radius, if they did.

    The arrays are read-only.
    """

    bounds: Bounds
    obstacles: tuple[tuple[np.ndarray, ...], ...]
    unit: str
    growth: Growth | None = None

    def __post_init__(self) -> None:
        obstacles = tuple(
            tuple(read_only(ring, float) for ring in rings) for rings in self.obstacles
        )
        object.__setattr__(self, "obstacles", obstacles)

    def union(self) -> "shapely.Geometry":
        """Join all obstacles to one shape."""
        import shapely

        return shapely.union_all(
            [shapely.Polygon(outer, holes) for outer, *holes in self.obstacles]
        )

    def free(self) -> "shapely.Geometry":
        """Return all that is within the border and in no obstacle."""
        return build_box(self.bounds).difference(self.union())


def build_box(bounds: Bounds) -> "shapely.Polygon":
    """Build the rectangle of some bounds."""
    import shapely

    left, right, bottom, top = bounds
    return shapely.box(left, bottom, right, top)


def list_polygons(shape: "shapely.Geometry") -> list["shapely.Polygon"]:
    """List the polygons of a shape, without points and lines at which others touch."""
    import shapely

    return [part for part in shapely.get_parts(shape) if isinstance(part, shapely.Polygon)]


def list_rings(shape: "shapely.Geometry") -> list[np.ndarray]:
    """List the boundary of a shape's polygons, open rings (n, 2) with the inside on their left."""
    import shapely

    turned = map(shapely.geometry.polygon.orient, list_polygons(shape))
    return [ring for part in turned for ring in list_rings_of_polygon(part)]


def list_rings_of_polygon(polygon: "shapely.Polygon") -> tuple[np.ndarray, ...]:
    """List the rings (n, 2) of a polygon, the outer one first, each without its last position."""
    import shapely

    return tuple(
        shapely.get_coordinates(ring)[:-1] for ring in (polygon.exterior, *polygon.interiors)
    )


def list_sides(ring: np.ndarray) -> np.ndarray:
    """List the sides (n, 4) of an open ring (n, 2), as x, y, x, y."""
    return np.hstack([ring, np.roll(ring, -1, axis=0)])


def normalise(vectors: np.ndarray) -> np.ndarray:
    """Return vectors (n, 2) of length 1, but for vectors of length 0, which stay."""
    return vectors / np.maximum(np.hypot(*vectors.T), np.finfo(float).tiny)[:, None]


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the cross products (n,) of vectors (n, 2), positive where b lies to the left of a."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
