"""Workspaces from their descriptions (`kinds`), with every fault reported in one line; and as JSON
text for tables.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

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
    cells = isinstance(workspace, Grid)
    shapes = workspace.shapes if isinstance(workspace, Grid) else workspace
    kind, content = "grid", _growth_content(workspace.growth)
    if isinstance(shapes, Circles):
        table = np.column_stack([shapes.centres, shapes.radii]).tolist()
        kind = "random_field" if cells else "circles"
        content |= {"bounds": shapes.bounds, "circles": table}
    if isinstance(shapes, Polygons):
        obstacles = [[ring.tolist() for ring in rings] for rings in shapes.obstacles]
        kind = "raster" if cells else "polygons"
        content |= {"bounds": shapes.bounds, "obstacles": obstacles}
        content |= _growth_content(shapes.growth)
    if isinstance(workspace, Grid) and not isinstance(shapes, Circles):
        content |= {"cell": workspace.cell, "rows": grid.to_lines(workspace)}
        content["origin"] = workspace.origin
        if workspace.heights is not None:
            content["heights"] = workspace.heights.tolist()
    return json.dumps({"kind": kind, "unit": workspace.unit} | content)


def _growth_content(growth: Growth | None) -> dict:
    if growth is None:
        return {}
    centres, original = growth.centres.tolist(), to_json(growth.original)
    return {"grown": {"radius": growth.radius, "original": original, "centres": centres}}


def _growth(content: dict) -> Growth | None:
    if "grown" not in content:
        return None
    known = content["grown"]
    return Growth(
        known["radius"],
        from_json(known["original"]),
        read_only(np.array(known["centres"], dtype=float).reshape(-1, 2), float),
    )


def from_json(text: str) -> Any:
    """The workspace that `to_json` wrote."""
    content = json.loads(text)
    unit, growth = content["unit"], _growth(content)
    bounds = tuple(content.get("bounds", ()))
    shapes: Any = None
    if "circles" in content:
        table = np.array(content["circles"], dtype=float).reshape(-1, 3)
        shapes = Circles(bounds, table[:, :2], table[:, 2], unit, growth)
    if "obstacles" in content:
        obstacles = tuple(tuple(np.array(ring) for ring in rings) for rings in content["obstacles"])
        shapes = Polygons(bounds, obstacles, unit, growth)
    if content["kind"] == "random_field":
        return random_field.from_circles(shapes)
    if "rows" not in content:
        return shapes
    return replace(
        grid.from_lines(content["rows"], content["cell"], unit),
        origin=tuple(content["origin"]),
        shapes=shapes,
        heights=np.array(content["heights"]) if "heights" in content else None,
        growth=None if shapes else growth,
    )
