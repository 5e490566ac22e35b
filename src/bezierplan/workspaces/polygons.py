"""Polygonal obstacles, with or without holes, in a rectangle."""

from dataclasses import dataclass

import numpy as np

from bezierplan.workspaces.arrays import read_only
from bezierplan.workspaces.grown import Grown


@dataclass(frozen=True)
class Polygons:
    """bounds: lowest and highest x, lowest and highest y, in units.

    obstacles: one tuple of rings per obstacle, outer ring first, then its holes; a ring is (n, 2)
    in units, not closed. unit: name of the unit of length. grown: what they were before they grew
    by a robot's radius, if they did. The arrays are read-only.
    """

    bounds: tuple[float, float, float, float]
    obstacles: tuple[tuple[np.ndarray, ...], ...]
    unit: str
    grown: Grown | None = None

    def __post_init__(self) -> None:
        obstacles = tuple(
            tuple(read_only(ring, float) for ring in rings) for rings in self.obstacles
        )
        object.__setattr__(self, "obstacles", obstacles)
