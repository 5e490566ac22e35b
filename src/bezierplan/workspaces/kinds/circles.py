"""Circles in a rectangle."""

from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field

from bezierplan.schema.model import Number
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.kinds import Bounds, Workspace, build_numbers_type
from bezierplan.workspaces.limits import bounds_of, check_gaps, check_numbers, check_thickness

Circle: Any = build_numbers_type(3, "[x, y, radius]")


class Options(Workspace):
    """Keys of a workspace of kind `circles`."""

    bounds: Bounds = Field(description="[x low, x high, y low, y high]")
    circles: list[Circle] = Field(description="a list of [x, y, radius]")
    radius: Number = Field(None, description="one radius for all circles, instead of their own")


def load(description: dict, folder: Path) -> Circles:
    """Build the circles that a description lists.

    Raises ValueError, naming the circle, for one that is too small, lies outside the bounds, or
    leaves a gap that is neither closed nor open.

    >>> room = load({"bounds": [0, 4, 0, 3], "circles": [[2, 1.5, 0.5]], "unit": "m"}, Path())
    >>> room.centres.tolist(), room.radii.tolist()
    ([[2.0, 1.5]], [0.5])
    """
    limits = bounds_of(description["bounds"])
    table = np.array(description["circles"], float).reshape(-1, 3)
    table[:, 2] = description.get("radius", table[:, 2])
    check_numbers(table, "circles")
    centres, radii = table[:, :2], table[:, 2]
    inside = np.clip(centres, limits[::2], limits[1::2])
    outside = np.hypot(*(centres - inside).T) >= radii
    walls = np.hstack([centres - limits[::2], limits[1::2] - centres]) - radii[:, None]
    for i, (centre, radius) in enumerate(zip(centres, radii)):
        check_thickness(radius, f"circles: circle {i}: radius")
        # The border may cut a circle; one beyond it would be no obstacle.
        if outside[i]:
            raise ValueError(f"circles: circle {i}: lies outside the bounds")
        # Each pair once, with the circles behind this one.
        gaps = np.hypot(*(centres[i + 1 :] - centre).T) - radii[i + 1 :] - radius
        check_gaps(np.append(gaps, walls[i]), f"circles: circle {i}")
    return Circles(limits, centres, radii, description["unit"])
