"""Layouts of circles that move from random places in random directions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import Field

from bezierplan.workspaces import limits, moving
from bezierplan.workspaces.kinds import CIRCLES, REFLECTED, Bounds, RandomMoving, Size, SmallCount
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    from bezierplan.workspaces.worlds import MovingCircles


class Options(RandomMoving):
    """Keys of a workspace."""

    drawn_kind = "circles"

    bounds: Bounds = Field(description=REFLECTED)
    radius: Size = Field(description="the radius of every circle, a number of at least 1e-6")
    circles: SmallCount = Field(description=CIRCLES)


def world(description: dict, problem: dict, name: str, folder: Path, length: Any) -> MovingCircles:
    """Draw a layout's moving circles, and keep the first `obstacles` of them.

    Raises ValueError if no free place is found.
    """
    walls = limits.bounds_of(description["bounds"])
    rng = generator(name, *problem["start"], *problem["target"], problem["layout"])
    # All circles of the layout are drawn and the first kept: worlds with more circles contain those
    # with fewer.
    return moving.draw_circles(
        rng, description, problem, description["circles"], walls, description["radius"]
    )
