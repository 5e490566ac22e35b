"""Layouts of circles at random places."""

from typing import ClassVar

from pydantic import Field

from bezierplan.workspaces import random_circles
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.kinds import CIRCLES, Bounds, CircleCount, Size, Workspace
from bezierplan.workspaces.limits import check_bounds


class Options(Workspace):
    """Keys of a workspace."""

    drawn: ClassVar[str] = "circles"

    bounds: Bounds = Field(description="[x low, x high, y low, y high]")
    radius: Size = Field(description="the radius of every circle, a number of at least 1e-6")
    circles: CircleCount = Field(description=CIRCLES)


def draw(description: dict, problem: dict, name: str) -> Circles:
    """The first so many circles of a layout. Raises ValueError for bounds without room, and if no
    free place is found.
    """
    x_low, x_high, y_low, y_high = map(float, description["bounds"])
    check_bounds((x_low, x_high, y_low, y_high))
    ends = [(float(x), float(y)) for x, y in (problem["start"], problem["target"])]
    return random_circles.first(
        random_circles.layout(description, name, problem["layout"], ends), problem["obstacles"]
    )
