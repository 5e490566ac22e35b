"""Paths among spheres in a box: the exact collision check, arc length, and a bound that no free
path beats.

Whether a path is free is decided in rational arithmetic, without rounding. On a Bézier piece the
squared distance to a centre, and the distance to a wall, are polynomials; their Bernstein
coefficients enclose their values. A polynomial is halved until all coefficients of every part are
high enough or a value at an end is certainly too low. As in `checker`, two thresholds guarantee
that this ends: a path that is nowhere deeper than `TOLERANCE` is free, one that is somewhere deeper
than twice that collides, and in between either verdict is possible.
"""

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from bezierplan.geometry.curves import bernstein
from bezierplan.workspaces.spheres import Spheres

TOLERANCE = 1e-9
"""Depth, in units, up to which a path is free."""

_TIGHT, _LOOSE = Fraction(TOLERANCE), 2 * Fraction(TOLERANCE)

_Point = list[Fraction]


def is_free(pieces: np.ndarray, spheres: Spheres) -> bool:
    """Whether a path of Bézier pieces (pieces, degree + 1, 3), in units, stays outside all spheres
    and inside the box.

    Touching is allowed. Radii must be above twice the tolerance.
    """
    centres = [
        (list(map(Fraction, centre)), Fraction(radius))
        for centre, radius in zip(spheres.centres.tolist(), spheres.radii.tolist())
    ]
    walls = np.reshape(spheres.bounds, (3, 2)).tolist()
    for piece in pieces.tolist():
        points = [list(map(Fraction, point)) for point in piece]
        for axis, (low, high) in enumerate(walls):
            for beyond in (
                [p[axis] - Fraction(low) for p in points],
                [Fraction(high) - p[axis] for p in points],
            ):
                if not _stays_above(beyond, -_LOOSE, -_TIGHT):
                    return False
        for centre, radius in centres:
            if not _stays_above(
                _squared_distance(points, centre), (radius - _LOOSE) ** 2, (radius - _TIGHT) ** 2
            ):
                return False
    return True


def _stays_above(coefficients: list[Fraction], enough: Fraction, needed: Fraction) -> bool:
    """Whether a polynomial on [0, 1], given by its Bernstein coefficients, stays above a value:
    true only if it is at least `enough` everywhere, false only if it is below `needed` somewhere,
    which is the larger of the two.
    """
    parts = [coefficients]
    while parts:
        part = parts.pop()
        if min(part) >= enough:
            continue
        if min(part[0], part[-1]) < needed:
            return False
        parts += _halves(part)
    return True


def _halves(coefficients: list[Fraction]) -> tuple[list[Fraction], list[Fraction]]:
    """The Bernstein coefficients of both halves of a polynomial (de Casteljau's construction)."""
    rows = [coefficients]
    while len(rows[-1]) > 1:
        rows.append([(a + b) / 2 for a, b in zip(rows[-1], rows[-1][1:])])
    return [row[0] for row in rows], [row[-1] for row in reversed(rows)]


def _squared_distance(points: list[_Point], centre: _Point) -> list[Fraction]:
    """The Bernstein coefficients of the squared distance of a Bézier piece to a centre: its degree
    is twice that of the piece.
    """
    n = len(points) - 1
    away = [[a - c for a, c in zip(point, centre)] for point in points]

    def product(i: int, j: int) -> Fraction:
        return (
            math.comb(n, i)
            * math.comb(n, j)
            * sum((a * b for a, b in zip(away[i], away[j])), Fraction(0))
        )

    sums = [
        sum((product(i, k - i) for i in range(max(0, k - n), min(n, k) + 1)), Fraction(0))
        for k in range(2 * n + 1)
    ]
    return [whole / math.comb(2 * n, k) for k, whole in enumerate(sums)]


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
