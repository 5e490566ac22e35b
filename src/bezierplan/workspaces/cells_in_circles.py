"""The cells of a square field that lie in circles; a file of its own, for a start that only reads
descriptions needs no kernels.
"""

import math

import numpy as np

from bezierplan.kernels import allocation_free


@allocation_free
def occupy(occupied: np.ndarray, centres: np.ndarray, radii: np.ndarray) -> None:
    """Mark, in place, the cells (side, side) whose centres, the points with integer coordinates,
    lie in circles: centres (n, 2), radii (n,), in cells.
    """
    last = len(occupied) - 1
    for k in range(len(radii)):
        x, y, radius = centres[k, 0], centres[k, 1], radii[k]
        for row in range(max(0, math.ceil(y - radius)), min(last, math.floor(y + radius)) + 1):
            # Only the cells of the circle's bounding square.
            for column in range(
                max(0, math.ceil(x - radius)), min(last, math.floor(x + radius)) + 1
            ):
                if math.hypot(column - x, row - y) <= radius:
                    occupied[row, column] = True
