"""Paths for a footprint: planned for discs, and checked with the footprint itself.

The circle within the footprint is free on every path that it can follow, so the shortest path of
that disc bounds the length of all. On a path on which the circle around it is free, the footprint
is free whatever its heading. Discs between the two are tried from the smallest on, and the first
path on which the footprint is free is the answer.
"""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from bezierplan.workspaces.footprint import Footprint
from bezierplan.workspaces.grown import grown_of
from bezierplan.workspaces.limits import SMALLEST_FEATURE
from bezierplan.workspaces.problem import Workspace

DISCS = 6
"""How many radii are tried, from that of the circle within the footprint to the one around it."""

# The circle around the footprint touches its corners only; with this much more, as a share, so does
# the rounding of corners of a grown map.
_ROUNDING = 1e-9

T = TypeVar("T")

# An attempt for a disc of a radius, beside the first one, which is None as long as there is none.
Attempt = Callable[[float, T | None], T | None]


def check_map(footprint: Footprint | None, workspace: Workspace, robot_radius: float) -> None:
    """Raise ValueError for a footprint beside a radius of the robot."""
    grown = grown_of(workspace)
    if footprint and (grown or robot_radius):
        radius = grown.radius if grown else robot_radius
        raise ValueError(
            f"footprint: given beside robot_radius, {radius:g}, which is a footprint of its own; "
            "expected one of them"
        )


def radii(footprint: Footprint) -> list[float]:
    """The radii that are tried, in units; those too small for a map to grow by are 0."""
    tried = np.linspace(
        footprint.inscribed, footprint.circumscribed * (1 + _ROUNDING), DISCS
    ).tolist()
    return [0.0 if radius < SMALLEST_FEATURE else radius for radius in tried]


def first_that_holds(footprint: Footprint, attempt: Attempt, holds: Callable[[T], bool]) -> T:
    """The first of the attempts for discs of some radius that holds; if none does, the one before
    them all.

    An attempt is None if there is no path for a disc, and so for none that is larger; the first one
    never is.
    """
    smallest, *larger = radii(footprint)
    first = attempt(smallest, None)
    if holds(first):
        return first
    for radius in larger:
        found = attempt(radius, first)
        if found is None:
            break
        if holds(found):
            return found
    return first


def check_held(footprint: Footprint | None, feasible: bool) -> None:
    """Raise ValueError for a footprint that is not free along its path."""
    if footprint and not feasible:
        raise ValueError(
            "footprint: no path was found along which it is free; "
            "expected one that is, or not strict"
        )
