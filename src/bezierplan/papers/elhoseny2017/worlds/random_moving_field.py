"""Fields of cells with circles that move from random places in random directions."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import Field

from bezierplan.schema.model import Positive
from bezierplan.workspaces import limits, moving
from bezierplan.workspaces.kinds import RandomMoving
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    from bezierplan.workspaces.worlds import MovingCircles


class Options(RandomMoving):
    """Keys of a workspace."""

    drawn_kind = "grid"
    with_side = True

    radius: Positive = Field(
        description="the radius of every circle as a share of the field's side, a number above 0"
    )


def world(description: dict, problem: dict, name: str, folder: Path, length: Any) -> MovingCircles:
    """Draw circles that move on a field, which planners see as cells.

    Raises ValueError if no place is free.
    """
    side, count = problem["side"], problem["obstacles"]
    walls = limits.bounds_of([0.0, side, 0.0, side])
    rng = generator(name, side, *problem["start"], *problem["target"], count, problem["layout"])
    radius = description["radius"] * side
    circles = moving.draw_circles(rng, description, problem, count, walls, radius)
    # Centres are reflected at the outermost cells' centres; the field reaches half a cell farther.
    return replace(circles, bounds=(-0.5, side + 0.5, -0.5, side + 0.5), view="cells")
