"""Workspaces from their descriptions (`kinds`), with every fault reported in one line; and as JSON
text for tables.
"""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from bezierplan.workspaces import grid, random_field
from bezierplan.workspaces.arrays import read_only
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.grown import Growth
from bezierplan.workspaces.polygons import Polygons

Workspace = Grid | Circles | Polygons


def load(description: dict, folder: Path) -> Workspace:
    """The workspace of a description; its files are looked up in a folder.

    Raises ValueError, naming the file or the key and what is expected.
    """
    from bezierplan.workspaces.kinds import kind_of

    return kind_of(description).load(description, folder)


def sources(description: dict, folder: Path) -> list[Path]:
    """The files from which a workspace is read. Raises ValueError if they cannot be told from the
    description.
    """
    from bezierplan.schema.model import named
    from bezierplan.workspaces.kinds import kind_of

    kind = kind_of(description)
    if hasattr(kind, "sources"):
        return kind.sources(description, folder)
    names = named(kind.Options.model_validate(description))
    return [folder / name for _, what, name in names if what == "file"]


def to_json(workspace: Workspace) -> str:
    """A workspace as text; `from_json` restores it bit by bit. A random field is stored as its
    circles, whatever the number of its cells.
    """
    if isinstance(workspace, Grid) and isinstance(workspace.shapes, Circles):
        content = _circles_content(workspace.shapes) | {"kind": "random_field"}
    elif isinstance(workspace, Grid) and isinstance(workspace.shapes, Polygons):
        cells = {
            "cell": workspace.cell,
            "rows": grid.to_lines(workspace),
            "origin": workspace.origin,
        }
        content = _polygons_content(workspace.shapes) | cells | {"kind": "raster"}
    elif isinstance(workspace, Grid):
        content = {"kind": "grid", "cell": workspace.cell, "rows": grid.to_lines(workspace)}
        if workspace.origin != (0.0, 0.0):
            content["origin"] = workspace.origin
        if workspace.heights is not None:
            content["heights"] = workspace.heights.tolist()
        content |= _growth_content(workspace.growth)
    elif isinstance(workspace, Circles):
        content = _circles_content(workspace)
    else:
        content = _polygons_content(workspace)
    return json.dumps(content | {"unit": workspace.unit})


def _polygons_content(polygons: Polygons) -> dict:
    obstacles = [[ring.tolist() for ring in rings] for rings in polygons.obstacles]
    return {
        "kind": "polygons",
        "bounds": polygons.bounds,
        "obstacles": obstacles,
    } | _growth_content(polygons.growth)


def _circles_content(circles: Circles) -> dict:
    table = np.column_stack([circles.centres, circles.radii]).tolist()
    return {"kind": "circles", "bounds": circles.bounds, "circles": table} | _growth_content(
        circles.growth
    )


def _growth_content(growth: Growth | None) -> dict:
    if growth is None:
        return {}
    return {
        "grown": {
            "radius": growth.radius,
            "original": to_json(growth.original),
            "centres": growth.centres.tolist(),
        }
    }


def _growth(content: dict) -> Growth | None:
    if "grown" not in content:
        return None
    known = content["grown"]
    return Growth(
        known["radius"],
        from_json(known["original"]),
        read_only(np.array(known["centres"], dtype=float).reshape(-1, 2), float),
    )


def from_json(text: str) -> Workspace:
    """The workspace that `to_json` wrote."""
    content = json.loads(text)
    unit = content["unit"]
    if content["kind"] == "grid":
        flat = replace(
            grid.from_lines(content["rows"], content["cell"], unit),
            origin=tuple(content.get("origin", (0.0, 0.0))),
            growth=_growth(content),
        )
        return replace(flat, heights=np.array(content["heights"])) if "heights" in content else flat
    bounds = tuple(content["bounds"])
    if content["kind"] in ("polygons", "raster"):
        obstacles = tuple(tuple(np.array(ring) for ring in rings) for rings in content["obstacles"])
        polygons = Polygons(bounds, obstacles, unit, _growth(content))
        if content["kind"] == "polygons":
            return polygons
        cells = grid.from_lines(content["rows"], content["cell"], unit)
        return replace(
            cells,
            origin=tuple(content["origin"]),
            shapes=polygons,
        )
    table = np.array(content["circles"], dtype=float).reshape(-1, 3)
    circles = Circles(bounds, table[:, :2], table[:, 2], unit, _growth(content))
    return random_field.from_circles(circles) if content["kind"] == "random_field" else circles
