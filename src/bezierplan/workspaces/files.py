"""Workspaces from their descriptions and files, with every fault told in one line; and as JSON text for tables.

A description is a mapping with `kind` and `unit` and, by kind,

    grid      file (lines of . and #, top row first), cell (side of a cell), perhaps heights (a file of numbers, top row first)
    circles   bounds [x low, x high, y low, y high], circles [[x, y, radius], ...]
    polygons  file (GeoJSON: features with properties.role `border`, one rectangle, and `obstacle`)
    raster    file as of polygons, cell (side of a cell), rule (`overlap` or `centre`: which cells are occupied)

Coordinates are numbers of the unit, at most 1e5 in size.
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from bezierplan.workspaces import grid, random_field, raster
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.polygons import Polygons

Workspace = Grid | Circles | Polygons

LARGEST = 1e5
# Between obstacles, or an obstacle and the border, a gap smaller than this is meant to be closed: the checker's tolerance could not tell.
SMALLEST_GAP = 1e-7


def load(description: dict, folder: Path) -> Workspace:
    """The workspace of a description; its file is sought in a folder.

    Raises ValueError, naming the file or the key and what would be right.
    """
    kind, unit = description["kind"], description["unit"]
    if kind == "circles":
        return _circles(description["bounds"], description["circles"], unit)
    text = _text(description, "file", folder)
    with _naming(description["file"]):
        if kind == "polygons":
            return polygons_from_geojson(text, unit)
        if kind == "raster":
            return raster.from_polygons(polygons_from_geojson(text, unit), float(description["cell"]), description["rule"])
        workspace = grid.from_lines(text.splitlines(), float(description["cell"]), unit)
    if "heights" not in description:
        return workspace
    text = _text(description, "heights", folder)
    with _naming(description["heights"]):
        return replace(workspace, heights=grid.heights_from_lines(text.splitlines(), workspace.occupied.shape))


def _text(description: dict, key: str, folder: Path) -> str:
    """The text of the file that a key of a description names."""
    try:
        return (folder / description[key]).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{key}: {description[key]}: cannot be read ({type(error).__name__})") from None


@contextmanager
def _naming(file: str) -> Iterator[None]:
    """Put the name of a file before what a ValueError says."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None


def _check_numbers(values: np.ndarray, where: str) -> None:
    wrong = values[~(np.abs(values) <= LARGEST)]
    if wrong.size:
        raise ValueError(f"{where}: {wrong[0]:g} is not a coordinate; expected finite numbers of at most {LARGEST:g} in size")


def _check_bounds(bounds: tuple[float, float, float, float]) -> None:
    if not (bounds[0] < bounds[1] and bounds[2] < bounds[3]):
        raise ValueError(f"bounds: {list(bounds)}; expected [x low, x high, y low, y high] with low below high")


def _circles(bounds: list[float], circles: list[list[float]], unit: str) -> Circles:
    limits = tuple(map(float, bounds))
    _check_numbers(np.array(limits), "bounds")
    _check_bounds(limits)
    table = np.array(circles, dtype=float).reshape(-1, 3)
    _check_numbers(table, "circles")
    centres, radii = table[:, :2], table[:, 2]
    for i, (x, y, radius) in enumerate(table):
        if radius <= 0:
            raise ValueError(f"circles: circle {i}: radius {radius:g}; expected above 0")
        gaps = np.hypot(*(centres[i + 1 :] - (x, y)).T) - radii[i + 1 :] - radius
        gaps = np.append(gaps, [x - radius - limits[0], limits[1] - x - radius, y - radius - limits[2], limits[3] - y - radius])
        _check_gaps(gaps, f"circles: circle {i}")
    return Circles(limits, centres, radii, unit)


def _check_gaps(gaps: np.ndarray, where: str) -> None:
    if np.any((gaps > 0) & (gaps < SMALLEST_GAP)):
        raise ValueError(f"{where}: a gap below {SMALLEST_GAP:g} beside it; close it or make it wider")


