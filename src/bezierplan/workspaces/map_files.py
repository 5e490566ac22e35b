"""Maps that people have: which kind of workspace a file is, its description with the options of a
command or a call, and the map itself.
"""

import math
from collections.abc import Collection
from pathlib import Path
from typing import Any

from bezierplan.schema.checked import Fault
from bezierplan.workspaces import files, raster, robot, ros
from bezierplan.workspaces.files import Workspace
from bezierplan.workspaces.geojson import polygons_from_geojson
from bezierplan.workspaces.limits import LARGEST, check_thickness
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.text_file import number, read_text

IMAGES = (".png", ".pgm", ".bmp", ".jpg", ".jpeg", ".tif", ".tiff")
KINDS = {
    ".geojson": "polygons",
    ".json": "polygons",
    ".yaml": "ros_map",
    ".yml": "ros_map",
    ".map": "moving_ai",
    ".txt": "grid",
    **dict.fromkeys(IMAGES, "image"),
}
"""Suffix of a map file -> the kind of workspace that it is read as."""

CELLS = 200
"""Cells along the longer side of a map of polygons, where a planner needs cells and no side of a
cell is given.
"""

_APPLIES = {
    "cell": ("grid", "raster"),
    "rule": ("raster",),
    "margin": ("polygons",),
    "resolution": ("image",),
    "unknown": ("ros_map", "image"),
    "most_pixels": ("ros_map", "image"),
}
"""Options that count for some kinds of workspace only: with others they would do nothing."""

_KIND_NAMES = {
    "grid": "cells of a text",
    "image": "an image",
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
    margin: float | None = None,
    resolution: float | None = None,
    unknown: str | None = None,
    most_pixels: int | None = None,
    cells: bool = False,
) -> dict[str, Any]:
    """The description of a map file as a workspace of a study (config/README.md), which has no
    kind `image`; None is what is not given.

    cells: whether polygons become a grid. Raises ValueError, naming the option, for a value that is
    wrong or does nothing on this kind of map, and for an unknown kind of file.
    """
    kind = KINDS.get(file.suffix.lower())
    if kind is None:
        raise ValueError(
            f"{file}: unknown kind of map; expected a file that ends in {', '.join(KINDS)}"
        )
    for name, length in {"cell": cell, "resolution": resolution}.items():
        if length is not None and not 0 < length < math.inf:
            raise ValueError(f"{name}: {length:g}; expected a number above 0")
    if margin is not None and not 0 <= margin < math.inf:
        raise ValueError(f"margin: {margin:g}; expected a number of at least 0")
    if margin is not None and margin > LARGEST:
        raise ValueError(f"margin: {margin:g}; expected at most {LARGEST:g}")
    if rule not in (None, "overlap", "centre"):
        raise ValueError(f"rule: {rule}; expected overlap or centre")
    if unknown not in (None, "occupied", "free"):
        raise ValueError(f"unknown: {unknown}; expected occupied or free")
    if most_pixels is not None and most_pixels < 1:
        raise ValueError(f"most_pixels: {most_pixels}; expected a whole number of at least 1")
    metres = kind in ("polygons", "ros_map", "image")
    description: dict[str, Any] = {
        "kind": kind,
        "file": file.name,
        "unit": unit or ("m" if metres else "cell"),
    }
    drawn = kind == "polygons" and cells
    options = {
        "cell": cell,
        "rule": rule,
        "margin": margin,
        "resolution": resolution,
        "unknown": unknown,
    }
    options["most_pixels"] = most_pixels
    for name, kinds in _APPLIES.items():
        if options[name] is not None and kind not in kinds and not (drawn and "raster" in kinds):
            wanted = " or ".join(_KIND_NAMES[each] for each in kinds)
            raise ValueError(
                f"{name}: only for {wanted}; {file} is {_KIND_NAMES['raster' if drawn else kind]}"
            )
    if kind == "image" and resolution is None and not file.is_file():
        raise ValueError(f"{file}: no such file; expected an image or another map")
    if kind == "image" and resolution is None:
        raise ValueError(
            "resolution: missing; expected the length of a pixel's side, or the YAML file of "
            f"{file} as the map"
        )
    if kind == "grid":
        return description | {"cell": 1.0 if cell is None else cell}
    kept = ("margin", "resolution", "unknown", "most_pixels")
    description |= {name: options[name] for name in kept if options[name] is not None}
    if not drawn:
        return description
    if cell is None:
        x_low, x_high, y_low, y_high = read(file, description).bounds
        cell = max(x_high - x_low, y_high - y_low) / CELLS
    return description | {"kind": "raster", "cell": cell, "rule": rule or "overlap"}


def read(file: Path, description: dict[str, Any], robot_radius: float | None = None) -> Workspace:
    """The map of a file and its description, for a robot of a radius, in units.

    Raises ValueError, which names file or option.
    """
    robot.check_radius(robot_radius or 0.0)
    if description["kind"] != "raster":
        return robot.grow(_loaded(file, description), robot_radius or 0.0)
    drawn = _loaded(file, description | {"kind": KINDS[file.suffix.lower()]})
    polygons = robot.grow(drawn, robot_radius or 0.0)  # before it becomes cells
    assert isinstance(polygons, Polygons)  # by its kind
    cell = float(description["cell"])
    check_thickness(cell, "cell:")
    return raster.from_polygons(polygons, cell, description["rule"])


def _loaded(file: Path, description: dict[str, Any]) -> Workspace:
    """The map of a file. Raises ValueError, beginning with the option `margin` or with the file as
    it was given.
    """
    try:
        return _read(file, description)
    except ValueError as error:
        told = str(error).removeprefix("file: ").removeprefix(f"{description['file']}: ")
        raise Fault(told if told.startswith("margin: ") else f"{file}: {told}") from None


def _read(file: Path, description: dict[str, Any]) -> Workspace:
    kind, unit = description["kind"], description["unit"]
    if kind == "polygons":
        return polygons_from_geojson(read_text(file), unit, description.get("margin"))
    options = {
        name: description[name] for name in ("unknown", "most_pixels") if name in description
    }
    if kind == "image":
        return ros.read_image(file, description["resolution"], unit, **options)
    if kind == "ros_map":
        return ros.read(file, file.parent, unit, **options)
    return files.load(description, file.parent)


def needs_cells(served: Collection[str] | None) -> bool:
    """Whether a planner that serves some kinds of workspace, None for all, excludes polygons."""
    return served is not None and "polygons" not in served


def point(name: str, text: str | None) -> tuple[float, float]:
    """A point from words such as `2.5,10`. Raises ValueError, naming the option."""
    try:
        x, y = (number(word.strip()) for word in (text or "").split(","))
    except ValueError:
        raise ValueError(
            f"{name}: {text or 'missing'}; expected X,Y, two numbers such as 2.5,10"
        ) from None
    return x, y
