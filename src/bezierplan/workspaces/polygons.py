"""Polygonal obstacles, with or without holes, in a rectangle."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Polygons:
    """bounds: lowest and highest x, lowest and highest y, in units.

    obstacles: one tuple of rings per obstacle, outer ring first, then its holes; a ring is (n, 2) in units, not closed. unit: name of the
    unit of length.
    """

    bounds: tuple[float, float, float, float]
    obstacles: tuple[tuple[np.ndarray, ...], ...]
    unit: str