def polygons_from_geojson(text: str, unit: str) -> Polygons:
    """Polygons from the text of a GeoJSON file.

    Raises ValueError for text that is not such a file, a border that is no rectangle, an obstacle that is invalid or reaches over the
    border, coordinates out of range, and gaps that are neither closed nor open.
    """
    try:
        features = json.loads(text)["features"]
        shapes = [(f["properties"]["role"], f["geometry"]["coordinates"], f["properties"].get("id")) for f in features]
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"not a GeoJSON feature collection with properties.role ({type(error).__name__}: {error})") from None
    borders = [rings for role, rings, _ in shapes if role == "border"]
    if len(borders) != 1:
        raise ValueError(f"{len(borders)} features with role border; expected one")
    border = np.array(borders[0][0], dtype=float)
    _check_numbers(border, "border")
    low, high = border.min(axis=0), border.max(axis=0)
    limits = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
    _check_bounds(limits)
    obstacles = []
    for number, (role, rings, name) in enumerate(shapes):
        if role == "obstacle":
            arrays = tuple(np.array(ring, dtype=float)[:-1] for ring in rings)
            _check_numbers(np.concatenate(arrays), f"obstacle {number if name is None else name}")
            obstacles.append(arrays)
    _check_shapes(limits, border, obstacles)
    return Polygons(limits, tuple(obstacles), unit)


def _check_shapes(limits: tuple[float, float, float, float], border: np.ndarray, obstacles: list[tuple[np.ndarray, ...]]) -> None:
    import shapely

    frame = shapely.box(limits[0], limits[2], limits[1], limits[3])
    if not shapely.Polygon(border).equals(frame):
        raise ValueError("border: expected a rectangle with sides along the axes")
    shapes = [shapely.Polygon(rings[0], rings[1:]) for rings in obstacles]
    for i, shape in enumerate(shapes):
        if not shape.is_valid:
            raise ValueError(f"obstacle {i}: {shapely.is_valid_reason(shape)}; expected a simple polygon")
        if not frame.covers(shape):
            raise ValueError(f"obstacle {i}: reaches over the border")
        gaps = np.append(shapely.distance(shapes[i + 1 :], shape), shape.distance(frame.exterior))
        _check_gaps(gaps, f"obstacle {i}")


def to_json(workspace: Workspace) -> str:
    """A workspace as text; `from_json` gives it back, bit by bit. A random field is its circles, whatever the number of its cells."""
    if isinstance(workspace, Grid) and isinstance(workspace.drawn, Circles):
        content = _circles_content(workspace.drawn) | {"kind": "random_field"}
    elif isinstance(workspace, Grid) and workspace.drawn:
        cells = {"cell": workspace.cell, "rows": grid.to_lines(workspace), "origin": workspace.origin}
        content = _polygons_content(workspace.drawn) | cells | {"kind": "raster"}
    elif isinstance(workspace, Grid):
        content = {"kind": "grid", "cell": workspace.cell, "rows": grid.to_lines(workspace)}
        if workspace.heights is not None:
            content["heights"] = workspace.heights.tolist()
    elif isinstance(workspace, Circles):
        content = _circles_content(workspace)
    else:
        content = _polygons_content(workspace)
    return json.dumps(content | {"unit": workspace.unit})


def _polygons_content(polygons: Polygons) -> dict:
    obstacles = [[ring.tolist() for ring in rings] for rings in polygons.obstacles]
    return {"kind": "polygons", "bounds": polygons.bounds, "obstacles": obstacles}


def _circles_content(circles: Circles) -> dict:
    table = np.column_stack([circles.centres, circles.radii]).tolist()
    return {"kind": "circles", "bounds": circles.bounds, "circles": table}


def from_json(text: str) -> Workspace:
    """The workspace that `to_json` wrote."""
    content = json.loads(text)
    unit = content["unit"]
    if content["kind"] == "grid":
        flat = grid.from_lines(content["rows"], content["cell"], unit)
        return replace(flat, heights=np.array(content["heights"])) if "heights" in content else flat
    bounds = tuple(content["bounds"])
    if content["kind"] in ("polygons", "raster"):
        obstacles = tuple(tuple(np.array(ring) for ring in rings) for rings in content["obstacles"])
        polygons = Polygons(bounds, obstacles, unit)
        if content["kind"] == "polygons":
            return polygons
        cells = grid.from_lines(content["rows"], content["cell"], unit)
        return replace(cells, origin=tuple(content["origin"]), drawn=polygons)
    table = np.array(content["circles"], dtype=float).reshape(-1, 3)
    circles = Circles(bounds, table[:, :2], table[:, 2], unit)
    return random_field.from_circles(circles) if content["kind"] == "random_field" else circles
