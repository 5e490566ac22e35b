"""Circles in a rectangle."""

import math
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from bezierplan.schema.model import Number
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.kinds import Bounds, Workspace, of_length
from bezierplan.workspaces.limits import check_bounds, check_gaps, check_numbers, check_thickness

MOST_CIRCLES = 10_000
"""Most circles of a workspace: their gaps are looked at in pairs."""


class Options(Workspace):
    """Keys of a workspace."""

    bounds: Bounds = Field(description="[x low, x high, y low, y high]")
    circles: list[Annotated[list[Number], of_length(3, "[x, y, radius]")]] = Field(
        description="a list of [x, y, radius]"
    )


def load(description: dict, folder: Path) -> Circles:
    """The circles that a description lists."""
    circles = description["circles"]
    if len(circles) > MOST_CIRCLES:
        raise ValueError(f"circles: {len(circles):,}; expected at most {MOST_CIRCLES:,}")
    x_low, x_high, y_low, y_high = map(float, description["bounds"])
    limits = x_low, x_high, y_low, y_high
    check_numbers(np.array(limits), "bounds")
    check_bounds(limits)
    table = np.array(circles, dtype=float).reshape(-1, 3)
    check_numbers(table, "circles")
    centres, radii = table[:, :2], table[:, 2]
    for i, (x, y, radius) in enumerate(table):
        if radius <= 0:
            raise ValueError(f"circles: circle {i}: radius {radius:g}; expected above 0")
        check_thickness(radius, f"circles: circle {i}: radius")
        if math.dist((x, y), np.clip((x, y), limits[::2], limits[1::2])) >= radius:
            raise ValueError(
                f"circles: circle {i}: lies outside the bounds; "
                "expected a circle that reaches into them"
            )
        gaps = np.hypot(*(centres[i + 1 :] - (x, y)).T) - radii[i + 1 :] - radius
        gaps = np.append(
            gaps,
            [
                x - radius - limits[0],
                limits[1] - x - radius,
                y - radius - limits[2],
                limits[3] - y - radius,
            ],
        )
        check_gaps(gaps, f"circles: circle {i}")
    return Circles(limits, centres, radii, description["unit"])
