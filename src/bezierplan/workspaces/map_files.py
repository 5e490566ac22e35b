"""Maps that people have: which kind of workspace a file is, its description with the options of a
command or a call, and the map itself.
"""

from pathlib import Path
from typing import Any

from bezierplan.schema.checked import Fault
from bezierplan.schema.model import parse
from bezierplan.workspaces import files, raster, robot
from bezierplan.workspaces.files import Workspace
from bezierplan.workspaces.kinds import kinds
from bezierplan.workspaces.polygons import Polygons

IMAGES = (".png", ".pgm", ".bmp", ".jpg", ".jpeg", ".tif", ".tiff")
KINDS = {
    ".geojson": "polygons",
    ".json": "polygons",
    ".yaml": "ros_map",
    ".yml": "ros_map",
    ".txt": "grid",
    **dict.fromkeys(IMAGES, "image"),
}
"""Suffix of a map file -> the kind of workspace that it is read as."""

CELLS = 200
"""Cells along the longer side of a map of polygons, where a planner needs cells and no side of a
cell is given.
"""


def describe(
    file: Path, *, cells: bool = False, unit: str | None = None, **options: Any
) -> dict[str, Any]:
    """Describe a map file as a workspace of a study (config/README.md).

    cells: true if polygons become a grid.
    options: keys of the kind of workspace; None stands for a key that is not given.

    Raises ValueError, naming the option, for a value that is wrong or does nothing on this kind of
    map, and for an unknown kind of file.
    """
    kind = KINDS.get(file.suffix.lower())
    if kind is None:
        raise ValueError(
            f"{file}: unknown kind of map; expected a file that ends in {', '.join(KINDS)}"
        )
    if kind == "polygons" and cells:
        kind = "raster"
    description = {name: entry for name, entry in options.items() if entry is not None}
    if kind == "grid":
        description = {"cell": 1.0} | description
    if kind == "raster":
        # By this rule, a path over free cells is also free among the polygons.
        description = {"rule": "overlap"} | description
    home = {
        "kind": kind,
        "file": file.name,
        "unit": unit or ("cell" if kind == "grid" else "m"),
    }
    for name in description:
        if name not in kinds()[kind].model_fields:
            raise ValueError(f"{name}: not for maps of kind {kind}, as {file} is")
    if kind == "raster" and "cell" not in description:
        x_low, x_high, y_low, y_high = read(file, home | description | {"kind": "polygons"}).bounds
        description["cell"] = max(x_high - x_low, y_high - y_low) / CELLS
    # The user's own file and unit are left out: limits on their names are those of studies.
    parse(kinds()[kind], home | {"unit": "m", "file": "map"} | description)
    return home | description


def read(file: Path, description: dict[str, Any], robot_radius: float | None = None) -> Workspace:
    """Read the map of a file and its description, for a robot of a radius, in units.

    Raises ValueError, which names file or option.
    """
    radius = robot_radius or 0.0
    if description["kind"] != "raster":
        return robot.grow(_load(file, description), radius)
    # It grows before it becomes cells, by the description's rule: `grow` itself knows only
    # `overlap`.
    polygons = robot.grow(_load(file, description | {"kind": "polygons"}), radius)
    assert isinstance(polygons, Polygons)  # by its kind
    return raster.from_polygons(polygons, float(description["cell"]), description["rule"])


def _load(file: Path, description: dict[str, Any]) -> Workspace:
    """Load the map of a file.

    Raises ValueError, beginning with the option `margin` or with the file as it was given.
    """
    try:
        return files.load(description, file.parent)
    except ValueError as error:
        told = str(error).removeprefix("file: ").removeprefix(f"{description['file']}: ")
        raise Fault(told if told.startswith("margin: ") else f"{file}: {told}") from None
