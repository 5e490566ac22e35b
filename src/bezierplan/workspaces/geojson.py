"""Polygons from GeoJSON (RFC 7946), read strictly: anything not understood is rejected by name, since no obstacle may be lost.

A feature is a Polygon with `properties.role` `border` (one, a rectangle) or `obstacle`. Features with the role `start` or `target` are
ignored: a study's problems define them.
"""

import json
from typing import Any

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

ROLES = ("border", "obstacle", "start", "target")

MOST_POSITIONS = 100_000
"""Most positions in a file, which its text could exceed within its own limit."""

Rings = tuple[np.ndarray, ...]


def polygons_from_geojson(text: str, unit: str) -> Polygons:
    """Polygons from the text of a GeoJSON file.

    Raises ValueError, naming the feature, for text that is not a feature collection, an unknown role, a geometry other than Polygon, a ring
    that is not closed, positions that are not [x, y], coordinates out of range, a border that is not a rectangle, an obstacle that is
    invalid, extends beyond the border, or is too thin for the checker, and gaps that are neither closed nor open.
    """
    shapes = [shape for number, feature in enumerate(_features(text)) if (shape := _shape(number, feature))]
    borders = [rings for role, _, rings in shapes if role == "border"]
    if len(borders) != 1:
        raise ValueError(f"{len(borders)} features with role border; expected one")
    if sum(len(ring) for _, _, rings in shapes for ring in rings) > MOST_POSITIONS:
        raise ValueError(f"more than {MOST_POSITIONS:,} positions; expected at most so many")
    outer, *holes = borders[0]
    low, high = outer.min(axis=0).tolist(), outer.max(axis=0).tolist()
    limits = (low[0], high[0], low[1], high[1])
    check_bounds(limits)
    obstacles = [(name, rings) for role, name, rings in shapes if role == "obstacle"]
    _check_shapes(limits, (outer, *holes), obstacles)
    return Polygons(limits, tuple(rings for _, rings in obstacles), unit)


