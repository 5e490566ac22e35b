"""Dubins paths (L. E. Dubins, American Journal of Mathematics 79, 1957): the shortest paths between
two poses that turn no tighter than a radius. They consist of at most three parts, arcs of that
radius and straight lines; a word says which. Here either heading may be free.

A pose is (3,): x, y, and the heading in radians, nan where it is free. A word is (8,): the turn of
each part, 1 to the left, 0 straight, -1 to the right, followed by its length; the heading at the
beginning; and the length of all.
"""

import math

import numpy as np

from bezierplan.kernels import allocation_free

WORDS = 6
"""Words between two poses: LSL, RSR, LSR, RSL, RLR, LRL."""

PIECE_ANGLE = math.pi / 8
"""Largest angle of an arc, in radians, that is one cubic piece."""

CURVATURE_EXCESS = 1e-4
"""By how much, as a share, the curvature of a cubic piece is above that of its arc, at most."""

MOST_PIECES = 3 * 16 + 1
"""Most pieces of a word: three full circles."""

# Parts of a word that are shorter than this, as a share of the radius, are left out; the last piece
# makes up for it.
_NO_PART = 1e-7


@allocation_free
def _angle(value: float) -> float:
    """An angle from 0 to a full turn; 0 just below a full turn, which is rounding."""
    value -= math.tau * math.floor(value / math.tau)
    return 0.0 if math.tau - value < _NO_PART else value


@allocation_free
def _put(words, k, first, turn, t, middle, p, last, q, radius):
    """Write a word, with the lengths of its parts as shares of the radius."""
    words[k, 0], words[k, 2], words[k, 4] = turn, middle, last
    words[k, 1], words[k, 3], words[k, 5] = t * radius, p * radius, q * radius
    words[k, 6] = first
    words[k, 7] = (t + p + q) * radius


@allocation_free
def words_between(a: np.ndarray, b: np.ndarray, radius: float, words: np.ndarray) -> None:
    """Fill in the words (6, 8) from a pose to another; those that do not exist are infinite."""
    for k in range(WORDS):
        words[k, 7] = np.inf
    x, y = b[0] - a[0], b[1] - a[1]
    d = math.hypot(x, y) / radius
    bearing = math.atan2(y, x)
    if math.isnan(a[2]) and math.isnan(b[2]):
        _put(words, 0, bearing, 0.0, d, 0.0, 0.0, 0.0, 0.0, radius)
    elif math.isnan(b[2]):
        for k in range(2):
            turn = 1.0 - 2.0 * k
            t, p = _arc_and_line(turn * (bearing - a[2]), d)
            if p < np.inf:
                _put(words, k, a[2], turn, t, 0.0, p, 0.0, 0.0, radius)
    elif math.isnan(a[2]):  # the same, driven backwards
        for k in range(2):
            turn = 1.0 - 2.0 * k
            t, p = _arc_and_line(turn * (b[2] - bearing), d)
            if p < np.inf:
                _put(words, k, b[2] - turn * t, 0.0, p, turn, t, 0.0, 0.0, radius)
    else:
        _between_headings(a[2], a[2] - bearing, b[2] - bearing, d, radius, words)


@allocation_free
def _arc_and_line(bearing: float, d: float) -> tuple[float, float]:
    """Angle of an arc to the left and length of the line from its end to a point, from a pose at
    the origin along the x-axis; the length is infinite for a point within the circle. bearing, d:
    direction and distance of the point. Radii are 1.
    """
    x, y = d * math.cos(bearing), d * math.sin(bearing) - 1.0  # from the circle's centre
    square = x * x + y * y - 1.0
    if square < -_NO_PART:
        return 0.0, np.inf
    line = math.sqrt(max(square, 0.0))
    return _angle(math.atan2(y, x) - math.atan2(line, 1.0) + 0.5 * math.pi), line


