"""Paths of lines and arcs made curvature-continuous: between a line and an arc the curvature rises
along a transition, as on a railway.

An arc of a circle is replaced by one about the same centre with a smaller radius, and by a
transition on either side, which begins on the line and ends on that arc. It is a cubic Bézier piece
with the curvature 0 at one end and that of the arc at the other, close to a clothoid: to turn by an
angle it needs about the radius times the angle of the line, and shifts the arc inwards by a sixth
of the radius times the square of the angle. Where an arc has no line beside it, or no room to be
shifted, it stays as it is.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bezierplan.geometry.checker import first_collision
from bezierplan.geometry.curves import bezier_pieces
from bezierplan.geometry.region import Region, from_origin
from bezierplan.workspaces.problem import Path

MOST_ANGLE = 0.3
"""Most by which a transition turns, in radians."""

SHIFT = MOST_ANGLE**2 / 6
"""By how much a transition shifts an arc, at most, as a share of its radius."""

EXCESS = 1e-4
"""By which share the curvature of a transition, or an arc's piece, is above the arc's, at most."""

# Largest angle of an arc, in radians, that is one cubic piece.
_PIECE_ANGLE = math.pi / 16

# Control points this close to a line, as a share of a piece's length, are on it; centres this
# close, as a share of the radius, are one.
_ON_LINE = 1e-9
_SAME_CENTRE = 1e-5

# Where a transition enters an obstacle, it turns by half as much, and in the end not at all.
_LEAST_SHARE = 1 / 32


class _Part(NamedTuple):
    """A line (radius 0), or an arc to the left (side 1) or to the right (side -1): points (n, 4,
    2), centre, and the angle of all of it.
    """

    pieces: np.ndarray
    centre: np.ndarray
    radius: float
    side: float
    sweep: float


def eased(path: Path, blocked: Region, passed: Sequence[tuple[float, float]] = ()) -> Path:
    """A `cubic_chain` of lines and arcs with transitions between them, which is free where it was.
    blocked: the region of the map. passed: joints of the chain that stay where they are, so an arc
    with one is not shifted.
    """
    parts = _parts(bezier_pieces(path))
    share = np.array([0.0 if _has_joint(part, passed) else 1.0 for part in parts])
    while True:
        angles = [_angle(parts, number, share[number]) for number in range(len(parts))]
        chains = [_turn(part, angle) for part, angle in zip(parts, angles)]
        entering = [bool(angle) and _enters(chain, blocked) for angle, chain in zip(angles, chains)]
        if not any(entering):
            break
        share[entering] = np.where(share[entering] > _LEAST_SHARE, 0.5 * share[entering], 0.0)
    for number, part in enumerate(parts):
        if not part.radius:
            chains[number] = _line(
                chains[number - 1][-1, -1] if number and angles[number - 1] else part.pieces[0, 0],
                chains[number + 1][0, 0]
                if number + 1 < len(parts) and angles[number + 1]
                else part.pieces[-1, -1],
            )
    chain = np.concatenate(chains)
    if not len(chain):  # it ends where it begins
        return path
    return Path("cubic_chain", np.concatenate([chain[0, :1], chain[:, 1:].reshape(-1, 2)]))


def _has_joint(part: _Part, places: Sequence[tuple[float, float]]) -> bool:
    joints = part.pieces[:, [0, -1]].reshape(-1, 2).tolist()
    return any(list(place) in joints for place in places)


def _parts(pieces: np.ndarray) -> list[_Part]:
    """Lines and arcs, of as many pieces as there are in a row."""
    parts: list[_Part] = []
    for piece in pieces:
        part = _part(piece)
        last = parts[-1] if parts else None
        same = (
            last
            and part.radius
            and last.side == part.side
            and math.dist(last.centre, part.centre) <= _SAME_CENTRE * part.radius
        )
        if last and same:
            longest = last if last.sweep >= part.sweep else part  # whose centre is most exact
            parts[-1] = longest._replace(
                pieces=np.concatenate([last.pieces, part.pieces]), sweep=last.sweep + part.sweep
            )
        else:
            parts.append(part)
    return parts


def _part(piece: np.ndarray) -> _Part:
    """The line or the arc of a cubic piece: the centre is where its normals at both ends meet."""
    first, last = piece[1] - piece[0], piece[3] - piece[2]
    cross, along = float(first[0] * last[1] - first[1] * last[0]), float(first @ last)
    size = float(np.hypot(*(piece[3] - piece[0])))
    sweep = math.atan2(cross, along)
    if abs(cross) <= _ON_LINE * size**2:
        return _Part(piece[None], piece[0], 0.0, 0.0, 0.0)
    radius = size / (2 * math.sin(abs(sweep) / 2))
    side = math.copysign(1.0, sweep)
    normal = side * np.array([-first[1], first[0]]) / np.hypot(*first)
    return _Part(piece[None], piece[0] + radius * normal, radius, side, abs(sweep))


def _angle(parts: list[_Part], number: int, share: float) -> float:
    """By how much the transitions of an arc turn; 0 for a line, and where one has no room."""
    part = parts[number]
    if not part.radius or number in (0, len(parts) - 1):
        return 0.0
    room = math.inf
    for beside, beyond in ((number - 1, number - 2), (number + 1, number + 2)):
        if parts[beside].radius:
            return 0.0
        length = math.dist(parts[beside].pieces[0, 0], parts[beside].pieces[-1, -1])
        room = min(
            room, 0.5 * length if 0 <= beyond < len(parts) and parts[beyond].radius else length
        )
    angle = share * min(MOST_ANGLE, 0.5 * part.sweep, room / part.radius)
    while angle and _transition(part.radius, angle)[3] > room:
        angle = 0.9 * angle if angle > _LEAST_SHARE * _ON_LINE else 0.0
    return angle


def _transition(radius: float, angle: float) -> tuple[float, float, float, float]:
    """Radius of the arc, the second and the third control point's distance along the line, and how
    far before the foot of the circle's centre it begins.

    The third control point lies on the line and on the tangent of the arc, so the curvature is 0
    where the transition begins. The second one lies half as far along the line; where the
    transition ends, the curvature is that of the arc.
    """
    inner = radius / (1 + angle**2 / 6)
    height = radius - inner * math.cos(angle)  # of its end above the line
    handle = height / math.sin(angle)
    corner = 3 * handle**2 / (inner * math.sin(angle))
    return inner, 0.5 * corner, corner, corner + handle * math.cos(angle) - inner * math.sin(angle)


def _turn(part: _Part, angle: float) -> np.ndarray:
    """Pieces (n, 4, 2) of an arc with transitions that turn by an angle; the arc itself without."""
    if not angle:
        return part.pieces
    inner, second, third, before = _transition(part.radius, angle)
    foot, end_foot = part.pieces[0, 0], part.pieces[-1, -1]
    into = _unit(part.pieces[0, 1] - foot)
    # Both point away from the turn's own middle, backwards at its end.
    out = _unit(part.pieces[-1, 2] - end_foot)
    begin, end = foot - before * into, end_foot - before * out
    spoke = (foot - part.centre) / part.radius
    arc = _arc(
        part.centre, inner * _turned(spoke, part.side * angle), part.side * (part.sweep - 2 * angle)
    )
    head = np.array([begin, begin + second * into, begin + third * into, arc[0, 0]])
    tail = np.array([arc[-1, -1], end + third * out, end + second * out, end])
    middle = arc if part.sweep > 2 * angle * (1 + _ON_LINE) else arc[:0]
    return np.concatenate([head[None], middle, tail[None]])


def _arc(centre: np.ndarray, spoke: np.ndarray, turned: float) -> np.ndarray:
    """Pieces (n, 4, 2) of an arc, from a vector to its beginning, whose curvature at their ends is
    exactly that of the arc.
    """
    parts = max(1, math.ceil(abs(turned) / _PIECE_ANGLE))
    angle = abs(turned) / parts
    handle = -math.sin(angle) / 3 + math.sqrt(
        math.sin(angle) ** 2 / 9 + 2 / 3 * (1 - math.cos(angle))
    )
    pieces = []
    for number in range(parts):
        a, b = (_turned(spoke, turned * (number + each) / parts) for each in (0, 1))
        along = math.copysign(handle, turned)
        pieces.append(
            centre
            + np.array(
                [a, a + along * _turned(a, math.pi / 2), b - along * _turned(b, math.pi / 2), b]
            )
        )
    return np.array(pieces)


def _line(begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    """A line as one piece; none if it has no length."""
    piece = begin + np.array([[0.0], [1 / 3], [2 / 3], [1.0]]) * (end - begin)
    piece[-1] = end
    return piece[None] if np.any(begin != end) else piece[None][:0]


def _enters(pieces: np.ndarray, blocked: Region) -> bool:
    return (
        first_collision(np.ascontiguousarray(from_origin(pieces, blocked)), blocked)[0] < math.inf
    )


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.hypot(*vector)


def _turned(vector: np.ndarray, angle: float) -> np.ndarray:
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([cosine * vector[0] - sine * vector[1], sine * vector[0] + cosine * vector[1]])
