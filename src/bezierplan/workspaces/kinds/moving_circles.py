"""Circles that move."""

from typing import ClassVar

from pydantic import Field

from bezierplan.workspaces.kinds import REFLECTED, Bounds, World, of_length

MovingCircle = of_length(5, "[x, y, radius, x velocity, y velocity]")


class Options(World):
    """Keys of a workspace."""

    made: ClassVar[str] = "circles"

    bounds: Bounds = Field(description=REFLECTED)
    circles: list[MovingCircle] = Field(description="a list of [x, y, radius, x velocity, y velocity], velocities in units per step")
