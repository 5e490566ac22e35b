"""Circles that move."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field

from bezierplan.workspaces import limits, moving
from bezierplan.workspaces.kinds import REFLECTED, Bounds, World, build_numbers_type

if TYPE_CHECKING:
    from bezierplan.workspaces.worlds import MovingCircles

MovingCircle: Any = build_numbers_type(5, "[x, y, radius, x velocity, y velocity]")


class Options(World):
    """Keys of a workspace of kind `moving_circles`."""

    given_kind = "circles"

    bounds: Bounds = Field(description=REFLECTED)
    circles: list[MovingCircle] = Field(
        description="a list of [x, y, radius, x velocity, y velocity], velocities in units per step"
    )


def world(description: dict, problem: dict, name: str, folder: Path, length: Any) -> MovingCircles:
    """Build the circles that a description lists.

    Raises ValueError for a centre outside the bounds, or a radius that is too small.

    A circle moves by its velocity in each step, and is reflected at the bounds:

    >>> one = {"bounds": [0, 4, 0, 3], "circles": [[3, 1, 0.5, 0.75, 0]], "unit": "m"}
    >>> moving = world(one | {"pace": 1, "steps": 9}, {}, "", Path(), None)
    >>> [moving.at(step).tolist() for step in (1, 2)]
    [[[3.75, 1.0]], [[3.5, 1.0]]]
    """
    walls = limits.bounds_of(description["bounds"])
    table = np.array(description["circles"], float).reshape(-1, 5)
    centres, radii, velocities = table[:, :2], table[:, 2], table[:, 3:]
    low, high = np.reshape(walls, (2, 2)).T
    if ((centres < low) | (centres > high)).any():
        raise ValueError(
            f"circles: a centre lies outside bounds {list(walls)}; centres are reflected there"
        )
    return moving.circles(description, walls, centres, velocities, radii)
