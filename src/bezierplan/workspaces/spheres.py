"""Spherical obstacles in a box."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Spheres:
    """bounds: lowest and highest x, y and z, in units. centres: (n, 3) in units. radii: (n,) in
    units. unit: its name.
    """

    bounds: tuple[float, float, float, float, float, float]
    centres: np.ndarray
    radii: np.ndarray
    unit: str
