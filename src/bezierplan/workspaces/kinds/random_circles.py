"""Layouts of circles at random places: a layout is drawn once, from its names alone, and is used by
all methods and experiments.
"""

import math
from typing import ClassVar

import numpy as np
from pydantic import Field

from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.kinds import CIRCLES, Bounds, CircleCount, Size, Workspace
from bezierplan.workspaces.limits import check_bounds
from bezierplan.workspaces.random_field import MOST_DRAWS
from bezierplan.workspaces.seeds import generator


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
    return first(layout(description, name, problem["layout"], ends), problem["obstacles"])


def layout(description: dict, name: str, number: int, ends: list[tuple[float, float]]) -> Circles:
    """One layout of a description with bounds, radius, circles (how many) and unit.

    Centres are uniform within the bounds; a circle that covers an end, (x, y) in units, is redrawn
    (tharwat2018, Section 5.6). name: that of study and workspace; number: that of the layout.
    Circles may overlap each other. Raises ValueError if no free place is found.
    """
    rng = generator(name, number)
    x_low, x_high, y_low, y_high = map(float, description["bounds"])
    radius = float(description["radius"])
    centres = []
    for _ in range(description["circles"]):
        for _ in range(MOST_DRAWS):
            centre = rng.uniform((x_low, y_low), (x_high, y_high))
            if all(math.dist(centre, end) > radius for end in ends):
                break
        else:
            raise ValueError(
                f"radius: {radius:g}: no circle leaves start and target free in {MOST_DRAWS} draws"
            )
        centres.append(centre)
    return Circles(
        (x_low, x_high, y_low, y_high),
        np.array(centres),
        np.full(len(centres), radius),
        description["unit"],
    )


def first(circles: Circles, count: int) -> Circles:
    """The first circles of a layout: layouts with different numbers of circles are nested."""
    return Circles(circles.bounds, circles.centres[:count], circles.radii[:count], circles.unit)
