"""Spheres in a box: three dimensions, which only panels of kind `spheres` show."""

from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from bezierplan.schema.model import Number
from bezierplan.workspaces.kinds import Workspace, of_length
from bezierplan.workspaces.limits import check_numbers, check_thickness
from bezierplan.workspaces.spheres import Spheres

BOUNDS = "[x low, x high, y low, y high, z low, z high]"


class Options(Workspace):
    """Keys of a workspace."""

    planar: ClassVar[bool] = False

    bounds: Annotated[list[Number], of_length(6, BOUNDS)] = Field(description=BOUNDS)
    spheres: list[Annotated[list[Number], of_length(4, "[x, y, z, radius]")]] = Field(
        description="a list of [x, y, z, radius]"
    )


def load(description: dict, folder: Path) -> Spheres:
    """The spheres that a description lists."""
    x_low, x_high, y_low, y_high, z_low, z_high = map(float, description["bounds"])
    bounds = x_low, x_high, y_low, y_high, z_low, z_high
    table = np.array(description["spheres"], dtype=float).reshape(-1, 4)
    check_numbers(table, "spheres")
    for i, radius in enumerate(table[:, 3]):
        check_thickness(radius, f"spheres: sphere {i}: radius")
    return Spheres(bounds, table[:, :3], table[:, 3], description["unit"])
