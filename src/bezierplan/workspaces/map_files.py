"""Maps that people have: which kind of workspace a file is, its description with the options of a command or a call, and the map itself."""

import math
from collections.abc import Collection
from pathlib import Path
from typing import Any

from bezierplan.schema.checked import Fault
from bezierplan.workspaces import files, raster, robot
from bezierplan.workspaces.files import Workspace
from bezierplan.workspaces.text_file import number

KINDS = {".geojson": "polygons", ".json": "polygons", ".yaml": "ros_map", ".yml": "ros_map", ".map": "moving_ai", ".txt": "grid"}
"""Suffix of a map file -> the kind of workspace that it is read as."""

CELLS = 200
"""Cells along the longer side of a map of polygons, where a planner needs cells and no side of a cell is given."""

_APPLIES = {"scenario": ("moving_ai",), "cell": ("grid", "raster"), "rule": ("raster",), "most_pixels": ("ros_map",)}
"""Options that count for some kinds of workspace only: with others they would do nothing."""

_KIND_NAMES = {
    "grid": "cells of a text",
    "moving_ai": "a MovingAI grid",
    "polygons": "polygons",
    "raster": "polygons for a planner that needs cells",
    "ros_map": "a ROS map",
}


def described(
    file: Path,
    *,
    cell: float | None = None,
    rule: str | None = None,
    unit: str | None = None,
    most_pixels: int | None = None,
    scenario: str | None = None,
    cells: bool = False,
) -> dict[str, Any]:
    """The description of a map file as a workspace of a study (config/README.md); None stands for what is not given.

    cells: whether polygons become a grid. Raises ValueError, naming the option, for a value that is wrong or does nothing on this kind of
    map, and for an unknown kind of file.
    """
    kind = KINDS.get(file.suffix.lower())
    if kind is None:
        raise ValueError(f"{file}: unknown kind of map; expected a file that ends in {', '.join(KINDS)}")
    if cell is not None and not 0 < cell < math.inf:
        raise ValueError(f"cell: {cell:g}; expected a number above 0")
    if rule not in (None, "overlap", "centre"):
        raise ValueError(f"rule: {rule}; expected overlap or centre")
    if most_pixels is not None and most_pixels < 1:
        raise ValueError(f"most_pixels: {most_pixels}; expected a whole number of at least 1")
    description: dict[str, Any] = {"kind": kind, "file": file.name, "unit": unit or ("m" if kind in ("polygons", "ros_map") else "cell")}
    drawn = kind == "polygons" and cells
    given = {"scenario": scenario, "cell": cell, "rule": rule, "most_pixels": most_pixels}
    for name, kinds in _APPLIES.items():
        if given[name] is not None and ("raster" if drawn else kind) not in kinds:
            wanted = " or ".join(_KIND_NAMES[each] for each in kinds)
            raise ValueError(f"{name}: only for {wanted}; {file} is {_KIND_NAMES['raster' if drawn else kind]}")
    if drawn:
        if cell is None:
            x_low, x_high, y_low, y_high = read(file, description).bounds
            cell = max(x_high - x_low, y_high - y_low) / CELLS
        return description | {"kind": "raster", "cell": cell, "rule": rule or "overlap"}
    if kind == "grid":
        return description | {"cell": 1.0 if cell is None else cell}
    return description | ({} if most_pixels is None else {"most_pixels": most_pixels})


def read(file: Path, description: dict[str, Any], robot_radius: float | None = None) -> Workspace:
    """The map of a file and its description, for a robot of a radius, in units. Raises ValueError, which names file or option."""
    robot.check_radius(robot_radius or 0.0)
    if not robot_radius:
        return _loaded(file, description)
    if description["kind"] == "raster":  # grown before it becomes cells
        polygons = robot.grow(_loaded(file, {key: description[key] for key in ("file", "unit")} | {"kind": "polygons"}), robot_radius)
        return raster.from_polygons(polygons, float(description["cell"]), description["rule"])
    return robot.grow(_loaded(file, description), robot_radius)


def _loaded(file: Path, description: dict[str, Any]) -> Workspace:
    """The map of a file. Raises ValueError, beginning with the file as it was given."""
    try:
        return files.load(description, file.parent)
    except ValueError as error:
        told = str(error).removeprefix("file: ").removeprefix(f"{description['file']}: ")
        raise Fault(f"{file}: {told}") from None


def needs_cells(served: Collection[str] | None) -> bool:
    """Whether a planner that serves some kinds of workspace, None for all, does not serve polygons."""
    return served is not None and "polygons" not in served


def point(name: str, text: str | None) -> tuple[float, float]:
    """A point from words such as `2.5,10`. Raises ValueError, naming the option."""
    try:
        x, y = (number(word.strip()) for word in (text or "").split(","))
    except ValueError:
        raise ValueError(f"{name}: {text or 'missing'}; expected X,Y, two numbers such as 2.5,10") from None
    return x, y
