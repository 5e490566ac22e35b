"""Layouts of circles at random places: a layout is drawn once, from its names alone, and is used by
all methods and experiments.
"""

from typing import Any

import numpy as np
from pydantic import Field

from bezierplan.schema.model import NotNegative, build_value_type, is_number
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.kinds import CIRCLES, Bounds, SmallCount, Workspace
from bezierplan.workspaces.limits import SMALLEST_FEATURE, bounds_of, check_count
from bezierplan.workspaces.random_field import draw_centres
from bezierplan.workspaces.seeds import generator

RADIUS = (
    "the radius of every circle, a number of at least 1e-6, or [low, high], between which radii "
    "are uniform"
)


def _is_radius(entry: Any) -> bool:
    """Tell whether an entry is a radius, or two between which radii lie."""
    ends = entry if isinstance(entry, list) else [entry, entry]
    return len(ends) == 2 and all(map(is_number, ends)) and SMALLEST_FEATURE <= ends[0] <= ends[1]


Radius: Any = build_value_type(_is_radius, RADIUS)


class Options(Workspace):
    """Keys of a workspace of kind `random_circles`."""

    drawn_kind = "circles"

    bounds: Bounds = Field(description="[x low, x high, y low, y high]")
    radius: Radius = Field(description=RADIUS)
    gap: NotNegative = Field(
        0, description="the least distance of circles from start and target, in units"
    )
    circles: SmallCount = Field(description=CIRCLES)


def draw(description: dict, problem: dict, name: str) -> Circles:
    """Draw the first so many circles of a layout.

    Centres are uniform within the bounds; a circle that comes nearer to an end than the gap is
    redrawn. Circles may overlap each other.

    name: "study/workspace", which seeds the draw.

    Raises ValueError for more than it has, for bounds without room, and if no free place is found.

    Layouts with different numbers of circles are nested:

    >>> described = {"bounds": [0, 9, 0, 9], "radius": 1, "circles": 5, "unit": "m"}
    >>> place = {"start": [0, 0], "target": [9, 9], "layout": 0}
    >>> few, more = (draw(described, place | {"obstacles": n}, "study/room") for n in (2, 5))
    >>> len(more.radii), bool((more.centres[:2] == few.centres).all())
    (5, True)
    """
    count = problem["obstacles"]
    check_count(count, description["circles"])
    # Neither the number of circles nor the ends are part of the seed.
    rng = generator(name, problem["layout"])
    bounds = bounds_of(description["bounds"])
    given, gap = description["radius"], description.get("gap", 0)
    centres, radii = [], []
    for _ in range(count):
        radius = float(rng.uniform(*given) if isinstance(given, list) else given)
        # A larger circle needs a wider gap, so its radius comes first.
        centres.append(draw_centres(rng, 1, bounds, problem, radius + gap)[0])
        radii.append(radius)
    return Circles(bounds, np.reshape(centres, (-1, 2)), np.array(radii), description["unit"])
