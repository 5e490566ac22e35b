"""Whether a path enters the blocked region at all: what a search asks of each of its steps.

In a file of its own: what runs store depends on `collision`, and on this only where paths with a
turning radius are searched.
"""

import numpy as np

from bezierplan.geometry.checker.certificates import is_blocked, is_free
from bezierplan.geometry.checker.hulls import STACK, TOLERANCE, copy_points, size, split_top
from bezierplan.geometry.region import Region
from bezierplan.kernels import compiled


@compiled
def collides(pieces: np.ndarray, region: Region) -> bool:
    """Whether any of some pieces (n, degree + 1, 2) has a collision, by the same certificates and
    at the same points as `collision.first_collision`.

    Every point that it would look at is looked at before what lies to the left of it. So a piece
    that leads far into an obstacle is given up at once, and not where it enters, after some thirty
    halvings.
    """
    for piece in range(len(pieces)):
        if is_blocked(pieces[piece, -1, 0], pieces[piece, -1, 1], region):
            return True
    if is_blocked(pieces[0, 0, 0], pieces[0, 0, 1], region):
        return True
    stack = np.empty((STACK, pieces.shape[1], 2))
    begin = np.empty(STACK)
    width = np.empty(STACK)
    for piece in range(len(pieces)):
        copy_points(pieces[piece], stack[0])
        begin[0] = 0.0
        width[0] = 1.0
        top = 0
        while top >= 0:
            if is_free(stack[top], region) or size(stack[top]) <= TOLERANCE:
                top -= 1
                continue
            split_top(stack, begin, width, top)
            if is_blocked(stack[top, 0, 0], stack[top, 0, 1], region):
                return True
            top += 1
    return False
