"""The largest curvature of a path, certified: by halving its pieces, not by samples.

The curvature of a piece is p' x p'' / |p'|^3. Numerator and |p'|^2 are polynomials, which lie
between their least and their largest coefficient in Bernstein form; so the quotient of these bounds
that of the functions. A part is halved as long as its bound is above the largest curvature that is
attained so far by more than `CURVATURE_TOLERANCE`.
"""

import math
from typing import NamedTuple

import numpy as np

from bezierplan.geometry.checker.hulls import BINOMIAL, STACK, copy_points, halve
from bezierplan.kernels import allocation_free, compiled

CURVATURE_TOLERANCE = 1e-6
"""By which share the bound is above a curvature that is attained, at most."""

# A part that turns by less than this, in radians, is straight: it is rounding.
_STRAIGHT = 1e-13

# A share of a piece this short whose curvature is still not bounded stands still or turns on the
# spot.
_SHORTEST = 1e-9


class LargestCurvature(NamedTuple):
    """attained: a curvature, absolute, that the path has somewhere. bound: one that it has nowhere
    more than; infinite at a cusp, and where it stands still. Both in 1/unit; a corner between two
    pieces has none.
    """

    attained: float
    bound: float


def largest_curvature(pieces: np.ndarray) -> LargestCurvature:
    """The largest curvature of Bézier pieces (pieces, degree + 1, 2) of a degree of at most 60."""
    if pieces.shape[1] < 3:
        return LargestCurvature(0.0, 0.0)
    # Velocities are halved, not points: differences of points that are close to each other would
    # lose digits.
    return LargestCurvature(
        *_largest(
            np.ascontiguousarray((pieces.shape[1] - 1) * np.diff(pieces, axis=1), dtype=float)
        )
    )


@compiled
def _largest(velocities):
    """Both values of `LargestCurvature` from velocities' control vectors (pieces, degree, 2)."""
    stack, width = np.empty((STACK, velocities.shape[1], 2)), np.empty(STACK)
    attained = bound = 0.0
    for piece in range(len(velocities)):
        attained = max(attained, *_at_ends(velocities[piece], 1.0))
    for piece in range(len(velocities)):
        copy_points(velocities[piece], stack[0])
        width[0] = 1.0
        top = 0
        while top >= 0:
            attained = max(attained, *_at_ends(stack[top], width[top]))
            highest = _bound(stack[top], width[top])
            if highest <= attained * (1.0 + CURVATURE_TOLERANCE) or width[top] < _SHORTEST:
                bound = max(bound, highest)
                top -= 1
                continue
            halve(stack[top], stack[top + 1])
            width[top] *= 0.5
            width[top + 1] = width[top]
            top += 1
    return attained, max(attained, bound)


@allocation_free
def _at_ends(velocities, width):
    """Curvature at both ends of a part, the given share of a piece; 0 where it stands still."""
    m = len(velocities) - 1
    return _at_end(velocities[0], velocities[1], m / width), _at_end(
        velocities[m], velocities[m - 1], m / width
    )


@allocation_free
def _at_end(velocity, beside, rate):
    speed = math.hypot(velocity[0], velocity[1])
    cross = abs(velocity[0] * beside[1] - velocity[1] * beside[0])
    return rate * cross / speed**3 if cross > _STRAIGHT * speed**2 else 0.0


@allocation_free
def _bound(velocities, width):
    """What the curvature of a part of a piece is nowhere more than."""
    m = len(velocities) - 1
    slowest, fastest, largest = np.inf, 0.0, 0.0
    for k in range(2 * m + 1):
        square = 0.0
        for i in range(max(0, k - m), min(m, k) + 1):
            j = k - i
            product = velocities[i, 0] * velocities[j, 0] + velocities[i, 1] * velocities[j, 1]
            square += BINOMIAL[m, i] * BINOMIAL[m, j] * product
        square /= BINOMIAL[2 * m, k]
        slowest, fastest = min(slowest, square), max(fastest, square)
    for k in range(2 * m):
        cross = 0.0
        for i in range(max(0, k - m + 1), min(m, k) + 1):
            j = k - i
            x, y = velocities[j + 1, 0] - velocities[j, 0], velocities[j + 1, 1] - velocities[j, 1]
            cross += (
                BINOMIAL[m, i] * BINOMIAL[m - 1, j] * (velocities[i, 0] * y - velocities[i, 1] * x)
            )
        largest = max(largest, m * abs(cross) / BINOMIAL[2 * m - 1, k])
    if largest <= _STRAIGHT * fastest:
        return 0.0
    return largest / width / slowest**1.5 if slowest > 0.0 else np.inf
