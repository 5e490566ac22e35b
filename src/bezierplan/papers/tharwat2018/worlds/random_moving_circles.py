"""Layouts of circles that move from random places in random directions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from pydantic import Field

from bezierplan.workspaces import limits, moving
from bezierplan.workspaces.kinds import CIRCLES, REFLECTED, Bounds, CircleCount, RandomMoving, Size
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    from bezierplan.workspaces.worlds import MovingCircles


class Options(RandomMoving):
    """Keys of a workspace."""

    drawn_kind: ClassVar[str] = "circles"

    bounds: Bounds = Field(description=REFLECTED)
    radius: Size = Field(description="the radius of every circle, a number of at least 1e-6")
    circles: CircleCount = Field(description=CIRCLES)


def world(description: dict, problem: dict, name: str, folder: Path, length: Any) -> MovingCircles:
    """Draw a layout's moving circles, and keep the first `obstacles` of them.

    Raises ValueError if no free place is found.
    """
    walls = limits.bounds_of(description["bounds"])
    ends = [*problem["start"], *problem["target"]]
    rng = generator(name, *ends, problem["layout"])
    radius, count = description["radius"], problem["obstacles"]
    # All circles of the layout are drawn and the first kept: worlds with more circles contain those
    # with fewer.
    centres, velocities = moving.movement(
        rng, description, description["circles"], walls, np.reshape(ends, (2, 2)), radius
    )
    radii = np.full(len(centres[:count]), float(radius))
    return moving.circles(description, walls, centres[:count], velocities[:count], radii)
