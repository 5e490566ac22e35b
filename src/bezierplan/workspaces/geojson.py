"""Polygons from GeoJSON (RFC 7946), as studies write it and as GIS programs do: anything not
understood is rejected by name, since no obstacle may be lost.

The file is a collection of features, one feature, or a bare geometry: Polygon, MultiPolygon, or a
GeometryCollection of these. What has no `properties.role` is an obstacle. The border is the polygon
with the role `border`, of any shape; without one, the bounding box of all obstacles with a margin,
or the file's `bbox`. What lies outside of it is blocked, so obstacles are cut there. Features with
the role `start` or `target` are ignored: problems define them. A third coordinate, the height, is
dropped, and an obstacle without a geometry (null or empty, RFC 7946, 3.1 and 3.2) is skipped.
"""

import json
import logging
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from bezierplan.workspaces.limits import (
    SMALLEST_ANGLE,
    SMALLEST_FEATURE,
    SMALLEST_GAP,
    check_bounds,
    check_gaps,
    check_numbers,
    check_thickness,
)
from bezierplan.workspaces.polygons import Polygons

logger = logging.getLogger(__name__)

ROLES = ("border", "obstacle", "start", "target")

MOST_POSITIONS = 100_000
"""Most positions in a file, which its text could exceed within its own limit."""

Rings = tuple[np.ndarray, ...]
Bounds = tuple[float, float, float, float]


class Shape(NamedTuple):
    """A polygon of a file. role: border or obstacle. name: for messages. rings: each (n, 2 or 3),
    without its last position.
    """

    role: str
    name: str
    rings: Rings


def polygons_from_geojson(text: str, unit: str, margin: float | None = None) -> Polygons:
    """Polygons from the text of a GeoJSON file.

    margin: between obstacles and border, in units, of a file without a border of its own.
    Warns of heights that are dropped, of obstacles without a geometry, and of
    obstacles that are cut at the border.

    Raises ValueError, naming the feature, for text that is not GeoJSON, an unknown role, a geometry
    without an area, a ring that is not closed, positions that are not [x, y], coordinates out of
    range, no border, a margin beside a border, an obstacle that is invalid or too thin for the
    checker, and gaps that are neither closed nor open.
    """
    content = _content(text)
    shapes = [
        shape
        for number, feature in enumerate(_features(content))
        for shape in _shapes(number, feature)
    ]
    if empty := [shape.name for shape in shapes if not shape.rings]:
        logger.warning("%s: without a geometry, and skipped", _first_of(empty))
        shapes = [shape for shape in shapes if shape.rings]
    if sum(len(ring) for shape in shapes for ring in shape.rings) > MOST_POSITIONS:
        raise ValueError(f"more than {MOST_POSITIONS:,} positions; expected at most so many")
    shapes = _flat(shapes)
    for shape in shapes:
        check_numbers(np.concatenate(shape.rings), shape.name)
    obstacles = [shape for shape in shapes if shape.role == "obstacle"]
    limits, outside = _border(
        [shape for shape in shapes if shape.role == "border"],
        obstacles,
        content.get("bbox"),
        margin,
    )
    return Polygons(limits, tuple(within(limits, [*obstacles, *outside])), unit)


def _content(text: str) -> dict[str, Any]:
    try:
        content = json.loads(text, object_pairs_hook=_object, parse_constant=_no_number)
    except ValueError as error:
        raise ValueError(f"not a GeoJSON feature collection ({error})") from None
    except RecursionError:
        raise ValueError("not a GeoJSON feature collection: nested too deeply") from None
    if not isinstance(content, dict):
        raise ValueError(
            "not a GeoJSON feature collection: expected an object with a list of features"
        )
    _check_lengths(content)
    return content


