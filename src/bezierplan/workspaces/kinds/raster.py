"""Cells rasterized from polygons."""

from pathlib import Path
from typing import Literal

from pydantic import Field

from bezierplan.workspaces import raster
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.kinds import Size, naming, polygons


class Options(polygons.Options):
    """Keys of a workspace of kind `raster`."""

    given_kind = "grid"

    cell: Size = Field(description="the side of a cell, a number of at least 1e-6")
    rule: Literal["overlap", "centre"] = Field(
        description="which cells are occupied: "
        "those that overlap an obstacle, or whose centre lies in one"
    )


def load(description: dict, folder: Path) -> Grid:
    """Build the cells that the polygons of a GeoJSON file occupy."""
    # The keys `file` and `margin` mean the same as in the kind `polygons`.
    shapes = polygons.load(description, folder)
    with naming(description["file"]):
        return raster.from_polygons(shapes, float(description["cell"]), description["rule"])
