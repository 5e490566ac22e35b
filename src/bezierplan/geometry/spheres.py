"""Paths among spheres in a box: the collision check, arc length, and a bound that no free path
beats.

On a Bézier piece the squared distance to a centre, and the distance to a wall, are polynomials:
they are least at an end or where their derivative is 0.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.polynomial import Polynomial

from bezierplan.geometry.curves import bernstein
from bezierplan.workspaces.spheres import Spheres

TOLERANCE = 1e-9
"""Depth, in units, up to which a path is free."""


def is_free(pieces: np.ndarray, spheres: Spheres) -> bool:
    """Whether a path of Bézier pieces (pieces, degree + 1, 3), in units, stays outside all spheres
    and inside the box.

    Touching is allowed.
    """
    walls = np.reshape(spheres.bounds, (3, 2))
    for piece in pieces:
        n = len(piece) - 1
        powers = [math.comb(n, j) * np.diff(piece, j, axis=0)[0] for j in range(n + 1)]
        axes = list(map(Polynomial, np.transpose(powers)))
        for along, (low, high) in zip(axes, walls):
            if min(_least(along) - low, high + _least(-along)) < -TOLERANCE:
                return False
        for centre, radius in zip(spheres.centres, spheres.radii):
            square = sum((along - at) ** 2 for along, at in zip(axes, centre))
            if math.sqrt(max(_least(square), 0.0)) < radius - TOLERANCE:
                return False
    return True


def _least(polynomial: Polynomial) -> float:
    """The least value of a polynomial on [0, 1]."""
    stationary = np.clip(polynomial.deriv().roots().real, 0.0, 1.0)
    return float(polynomial(np.append(stationary, [0.0, 1.0])).min())


def length(pieces: np.ndarray) -> float:
    """Arc length of Bézier pieces (pieces, degree + 1, 3), in their unit, to a relative 1e-10."""
    from scipy import integrate

    degree, steps = pieces.shape[1] - 1, np.diff(pieces, axis=1)

    def speed(t: float, step: np.ndarray) -> float:
        return degree * math.hypot(*(bernstein(degree - 1, np.array([t]))[0] @ step))

    return math.fsum(
        integrate.quad(speed, 0.0, 1.0, args=(step,), epsabs=1e-12, epsrel=1e-10, limit=200)[0]
        for step in steps
    )


def least_length(spheres: Spheres, start: Sequence[float], target: Sequence[float]) -> float:
    """The largest of the lengths of the exact shortest paths around each sphere alone, in units: no
    free path is shorter.

    It is the length of the shortest path itself if the path around one of them meets neither
    another sphere nor a wall. Start and target must be free.
    """
    around = (shortest_around(start, target, *each) for each in zip(spheres.centres, spheres.radii))
    return max(around, default=math.dist(start, target))


def shortest_around(
    start: Sequence[float], target: Sequence[float], centre: np.ndarray, radius: float
) -> float:
    """Length of the shortest path between two points (3,) outside one sphere: the straight line, or
    two tangents and an arc of a great circle, in the plane of both points and the centre.
    """
    from_start, from_target = np.subtract(start, centre), np.subtract(target, centre)
    a, b = math.hypot(*from_start), math.hypot(*from_target)
    between = math.atan2(math.hypot(*np.cross(from_start, from_target)), from_start @ from_target)
    arc = between - math.acos(min(radius / a, 1.0)) - math.acos(min(radius / b, 1.0))
    if arc <= 0.0:
        return math.dist(start, target)
    return (
        math.sqrt(max(a * a - radius * radius, 0.0))
        + math.sqrt(max(b * b - radius * radius, 0.0))
        + radius * arc
    )
