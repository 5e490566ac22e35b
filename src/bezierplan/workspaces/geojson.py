"""Polygons from GeoJSON (RFC 7946), as studies write it and as GIS programs do: no obstacle may be
lost, so a file that is not understood is refused.

The file is a collection of features, one feature, or a bare geometry: Polygon, MultiPolygon, or a
GeometryCollection of these. A feature without `properties.role` is an obstacle. The border is the
polygon with the role `border`, of any shape; without one, the bounding box of all obstacles with a
margin, or the file's `bbox`. All that lies outside of it is blocked, so obstacles are cut there.
Features with the role `start` or `target` are ignored: problems define them. A third coordinate,
the height, is dropped, and features without a geometry are skipped.
"""

import json
import logging
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bezierplan.schema.checked import describe_known
from bezierplan.workspaces.limits import (
    SMALLEST_ANGLE,
    SMALLEST_GAP,
    Bounds,
    check_bounds,
    check_gaps,
    check_numbers,
    check_thickness,
)
from bezierplan.workspaces.polygons import (
    Polygons,
    build_box,
    cross,
    list_polygons,
    list_rings_of_polygon,
)

if TYPE_CHECKING:
    import shapely

logger = logging.getLogger(__name__)

# How often places in degrees fit between themselves and the origin, at least: most countries do
# so; a map in metres mostly begins near the origin.
_AWAY = 3.0

ROLES = ("border", "obstacle", "start", "target")


class Shape(NamedTuple):
    """A polygon of a file. name: for messages. role: border or obstacle."""

    name: str
    role: str
    polygon: "shapely.Polygon"


def read_geojson(text: str, unit: str, margin: float | None = None) -> Polygons:
    """Read polygons from the text of a GeoJSON file.

    Warns of what is skipped, and of obstacles that are cut at the border.

    margin: between obstacles and border, in units, of a file without a border of its own.

    Raises ValueError, naming the feature, for text that is not GeoJSON, an unknown role, a geometry
    that is no polygon, coordinates out of range or in degrees, no border, a margin beside a border,
    an obstacle that is invalid or too thin for the checker, and gaps that are neither closed nor
    open.
    """
    content = _read_content(text)
    shapes = [
        shape
        for number, feature in enumerate(_list_features(content))
        for shape in _read_shapes(number, feature)
    ]
    # A file that names its projection does not mean degrees, small as its extent may be.
    if shapes and "crs" not in content:
        _refuse_degrees(shapes)
    obstacles = [shape for shape in shapes if shape.role == "obstacle"]
    borders = [shape for shape in shapes if shape.role == "border"]
    limits, outside = _find_border(borders, obstacles, content.get("bbox"), margin)
    obstacles += outside
    frame = build_box(limits)
    _check_gaps(obstacles, frame)
    kept: list[shapely.Polygon] = []
    for shape in obstacles:
        if frame.covers(shape.polygon):
            kept.append(shape.polygon)
        else:
            logger.warning("%s: beyond the border, and cut there", shape.name)
            kept += list_polygons(shape.polygon.intersection(frame))
    return Polygons(limits, tuple(map(list_rings_of_polygon, kept)), unit)


def _read_content(text: str) -> dict[str, Any]:
    """Read the text as JSON.

    Raises ValueError for other text, and for coordinates that are said to be degrees.
    """
    try:
        content = json.loads(text, object_pairs_hook=_read_object)
    except (ValueError, RecursionError) as error:
        # Brackets within many others end in a RecursionError.
        raise ValueError(f"not GeoJSON ({error})") from None
    if not isinstance(content, dict):
        raise ValueError("not GeoJSON: expected an object with a list of features")
    # A key of older GeoJSON, which GIS programs still write.
    named = str(content.get("crs")).upper()
    if any(name in named for name in ("CRS84", "4326", "WGS84", "WGS 84")):
        raise ValueError("crs: longitudes and latitudes, in degrees; expected x and y as lengths")
    return content


def _refuse_degrees(shapes: list[Shape]) -> None:
    """Raise ValueError for places that look like longitudes and latitudes, which RFC 7946 asks for.

    They lie within their limits, and far from the origin beside their extent.
    """
    import shapely

    bounds = shapely.total_bounds([shape.polygon for shape in shapes])
    low, high = bounds[:2], bounds[2:]
    far, extent = np.maximum(-low, high), max(high - low)
    gap = np.hypot(*np.maximum(0, np.maximum(low, -high)))
    if (far <= (180, 90)).all() and gap > _AWAY * extent:
        raise ValueError(
            f"places about {low[0]:g}, {low[1]:g} with an extent of {extent:.2g} look like "
            "degrees; expected x and y as lengths: project them, or move a map in metres near the "
            "origin"
        )


