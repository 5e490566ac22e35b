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

KINDS = {"grid": Grid, "circles": Circles, "polygons": Polygons}
"""Kind of a workspace, as planners name it -> its type."""


def load(description: dict, folder: Path) -> Workspace:
    """Load the workspace of a description; its files are looked up in a folder.

    Raises ValueError, naming the file or the key and what is expected.
    """
    from bezierplan.workspaces.kinds import kind_of

    return kind_of(description).load(description, folder)


def sources(description: dict, folder: Path) -> list[Path]:
    """List the files from which a workspace is read.

    Raises ValueError if they cannot be told from the description.
    """
    from bezierplan.schema.model import find_names
    from bezierplan.workspaces.kinds import kind_of

    kind = kind_of(description)
    if hasattr(kind, "sources"):
        return kind.sources(description, folder)
    names = find_names(kind.Options.model_validate(description))
    return [folder / name for _, what, name in names if what == "file"]


def write_json(workspace: Workspace) -> str:
    """Write a workspace as text; `read_json` restores it bit by bit.

    A random field is stored as its circles, whatever the number of its cells.
    """
    return json.dumps(_build_content(workspace) | {"unit": workspace.unit})


def _build_content(workspace: Workspace) -> dict:
    """Build the content of a workspace's text."""
    if isinstance(workspace, Circles):
        table = np.column_stack([workspace.centres, workspace.radii]).tolist()
        content = {"kind": "circles", "bounds": workspace.bounds, "circles": table}
    elif isinstance(workspace, Polygons):
        obstacles = [[ring.tolist() for ring in rings] for rings in workspace.obstacles]
        content = {"kind": "polygons", "bounds": workspace.bounds, "obstacles": obstacles}
    elif isinstance(workspace.shapes, Circles):
        return _build_content(workspace.shapes) | {"kind": "random_field"}
    else:
        cells = {"cell": workspace.cell, "rows": grid.to_lines(workspace)}
        if workspace.shapes or workspace.origin != (0.0, 0.0):
            cells["origin"] = workspace.origin
        if workspace.shapes:
            return _build_content(workspace.shapes) | cells | {"kind": "raster"}
        content = {"kind": "grid"} | cells
        if workspace.heights is not None:
            content["heights"] = workspace.heights.tolist()
    if growth := workspace.growth:
        content["grown"] = {
            "radius": growth.radius,
            "original": write_json(growth.original),
            "centres": growth.centres.tolist(),
        }
    return content


def read_json(text: str) -> Workspace:
    """Read the workspace that `write_json` wrote."""
    content = json.loads(text)
    kind, unit, growth = content["kind"], content["unit"], None
    if grown := content.get("grown"):
        centres = read_only(np.reshape(grown["centres"], (-1, 2)), float)
        growth = Growth(grown["radius"], read_json(grown["original"]), centres)
    if "circles" in content:
        table = np.reshape(content["circles"], (-1, 3))
        circles = Circles(tuple(content["bounds"]), table[:, :2], table[:, 2], unit, growth)
        return random_field.from_circles(circles) if kind == "random_field" else circles
    shapes = None
    if "obstacles" in content:
        shapes = Polygons(tuple(content["bounds"]), content["obstacles"], unit, growth)
        if kind == "polygons":
            return shapes
    cells = grid.from_lines(content["rows"], content["cell"], unit)
    # Cells drawn from shapes have not grown themselves: the shapes have.
    return replace(
        cells,
        origin=tuple(content.get("origin", cells.origin)),
        shapes=shapes,
        heights=content.get("heights"),
        growth=None if shapes else growth,
    )
