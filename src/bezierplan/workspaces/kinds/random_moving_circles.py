"""Layouts of circles that move from random places in random directions."""

from typing import ClassVar

from pydantic import Field

from bezierplan.schema.model import Positive
from bezierplan.workspaces.kinds import CIRCLES, REFLECTED, Bounds, CircleCount, RandomMoving


class Options(RandomMoving):
    """Keys of a workspace."""

    drawn: ClassVar[str] = "circles"

    bounds: Bounds = Field(description=REFLECTED)
    radius: Positive = Field(description="the radius of every circle, a number above 0")
    circles: CircleCount = Field(description=CIRCLES)
