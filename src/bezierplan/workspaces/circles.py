"""Circular obstacles in a rectangle."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Circles:
    """bounds: lowest and highest x, lowest and highest y, in units. centres: (n, 2) in units. radii: (n,) in units. unit: its name."""

    bounds: tuple[float, float, float, float]
    centres: np.ndarray
    radii: np.ndarray
    unit: str
