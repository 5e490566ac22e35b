"""Circular obstacles in a rectangle."""

from dataclasses import dataclass

import numpy as np

from bezierplan.workspaces.arrays import freeze
from bezierplan.workspaces.grown import Growth
from bezierplan.workspaces.limits import Bounds


@dataclass(frozen=True, eq=False)
class Circles:
    """Circles in a rectangle.

    bounds: lowest and highest x, lowest and highest y, in units.
    centres: (n, 2) in units.
    radii: (n,) in units.
    unit: name of the unit of length.
    growth: the circles before they grew by a robot's radius, if they did.

    The arrays are read-only.
    """

    bounds: Bounds
    centres: np.ndarray
    radii: np.ndarray
    unit: str
    growth: Growth | None = None

    def __post_init__(self) -> None:
        freeze(self, "centres", "radii")
