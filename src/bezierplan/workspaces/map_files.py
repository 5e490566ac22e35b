"""Maps that people have: which kind of workspace a file is, and its description with the options of a command or a call."""

import math
from pathlib import Path
from typing import Any

from bezierplan.workspaces import files

KINDS = {".geojson": "polygons", ".json": "polygons", ".yaml": "ros_map", ".yml": "ros_map", ".map": "moving_ai", ".txt": "grid"}
"""Suffix of a map file -> the kind of workspace that it is read as."""

CELLS = 200
"""Cells along the longer side of a map of polygons, where a planner needs cells and no side of a cell is given."""


def described(
    file: Path,
    *,
    cell: float | None = None,
    rule: str | None = None,
    robot_radius: float | None = None,
    unit: str | None = None,
    most_pixels: int | None = None,
    needs_cells: bool = False,
) -> dict[str, Any]:
    """The description of a map file as a workspace of a study (config/README.md); None stands for what is not given.

    needs_cells: polygons become a grid even without a side of a cell. Raises ValueError, naming the option, for a value that is wrong or
    does nothing on this kind of map, and for an unknown kind of file.
    """
    kind = KINDS.get(file.suffix.lower())
    if kind is None:
        raise ValueError(f"{file}: unknown kind of map; expected a file that ends in {', '.join(KINDS)}")
    description: dict[str, Any] = {"kind": kind, "file": file.name, "unit": unit or ("m" if kind in ("polygons", "ros_map") else "cell")}
    if cell is not None and not 0 < cell < math.inf:
        raise ValueError(f"cell: {cell:g}; expected a number above 0")
    if rule not in (None, "overlap", "centre"):
        raise ValueError(f"rule: {rule}; expected overlap or centre")
    if robot_radius is not None and not 0 <= robot_radius < math.inf:
        raise ValueError(f"robot_radius: {robot_radius:g}; expected a number of at least 0")
    of_kind = {"polygons": ("cell", "rule"), "grid": ("cell",), "ros_map": ("robot_radius", "most_pixels"), "moving_ai": ()}[kind]
    given = {"cell": cell, "rule": rule, "robot_radius": robot_radius, "most_pixels": most_pixels}
    for name, value in given.items():
        if value is not None and name not in of_kind:
            raise ValueError(f"{name}: {value}: does nothing on {file.name}, a map of kind {kind}; expected none")
    if kind == "polygons" and (cell is not None or needs_cells):
        x_low, x_high, y_low, y_high = files.load(description, file.parent).bounds
        side = max(x_high - x_low, y_high - y_low) / CELLS if cell is None else cell
        return description | {"kind": "raster", "cell": side, "rule": rule or "overlap"}
    if rule is not None:
        raise ValueError(f"rule: {rule}: does nothing without cells; expected a cell as well")
    if kind == "grid":
        return description | {"cell": 1.0 if cell is None else cell}
    return description | {name: given[name] for name in of_kind if name != "cell" and given.get(name) is not None}


def point(name: str, text: str | None) -> tuple[float, float]:
    """A point from words such as `2.5,10`. Raises ValueError, naming the option."""
    try:
        x, y = map(float, (text or "").split(","))
    except ValueError:
        raise ValueError(f"{name}: {text or 'missing'}; expected X,Y, two numbers such as 2.5,10") from None
    if not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError(f"{name}: {text}; expected finite numbers")
    return x, y
