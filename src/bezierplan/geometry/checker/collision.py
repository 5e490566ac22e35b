"""The search for the first collision: certified halving."""

import math

import numpy as np

from bezierplan.geometry.checker.certificates import is_blocked, is_free
from bezierplan.geometry.checker.hulls import STACK, TOLERANCE, copy_points, halve, measure_size
from bezierplan.geometry.region import Region
from bezierplan.kernels import compile_kernel

# A parameter interval this short that ends at a blocked point is reported as the collision.
_SHORTEST_INTERVAL = 1e-11


@compile_kernel
def find_first_collision(pieces: np.ndarray, region: Region) -> tuple[float, int]:
    """Return where a path of Bézier pieces first collides, and the number of intervals examined.

    pieces: (pieces, degree + 1, 2). The place is the piece's number plus the parameter in it,
    infinite if there is no collision.

    Depth first, left half first: everything before the current interval is certified free.
    """
    stack = np.empty((STACK, pieces.shape[1], 2))
    begin = np.empty(STACK)
    width = np.empty(STACK)
    intervals = 0
    for piece in range(len(pieces)):
        copy_points(pieces[piece], stack[0])
        begin[0] = 0.0
        width[0] = 1.0
        top = 0
        while top >= 0:
            points = stack[top]
            intervals += 1
            if is_free(points, region):
                top -= 1
            elif is_blocked(points[0, 0], points[0, 1], region):
                return piece + begin[top], intervals
            elif width[top] < _SHORTEST_INTERVAL and is_blocked(
                points[-1, 0], points[-1, 1], region
            ):
                return piece + begin[top] + width[top], intervals
            # Both tests are undecided only close to the boundary: what is as small as the tolerance
            # is let pass, no deeper than twice that.
            elif measure_size(points) <= TOLERANCE:
                top -= 1
            else:
                # The right half stays, and the left half is put on it.
                halve(points, stack[top + 1])
                width[top] *= 0.5
                width[top + 1] = width[top]
                begin[top + 1] = begin[top]
                begin[top] += width[top]
                top += 1
    return math.inf, intervals