def _features(text: str) -> list:
    try:
        content = json.loads(text, object_pairs_hook=_object, parse_constant=_no_number)
    except ValueError as error:
        raise ValueError(f"not a GeoJSON feature collection ({error})") from None
    except RecursionError:
        raise ValueError("not a GeoJSON feature collection: nested too deeply") from None
    if not isinstance(content, dict) or not isinstance(content.get("features"), list):
        raise ValueError("not a GeoJSON feature collection: expected an object with a list of features")
    _check_kind("the file", content, "FeatureCollection")
    _check_lengths(content)
    return content["features"]


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object, in which each key may occur once: of two, json would silently drop the first."""
    content = dict(pairs)
    if len(content) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"{next(name for name in names if names.count(name) > 1)!r}: this key is given twice")
    return content


def _no_number(word: str) -> None:
    raise ValueError(f"{word} is not a coordinate; expected finite numbers")


def _check_kind(where: str, content: dict[str, Any], kind: str) -> None:
    """Raise ValueError unless a GeoJSON object is of a kind, or says none."""
    if content.get("type", kind) != kind:
        raise ValueError(f"{where}: type: {str(content['type'])[:60]}; expected {kind}")


def _check_lengths(content: dict[str, Any]) -> None:
    """Raise ValueError if a file says that its coordinates are angles: older GeoJSON can name the system of coordinates."""
    named = str(content.get("crs", "")).upper().replace("::", ":")
    if any(name in named for name in ("CRS84", "EPSG:4326", "WGS84", "WGS 84")):
        raise ValueError("crs: longitudes and latitudes, in degrees; expected x and y as lengths, in the workspace's unit")


def _shape(number: int, feature: Any) -> tuple[str, str, Rings] | None:
    """Role, name for messages, and rings of a feature, without their last positions; None for a role that is not part of a workspace."""
    if isinstance(feature, dict):
        _check_kind(f"feature {number}", feature, "Feature")
    properties, geometry = (feature.get(key) if isinstance(feature, dict) else None for key in ("properties", "geometry"))
    if not isinstance(properties, dict) or "role" not in properties:
        raise ValueError(f"feature {number}: properties: role: missing; expected border or obstacle")
    role = properties["role"]
    if role not in ROLES:
        from bezierplan.schema.checked import closest

        raise ValueError(f"feature {number}: properties: role: {role!r}: unknown{closest(str(role), ROLES)}")
    if role in ("start", "target"):
        return None
    name = f"feature {number} ({role})"
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if kind != "Polygon":
        raise ValueError(f"{name}: geometry: {kind}; expected a Polygon, a feature for each")
    rings = geometry.get("coordinates")
    if not isinstance(rings, list) or not rings:
        raise ValueError(f"{name}: geometry: coordinates: expected a list of rings")
    return role, name, tuple(_ring(ring, f"{name}: ring {place}") for place, ring in enumerate(rings))


def _ring(positions: Any, where: str) -> np.ndarray:
    """A ring (n, 2) without its last position, which repeats the first."""
    if not isinstance(positions, list) or len(positions) < 4:
        raise ValueError(f"{where}: expected at least four positions, the last one the first again (RFC 7946, 3.1.6)")
    for position in positions:
        pair = isinstance(position, list) and len(position) == 2
        if not (pair and all(isinstance(value, int | float) and not isinstance(value, bool) for value in position)):
            raise ValueError(f"{where}: position {str(position)[:60]}; expected [x, y]")
    try:
        ring = np.array(positions, dtype=float)
    except OverflowError:
        raise ValueError(f"{where}: a number is too large for a coordinate") from None
    check_numbers(ring, where)
    if positions[0] != positions[-1]:
        raise ValueError(f"{where}: is not closed: begins at {positions[0]}, ends at {positions[-1]}; expected the same (RFC 7946, 3.1.6)")
    return ring[:-1]


def _check_shapes(limits: tuple[float, float, float, float], border: Rings, obstacles: list[tuple[str, Rings]]) -> None:
    import shapely

    frame = shapely.box(limits[0], limits[2], limits[1], limits[3])
    if not shapely.Polygon(border[0], border[1:]).equals(frame):
        raise ValueError("border: expected a rectangle with sides along the axes, without a hole")
    shapes = np.array([shapely.Polygon(rings[0], rings[1:]) for _, rings in obstacles], dtype=object)
    for (name, _), shape in zip(obstacles, shapes):
        if not shape.is_valid:
            raise ValueError(f"{name}: {shapely.is_valid_reason(shape)}; expected a simple polygon")
        if not frame.covers(shape):
            raise ValueError(f"{name}: reaches over the border")
    for (name, rings), shape in zip(obstacles, shapes):
        _check_thickness(name, rings, shape)
    near = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=SMALLEST_GAP)
    for i, ((name, _), shape) in enumerate(zip(obstacles, shapes)):
        beside = shapes[near[1][(near[0] == i) & (near[1] > i)]]
        check_gaps(np.append(shapely.distance(beside, shape), shape.distance(frame.exterior)), name)


def _check_thickness(name: str, rings: Rings, shape: Any) -> None:
    """Raise ValueError, naming the obstacle and a position, for edges, angles, walls and gaps of an obstacle that are too small.

    Two edges that do not cross are nearest at an end of one of them. So with edges that are long enough and corners that are wide enough,
    an obstacle is as thick as its corners are far from the edges that they do not belong to.
    """
    import shapely

    # Repeated positions have no edge.
    rings = tuple(ring[np.any(ring != np.roll(ring, 1, axis=0), axis=1)] for ring in rings)
    corners, ends = np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    before = np.concatenate([np.roll(ring, 1, axis=0) for ring in rings])
    sides = np.hypot(*(ends - corners).T)
    k = int(sides.argmin())
    check_thickness(float(sides[k]), f"{name}: an edge at {corners[k].tolist()} of length")
    forward, back = ends - corners, before - corners
    angles = np.abs(np.arctan2(forward[:, 0] * back[:, 1] - forward[:, 1] * back[:, 0], (forward * back).sum(axis=1)))
    k = int(angles.argmin())
    if angles[k] < SMALLEST_ANGLE:
        raise ValueError(f"{name}: an angle at {corners[k].tolist()} of {angles[k]:.2g} rad; expected at least {SMALLEST_ANGLE:g}")
    edges = shapely.linestrings(np.stack([corners, ends], axis=1))
    corner, edge = shapely.STRtree(edges).query(shapely.points(corners), predicate="dwithin", distance=SMALLEST_FEATURE)
    own = (corners[corner] == corners[edge]).all(axis=1) | (corners[corner] == ends[edge]).all(axis=1)
    for k, e in zip(corner[~own], edge[~own]):
        at, along = corners[k], ends[e] - corners[e]
        nearest = corners[e] + np.clip((at - corners[e]) @ along / (along @ along), 0.0, 1.0) * along
        apart = float(np.hypot(*(nearest - at)))
        if apart > 0 and shape.contains(shapely.Point(0.5 * (at + nearest))):
            check_thickness(apart, f"{name}: at {at.tolist()} a wall of thickness")
        else:
            check_gaps(np.array([apart]), name)