def _read_object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return an object of a file.

    Raises ValueError for a key that is given twice: one would be lost.
    """
    content: dict[str, Any] = {}
    for key, entry in pairs:
        if key in content:
            raise ValueError(f"{key}: this key is given twice")
        content[key] = entry
    return content


def _list_features(content: dict[str, Any]) -> list[Any]:
    """List the features of a file, which may also be one feature or a bare geometry."""
    if "features" not in content:
        return [content if content.get("type") == "Feature" else {"geometry": content}]
    if not isinstance(content["features"], list):
        raise ValueError("not GeoJSON: expected an object with a list of features")
    return content["features"]


def _read_shapes(number: int, feature: Any) -> Iterator[Shape]:
    """Yield the polygons of a feature; none for a role that is not part of a workspace."""
    import shapely

    if not isinstance(feature, dict) or not isinstance(feature.get("properties") or {}, dict):
        raise ValueError(f"feature {number}: expected a feature with a geometry")
    role = (feature.get("properties") or {}).get("role", "obstacle")
    if role not in ROLES:
        raise ValueError(
            f"feature {number}: properties: role: {role!r}: unknown"
            f"{describe_known(str(role), ROLES)}"
        )
    name = f"feature {number} ({role})"
    if role not in ("border", "obstacle"):
        return
    if feature.get("geometry") is None:
        logger.warning("%s: without a geometry, and skipped", name)
        return
    try:
        geometry = shapely.force_2d(shapely.geometry.shape(feature["geometry"]))
    except Exception:  # of what is no geometry shapely raises many
        geometry = None
    # A collection may have multipolygons.
    polygons = shapely.get_parts(shapely.get_parts([geometry]))
    if not all(isinstance(each, shapely.Polygon) for each in polygons) or geometry is None:
        raise ValueError(
            f"{name}: geometry: expected a Polygon, a MultiPolygon, or a GeometryCollection of "
            "these, of rings of [x, y] or of [x, y, height]"
        )
    # The file's own positions: shapely closes an open ring by itself.
    _check_rings(feature["geometry"], name)
    for polygon in polygons:
        check_numbers(shapely.get_coordinates(polygon), name)
        if not polygon.is_valid:
            raise ValueError(
                f"{name}: {shapely.is_valid_reason(polygon)}; expected a simple polygon"
            )
        check_thickness(shapely.minimum_clearance(polygon), f"{name}: thickness")
        # Between repeated positions there is no angle.
        for ring in list_rings_of_polygon(shapely.remove_repeated_points(polygon)):
            ahead, back = np.roll(ring, -1, axis=0) - ring, np.roll(ring, 1, axis=0) - ring
            angles = np.abs(np.arctan2(cross(ahead, back), (ahead * back).sum(axis=1)))
            if angles.min() < SMALLEST_ANGLE:
                raise ValueError(f"{name}: an angle below {SMALLEST_ANGLE:g} rad")
        yield Shape(name, role, polygon)


def _check_rings(geometry: dict[str, Any], name: str) -> None:
    """Raise ValueError for a ring that does not end where it begins: a position may be missing."""
    for part in geometry.get("geometries", []):
        _check_rings(part, name)
    rings = geometry.get("coordinates", [])
    if geometry["type"] == "MultiPolygon":
        rings = [ring for polygon in rings for ring in polygon]
    for first, *_, last in rings:
        if first != last:
            raise ValueError(
                f"{name}: a ring begins at {first} and ends at {last}; expected the same position"
            )


def _find_border(
    borders: list[Shape], obstacles: list[Shape], bbox: Any, margin: float | None
) -> tuple[Bounds, list[Shape]]:
    """Return the bounds of a map, and as obstacles all that lies within them and yet outside its
    border, which may have any shape.

    Raises ValueError for no border, several, or one beside a margin.
    """
    import shapely

    if len(borders) > 1:
        raise ValueError(f"{len(borders)} polygons with role border; expected one")
    if borders and margin is not None:
        raise ValueError(
            f"margin: {margin:g}: the file has a border of its own; expected no margin"
        )
    if borders or (margin is not None and obstacles):
        around = shapely.total_bounds([each.polygon for each in borders or obstacles])
        low, high = around[:2] - (margin or 0.0), around[2:] + (margin or 0.0)
    else:
        try:
            low, high = np.array(bbox, float).reshape(2, -1)[:, :2]  # without heights
        except (ValueError, TypeError, OverflowError):
            raise ValueError(
                "no border; expected a polygon with role border, "
                "a bbox of [x low, y low, x high, y high], or a margin around the obstacles"
            ) from None
    limits = float(low[0]), float(high[0]), float(low[1]), float(high[1])
    check_numbers(np.array(limits), "the border")
    check_bounds(limits)
    return limits, [
        Shape(f"{border.name}: outside of it", "obstacle", part)
        for border in borders
        for part in list_polygons(shapely.box(*low, *high).difference(border.polygon))
        if not part.is_empty
    ]


def _check_gaps(obstacles: list[Shape], frame: "shapely.Polygon") -> None:
    """Raise ValueError, naming the obstacle, for a gap that is neither closed nor open."""
    import shapely

    shapes = np.array([shape.polygon for shape in obstacles], object)
    # Near pairs only, of which there are few. A shape's gap to itself is 0, which is closed.
    near = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=SMALLEST_GAP)
    gaps = shapely.distance(shapes[near[0]], shapes[near[1]])
    for number, gap in zip(near[0], gaps):
        check_gaps(gap, obstacles[number].name)
    for shape in obstacles:
        check_gaps(shape.polygon.distance(frame.exterior), shape.name)
