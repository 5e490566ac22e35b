"""The corner-cutting rule `closed`: whether a path passes between two occupied cells that share
only a corner.
"""

import math

import numpy as np

from bezierplan.geometry.checker.hulls import STACK, box, copy_points, size, split_top
from bezierplan.kernels import compiled

# Radius, in cells, of the disc around a contact in which the rule examines where a path comes from
# and goes to.
CONTACT_RADIUS = 1e-6


@compiled
def first_corner_cut(pieces: np.ndarray, contacts: np.ndarray, radius: float) -> float:
    """Piece number plus parameter at which a path first passes a closed contact of two occupied
    cells, infinite if it never does.
    """
    first = math.inf
    for k in range(len(contacts)):
        first = min(
            first, _corner_cut_at(pieces, contacts[k, 0], contacts[k, 1], contacts[k, 2], radius)
        )
    return first


@compiled
def _corner_cut_at(pieces: np.ndarray, x: float, y: float, slope: float, radius: float) -> float:
    """Piece number plus parameter at which a path first passes one contact, infinite if it never
    does.

    Around a contact a free path stays in the two free quadrants, which meet only at the contact. So
    it passes the contact if it enters and leaves a small disc around it on different sides of the
    diagonal through the occupied cells. A path that begins in the disc may leave it on either side.
    """
    stack = np.empty((STACK, pieces.shape[1], 2))
    begin = np.empty(STACK)
    width = np.empty(STACK)
    inside = math.hypot(pieces[0, 0, 0] - x, pieces[0, 0, 1] - y) < radius
    came_from = 0.0 if inside else pieces[0, 0, 0] - x + slope * (pieces[0, 0, 1] - y)
    nearest = math.inf
    nearest_at = 0.0
    for piece in range(len(pieces)):
        copy_points(pieces[piece], stack[0])
        begin[0] = 0.0
        width[0] = 1.0
        top = 0
        while top >= 0:
            points = stack[top]
            left, right, bottom, upper = box(points)
            apart = (
                left > x + radius or right < x - radius or bottom > y + radius or upper < y - radius
            )
            if not apart and size(points) > radius / 8:
                split_top(stack, begin, width, top)
                top += 1
                continue
            distance = math.hypot(points[-1, 0] - x, points[-1, 1] - y)
            side = points[-1, 0] - x + slope * (points[-1, 1] - y)
            if distance >= radius:
                if inside and came_from * side < 0.0:
                    return nearest_at
                inside = False
                came_from = side
                nearest = math.inf
            else:
                inside = True
                if distance < nearest:
                    nearest = distance
                    nearest_at = piece + begin[top] + width[top]
            top -= 1
    return math.inf
