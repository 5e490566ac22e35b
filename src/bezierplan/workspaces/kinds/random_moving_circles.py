"""Layouts of circles that move from random places in random directions."""

from typing import ClassVar

from pydantic import Field

from bezierplan.workspaces.kinds import CIRCLES, REFLECTED, Bounds, CircleCount, RandomMoving, Size


class Options(RandomMoving):
    """Keys of a workspace."""

    drawn: ClassVar[str] = "circles"

    bounds: Bounds = Field(description=REFLECTED)
    radius: Size = Field(description="the radius of every circle, a number of at least 1e-6")
    circles: CircleCount = Field(description=CIRCLES)