def _features(content: dict[str, Any]) -> list[Any]:
    """The features of a file, which may also be one feature or a bare geometry."""
    if content.get("type") == "Feature":
        return [content]
    if content.get("type") in _GEOMETRIES and "features" not in content:
        return [{"geometry": content}]
    if not isinstance(content.get("features"), list):
        raise ValueError(
            "not a GeoJSON feature collection: expected an object with a list of features"
        )
    _check_kind("the file", content, "FeatureCollection")
    return content["features"]


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object, in which each key may occur once: of two, json would silently drop the
    first.
    """
    content = dict(pairs)
    if len(content) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(
            f"{next(name for name in names if names.count(name) > 1)!r}: this key is given twice"
        )
    return content


def _no_number(word: str) -> None:
    raise ValueError(f"{word} is not a coordinate; expected finite numbers")


def _check_kind(where: str, content: dict[str, Any], kind: str) -> None:
    """Raise ValueError unless a GeoJSON object is of a kind, or says none."""
    if content.get("type", kind) != kind:
        raise ValueError(f"{where}: type: {str(content['type'])[:60]}; expected {kind}")


def _check_lengths(content: dict[str, Any]) -> None:
    """Raise ValueError if a file says that its coordinates are angles: older GeoJSON can name the
    system of coordinates.
    """
    named = str(content.get("crs", "")).upper().replace("::", ":")
    if any(name in named for name in ("CRS84", "EPSG:4326", "WGS84", "WGS 84")):
        raise ValueError(
            "crs: longitudes and latitudes, in degrees; expected x and y as lengths, in the "
            "workspace's unit"
        )


_GEOMETRIES = ("Polygon", "MultiPolygon", "GeometryCollection")


def _shapes(number: int, feature: Any) -> Iterator[Shape]:
    """The polygons of a feature; none for a role that is not part of a workspace, and one without
    rings for an obstacle without a geometry.
    """
    if not isinstance(feature, dict):
        raise ValueError(
            f"feature {number}: {str(feature)[:60]}; expected a feature with a geometry"
        )
    _check_kind(f"feature {number}", feature, "Feature")
    properties = feature.get("properties") or {}
    role = properties.get("role", "obstacle") if isinstance(properties, dict) else properties
    if role not in ROLES:
        from bezierplan.schema.checked import closest

        raise ValueError(
            f"feature {number}: properties: role: {role!r}: unknown{closest(str(role), ROLES)}"
        )
    name = f"feature {number} ({role})"
    if role == "obstacle" and _is_empty(feature):
        yield Shape(role, name, ())
    elif role in ("border", "obstacle"):
        for rings in _polygons(feature.get("geometry"), name):
            yield Shape(role, name, rings)


def _is_empty(feature: dict[str, Any]) -> bool:
    """Whether a feature says that it has no geometry, as GIS programs write a row without one. A
    key that is missing says nothing.
    """
    geometry = feature.get("geometry", "missing")
    return geometry is None or (
        isinstance(geometry, dict)
        and geometry.get("type") in _GEOMETRIES
        and [] in (geometry.get("coordinates"), geometry.get("geometries"))
    )


def _polygons(geometry: Any, name: str) -> Iterator[Rings]:
    """The rings of each polygon of a geometry."""
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if kind not in _GEOMETRIES:
        raise ValueError(
            f"{name}: geometry: {str(kind)[:60]}; expected a Polygon, a MultiPolygon, or a "
            "GeometryCollection of these"
        )
    key = "geometries" if kind == "GeometryCollection" else "coordinates"
    parts = geometry.get(key)
    if not isinstance(parts, list) or not parts:
        raise ValueError(
            f"{name}: geometry: {key}: expected a list of "
            f"{'rings' if kind == 'Polygon' else 'polygons'}"
        )
    if kind == "GeometryCollection":
        for part in parts:
            yield from _polygons(part, name)
    else:
        for rings in parts if kind == "MultiPolygon" else [parts]:
            if not isinstance(rings, list) or not rings:
                raise ValueError(f"{name}: geometry: coordinates: expected a list of rings")
            yield tuple(_ring(ring, f"{name}: ring {place}") for place, ring in enumerate(rings))


def _ring(positions: Any, where: str) -> np.ndarray:
    """A ring (n, 2), or (n, 3) with heights, without its last position, which repeats the first."""
    if not isinstance(positions, list) or len(positions) < 4:
        raise ValueError(
            f"{where}: expected at least four positions, "
            "the last one the first again (RFC 7946, 3.1.6)"
        )
    for position in positions:
        fits = (
            isinstance(position, list)
            and len(position) in (2, 3)
            and len(position) == len(positions[0])
        )
        if not (
            fits
            and all(
                isinstance(value, int | float) and not isinstance(value, bool) for value in position
            )
        ):
            raise ValueError(
                f"{where}: position {str(position)[:60]}; "
                "expected [x, y], or [x, y, height] throughout"
            )
    try:
        ring = np.array(positions, dtype=float)
    except OverflowError:
        raise ValueError(f"{where}: a number is too large for a coordinate") from None
    if positions[0] != positions[-1]:
        raise ValueError(
            f"{where}: is not closed: begins at {positions[0]}, ends at {positions[-1]}; expected "
            "the same (RFC 7946, 3.1.6)"
        )
    return ring[:-1]


def _flat(shapes: list[Shape]) -> list[Shape]:
    """The same without heights, of which it warns."""
    heights = sum(len(ring) for shape in shapes for ring in shape.rings if ring.shape[1] == 3)
    if heights:
        logger.warning("%d positions have a height, which is dropped: the map is flat", heights)
    return [shape._replace(rings=tuple(ring[:, :2] for ring in shape.rings)) for shape in shapes]


def _border(
    borders: list[Shape], obstacles: list[Shape], bbox: Any, margin: float | None
) -> tuple[Bounds, list[Shape]]:
    """The bounds of a map, and as obstacles what lies within them and yet outside its border, which
    may have any shape.
    """
    if len(borders) > 1:
        raise ValueError(f"{len(borders)} polygons with role border; expected one")
    if borders and margin is not None:
        raise ValueError(
            f"margin: {margin:g}: the file has a border of its own; expected no margin"
        )
    if borders:
        import shapely

        name, (outer, *holes) = borders[0].name, borders[0].rings
        limits = _box([outer])
        check_bounds(limits)
        border = shapely.Polygon(outer, holes)
        if not border.is_valid:
            raise ValueError(
                f"{name}: {shapely.is_valid_reason(border)}; expected a simple polygon"
            )
        beyond = [
            part
            for part in shapely.get_parts(_frame(limits).difference(border))
            if not part.is_empty
        ]
        return limits, [
            Shape("obstacle", f"{name}: outside of it", rings_of(part)) for part in beyond
        ]
    if margin is not None:
        if not obstacles:
            raise ValueError(f"margin: {margin:g}: the file has no obstacle; expected a border")
        low_x, high_x, low_y, high_y = _box([shape.rings[0] for shape in obstacles])
        limits = (low_x - margin, high_x + margin, low_y - margin, high_y + margin)
        check_bounds(limits)
        return limits, []
    if bbox is None:
        raise ValueError(
            "no border; expected a polygon with role border, "
            "a bbox, or a margin around the obstacles"
        )
    return _checked_bbox(bbox), []


def _checked_bbox(bbox: Any) -> Bounds:
    """The bounds that a file states, with or without heights."""
    numbers = isinstance(bbox, list) and all(
        isinstance(value, int | float) and not isinstance(value, bool) for value in bbox
    )
    if not numbers or len(bbox) not in (4, 6):
        raise ValueError(f"bbox: {str(bbox)[:60]}; expected [x low, y low, x high, y high]")
    low, high = bbox[: len(bbox) // 2], bbox[len(bbox) // 2 :]
    try:
        limits = float(low[0]), float(high[0]), float(low[1]), float(high[1])
    except OverflowError:
        raise ValueError("bbox: a number is too large for a coordinate") from None
    check_numbers(np.array(limits), "bbox")
    check_bounds(limits)
    return limits


def _box(rings: list[np.ndarray]) -> Bounds:
    """Lowest and highest x, lowest and highest y."""
    positions = np.concatenate(rings)
    low, high = positions.min(axis=0).tolist(), positions.max(axis=0).tolist()
    return low[0], high[0], low[1], high[1]


def _frame(limits: Bounds) -> Any:
    import shapely

    return shapely.box(limits[0], limits[2], limits[1], limits[3])


def rings_of(polygon: Any) -> Rings:
    """The rings of a polygon of shapely, each without its last position."""
    return tuple(np.array(ring.coords)[:-1] for ring in (polygon.exterior, *polygon.interiors))


def within(limits: Bounds, obstacles: list[Shape]) -> list[Rings]:
    """The rings of obstacles, checked, and cut at the border."""
    import shapely

    frame = _frame(limits)
    shapes = np.array(
        [shapely.Polygon(polygon.rings[0], polygon.rings[1:]) for polygon in obstacles],
        dtype=object,
    )
    for polygon, shape in zip(obstacles, shapes):
        if not shape.is_valid:
            raise ValueError(
                f"{polygon.name}: {shapely.is_valid_reason(shape)}; expected a simple polygon"
            )
    for polygon, shape in zip(obstacles, shapes):
        _check_thickness(polygon.name, polygon.rings, shape)
    near = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=SMALLEST_GAP)
    for i, (polygon, shape) in enumerate(zip(obstacles, shapes)):
        beside = shapes[near[1][(near[0] == i) & (near[1] > i)]]
        check_gaps(
            np.append(shapely.distance(beside, shape), shape.distance(frame.exterior)), polygon.name
        )
    covered = shapely.covers(frame, shapes)
    over = [polygon.name for polygon, inside in zip(obstacles, covered) if not inside]
    if over:
        logger.warning("%s: beyond the border, and cut there", _first_of(over))
    kept: list[Rings] = []
    for polygon, shape, inside in zip(obstacles, shapes, covered):
        parts = (
            []
            if inside
            else [
                part
                for part in shapely.get_parts(shape.intersection(frame))
                if isinstance(part, shapely.Polygon)
            ]
        )
        kept += [polygon.rings] if inside else map(rings_of, parts)
    return kept


def _first_of(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{names[0]} and {len(names) - 1} more"


def _check_thickness(name: str, rings: Rings, shape: Any) -> None:
    """Raise ValueError, naming the obstacle and a position, for edges, angles, walls and gaps of an
    obstacle that are too small.

    Two edges that do not cross are nearest at an end of one of them. So with edges that are long
    enough and corners that are wide enough, an obstacle is as thick as its corners are far from the
    edges that they do not belong to.
    """
    import shapely

    # Repeated positions have no edge.
    rings = tuple(ring[np.any(ring != np.roll(ring, 1, axis=0), axis=1)] for ring in rings)
    corners, ends = (
        np.concatenate(rings),
        np.concatenate([np.roll(ring, -1, axis=0) for ring in rings]),
    )
    before = np.concatenate([np.roll(ring, 1, axis=0) for ring in rings])
    sides = np.hypot(*(ends - corners).T)
    k = int(sides.argmin())
    check_thickness(float(sides[k]), f"{name}: an edge at {corners[k].tolist()} of length")
    forward, back = ends - corners, before - corners
    angles = np.abs(
        np.arctan2(
            forward[:, 0] * back[:, 1] - forward[:, 1] * back[:, 0], (forward * back).sum(axis=1)
        )
    )
    k = int(angles.argmin())
    if angles[k] < SMALLEST_ANGLE:
        raise ValueError(
            f"{name}: an angle at {corners[k].tolist()} of {angles[k]:.2g} rad; expected at least "
            f"{SMALLEST_ANGLE:g}"
        )
    edges = shapely.linestrings(np.stack([corners, ends], axis=1))
    corner, edge = shapely.STRtree(edges).query(
        shapely.points(corners), predicate="dwithin", distance=SMALLEST_FEATURE
    )
    own = (corners[corner] == corners[edge]).all(axis=1) | (corners[corner] == ends[edge]).all(
        axis=1
    )
    for k, e in zip(corner[~own], edge[~own]):
        at, along = corners[k], ends[e] - corners[e]
        nearest = (
            corners[e] + np.clip((at - corners[e]) @ along / (along @ along), 0.0, 1.0) * along
        )
        apart = float(np.hypot(*(nearest - at)))
        if apart > 0 and shape.contains(shapely.Point(0.5 * (at + nearest))):
            check_thickness(apart, f"{name}: at {at.tolist()} a wall of thickness")
        else:
            check_gaps(np.array([apart]), name)
