"""Workspaces from their descriptions and files, with every fault reported in one line; and as JSON text for tables.

A description is a mapping with `kind` and `unit` and, depending on the kind,

    grid      file (lines of . and #, top row first), cell (side of a cell), optionally heights (a file of numbers, top row first)
    circles   bounds [x low, x high, y low, y high], circles [[x, y, radius], ...]
    polygons  file (`geojson`: features with properties.role `border`, one rectangle, and `obstacle`)
    raster    file as for polygons, cell (side of a cell), rule (`overlap` or `centre`: which cells are occupied)
    ros_map   file (YAML of ROS's map_server, next to its image), optionally robot_radius, most_pixels
    moving_ai file (`.map`), optionally scenarios (`.scen`)

Coordinates are in the unit, at most 1e5 in absolute value.
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from bezierplan.workspaces import grid, moving_ai, random_field, raster, ros
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.geojson import polygons_from_geojson
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.limits import check_bounds, check_gaps, check_numbers
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.text_file import read_text

Workspace = Grid | Circles | Polygons

MOST_CIRCLES = 10_000
"""Most circles of a workspace: their gaps are looked at in pairs."""


def load(description: dict, folder: Path) -> Workspace:
    """The workspace of a description; its files are looked up in a folder.

    Raises ValueError, naming the file or the key and what is expected.
    """
    kind, unit = description["kind"], description["unit"]
    if kind == "circles":
        return _circles(description["bounds"], description["circles"], unit)
    if kind in ("ros_map", "moving_ai"):
        with _naming(description["file"]):
            options = {key: description[key] for key in ("robot_radius", "most_pixels") if key in description}
            return (ros if kind == "ros_map" else moving_ai).read(folder / description["file"], unit, **options)
    text = _text(description, "file", folder)
    with _naming(description["file"]):
        if kind == "polygons":
            return polygons_from_geojson(text, unit)
        if kind == "raster":
            return raster.from_polygons(polygons_from_geojson(text, unit), float(description["cell"]), description["rule"])
        workspace = grid.from_lines(text.splitlines(), float(description["cell"]), unit)
        check_numbers(np.array(workspace.bounds), f"cell: {description['cell']}: the border")
    if "heights" not in description:
        return workspace
    text = _text(description, "heights", folder)
    with _naming(description["heights"]):
        return replace(workspace, heights=grid.heights_from_lines(text.splitlines(), workspace.occupied.shape))


def sources(description: dict, folder: Path) -> list[Path]:
    """The files from which a workspace is read. Raises ValueError if the YAML file of a `ros_map` names no image."""
    named = [folder / description[key] for key in ("file", "heights", "scenarios") if key in description]
    if description["kind"] == "ros_map":
        with _naming(description["file"]):
            named.append(ros.image_of(named[0]))
    return named


def scenario(description: dict, number: int, workspace: Grid, folder: Path) -> moving_ai.Scenario:
    """A numbered scenario of a workspace of kind `moving_ai`. Raises ValueError, naming the file and what is expected."""
    if "scenarios" not in description:
        raise ValueError(f"scenario: {number}: the workspace has no scenarios; expected a .scen file there")
    with _naming(description["scenarios"]):
        return moving_ai.scenario(folder / description["scenarios"], number, workspace, Path(description["file"]).name)


def _text(description: dict, key: str, folder: Path) -> str:
    """The text of the file that a key of a description names."""
    with _naming(f"{key}: {description[key]}"):
        return read_text(folder / description[key])


@contextmanager
def _naming(file: str) -> Iterator[None]:
    """Prefix the message of a ValueError with the name of a file, or with a key and the file."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None


def _circles(bounds: list[float], circles: list[list[float]], unit: str) -> Circles:
    if len(circles) > MOST_CIRCLES:
        raise ValueError(f"circles: {len(circles):,}; expected at most {MOST_CIRCLES:,}")
    limits = tuple(map(float, bounds))
    check_numbers(np.array(limits), "bounds")
    check_bounds(limits)
    table = np.array(circles, dtype=float).reshape(-1, 3)
    check_numbers(table, "circles")
    centres, radii = table[:, :2], table[:, 2]
    for i, (x, y, radius) in enumerate(table):
        if radius <= 0:
            raise ValueError(f"circles: circle {i}: radius {radius:g}; expected above 0")
        gaps = np.hypot(*(centres[i + 1 :] - (x, y)).T) - radii[i + 1 :] - radius
        gaps = np.append(gaps, [x - radius - limits[0], limits[1] - x - radius, y - radius - limits[2], limits[3] - y - radius])
        check_gaps(gaps, f"circles: circle {i}")
    return Circles(limits, centres, radii, unit)


def to_json(workspace: Workspace) -> str:
    """A workspace as text; `from_json` restores it bit by bit. A random field is stored as its circles, whatever the number of its
    cells.
    """
    if isinstance(workspace, Grid) and isinstance(workspace.drawn, Circles):
        content = _circles_content(workspace.drawn) | {"kind": "random_field"}
    elif isinstance(workspace, Grid) and workspace.drawn:
        cells = {"cell": workspace.cell, "rows": grid.to_lines(workspace), "origin": workspace.origin}
        content = _polygons_content(workspace.drawn) | cells | {"kind": "raster"}
    elif isinstance(workspace, Grid):
        content = {"kind": "grid", "cell": workspace.cell, "rows": grid.to_lines(workspace)}
        if workspace.origin != (0.0, 0.0):
            content["origin"] = workspace.origin
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
        flat = replace(grid.from_lines(content["rows"], content["cell"], unit), origin=tuple(content.get("origin", (0.0, 0.0))))
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