@allocation_free
def _between_headings(first, alpha, beta, d, radius, words):
    """The six words between two headings, relative to the bearing, at a distance in radii (Shkel
    and Lumelsky 2001).
    """
    sa = math.sin(alpha)
    ca = math.cos(alpha)
    sb = math.sin(beta)
    cb = math.cos(beta)
    cab = math.cos(alpha - beta)
    for k in range(2):  # both arcs to the same side: LSL, RSR
        turn = 1.0 - 2.0 * k
        east, north = d + turn * (sa - sb), turn * (cb - ca)
        p = math.hypot(east, north)
        # One circle: no line, and no bearing of it.
        bearing = math.atan2(north, east) if p > _NO_PART else alpha
        t, q = _angle(turn * (bearing - alpha)), _angle(turn * (beta - bearing))
        _put(words, k, first, turn, t, 0.0, p, turn, q, radius)
    for k in range(2):  # to different sides: LSR, RSL
        turn = 1.0 - 2.0 * k
        square = d * d - 2.0 + 2.0 * cab + 2.0 * turn * d * (sa + sb)
        if square >= -_NO_PART:
            p = math.sqrt(max(square, 0.0))
            bearing = math.atan2(-turn * (ca + cb), d + turn * (sa + sb)) + turn * math.atan2(
                2.0, p
            )
            t, q = _angle(turn * (bearing - alpha)), _angle(turn * (bearing - beta))
            _put(words, 2 + k, first, turn, t, 0.0, p, -turn, q, radius)
    for k in range(2):  # three arcs: RLR, LRL
        turn = 2.0 * k - 1.0
        share = (6.0 - d * d + 2.0 * cab - 2.0 * turn * d * (sa - sb)) / 8.0
        if abs(share) <= 1.0:
            p = math.tau - math.acos(share)
            t = _angle(
                turn * (math.atan2(turn * (cb - ca), d + turn * (sa - sb)) - alpha) + 0.5 * p
            )
            q = _angle(turn * (beta - alpha) - t + p)
            _put(words, 4 + k, first, turn, t, -turn, p, turn, q, radius)


@allocation_free
def pieces_of(
    a: np.ndarray, b: np.ndarray, word: np.ndarray, radius: float, pieces: np.ndarray
) -> int:
    """Write the cubic pieces (n, 4, 2) of a word from a pose to another, and return how many; the
    last one ends exactly there.
    """
    x, y, heading = a[0], a[1], word[6]
    count, handle = 0, 0.0
    for part in range(3):
        turn, length = word[2 * part], word[2 * part + 1]
        if length < _NO_PART * radius:
            continue
        parts = 1 if turn == 0.0 else math.ceil(length / radius / PIECE_ANGLE - _NO_PART)
        step = length / parts
        angle = turn * step / radius
        handle = step / 3.0 if turn == 0.0 else 4.0 / 3.0 * radius * math.tan(0.25 * abs(angle))
        for _ in range(parts):
            along, across = math.cos(heading), math.sin(heading)
            pieces[count, 0, 0], pieces[count, 0, 1] = x, y
            pieces[count, 1, 0], pieces[count, 1, 1] = x + handle * along, y + handle * across
            if turn == 0.0:
                x += step * along
                y += step * across
            else:
                heading += angle
                x += turn * radius * (math.sin(heading) - across)
                y += turn * radius * (along - math.cos(heading))
            pieces[count, 2, 0] = x - handle * math.cos(heading)
            pieces[count, 2, 1] = y - handle * math.sin(heading)
            pieces[count, 3, 0], pieces[count, 3, 1] = x, y
            count += 1
    if count == 0:
        for k in range(4):
            pieces[0, k, 0] = a[0] + k / 3.0 * (b[0] - a[0])
            pieces[0, k, 1] = a[1] + k / 3.0 * (b[1] - a[1])
        return 1
    if not math.isnan(b[2]):
        heading = b[2]
    pieces[count - 1, 2, 0] = b[0] - handle * math.cos(heading)
    pieces[count - 1, 2, 1] = b[1] - handle * math.sin(heading)
    pieces[count - 1, 3, 0], pieces[count - 1, 3, 1] = b[0], b[1]
    return count
