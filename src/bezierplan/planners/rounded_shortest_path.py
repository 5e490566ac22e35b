"""A baseline: what a practitioner would drive, the exact shortest path with its corners rounded.

At each obstacle corner around which the shortest path turns, a circle of the turning radius is
placed so that the corner lies inside it; the path is a string of straight legs and arcs pulled
tight around these circles. Corners too close together for two circles, such as those at the end of
a wall, form one turn of two circles side by side. The certified check then judges the path. Where
an arc or a leg enters an obstacle, or there is no room for the circles, the adjacent circles
shrink, in the end to the corner itself: the shortest path is free, so this ends in a free path.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.geometry import curves, shortest_paths
from bezierplan.geometry.checker import first_collision
from bezierplan.geometry.region import Region, from_origin, region
from bezierplan.kernels import compiled
from bezierplan.planners import About, Plan, Range
from bezierplan.planners.parts.settings import UNITS, with_settings
from bezierplan.workspaces import robot
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.limits import LARGEST
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Path, Problem

extra = ("turns", "tight_turns", "least_radius")
exact = True
deterministic = True

# A vertex at which the shortest path turns by less than this, in radians, is not a corner.
_STRAIGHT = 1e-9

# A circle shrinks by this factor at each step, and to its corner once below the given share of the
# turning radius.
_SHRINKING = 0.8
_SMALLEST = 0.01

# An arc of at most this angle is one cubic piece, which deviates outwards from its circle by at
# most 4e-6 of the radius.
_PIECE_ANGLE = math.pi / 4

# A point of the shortest path this close to a circle, in units, lies on it.
_ON_CIRCLE = 1e-3


class Turns(NamedTuple):
    """What the path turns around, from start to target, each (n,) or (n, 2).

    corner: the obstacle's corner, or the centre of a circular obstacle; radius: that of the
    obstacle, 0 for a corner. before, after: unit vectors, the path's direction before and after the
    turn. side: 1 for a turn to the left, -1 to the right.
    """

    corner: np.ndarray
    radius: np.ndarray
    before: np.ndarray
    after: np.ndarray
    side: np.ndarray


class Settings(NamedTuple):
    """How round the path is. Without room, both are smaller; extra columns report by how much."""

    turning_radius: Annotated[
        float,
        Range(0, LARGEST),
        About("smallest radius that the path should have; 0 leaves the corners", unit=UNITS),
    ]
    offset: Annotated[
        float,
        Range(0, LARGEST),
        About("distance to keep from the corners around which the path turns", unit=UNITS),
    ]


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """The exact shortest path (`shortest_paths.shortest_path`), rounded.

    Parameters
    ----------
    problem : Problem
        In any workspace of the plane.
    rng : numpy.random.Generator
        Unused: the path is exact.

    Returns
    -------
    Plan
        Its objective is its length, in units, or infinite if there is no path. Extra columns:
        turns, the number of corners; tight_turns, those with a smaller radius than the turning
        radius; least_radius, the smallest radius of a turn, in units: 0 where a corner is left,
        infinite if there are no turns.
    """
    return _answer(
        problem, shortest_paths.shortest_path(problem), region(problem.workspace), settings
    )


def _answer(
    problem: Problem, bound: shortest_paths.Bound, blocked: Region, settings: Settings
) -> Plan:
    """The shortest path, rounded."""
    if math.isinf(bound.length):
        nothing = {"turns": 0, "tight_turns": 0, "least_radius": math.nan}
        return Plan.of_one(None, math.inf, "no way", nothing)
    turns = turns_of(bound.points, problem.workspace)
    points, radii, tries, free = _rounded(problem, turns, blocked, settings)
    if not free:  # around corners of a grown obstacle there may be less room than for a circle
        points, radii, further, _ = _rounded(
            problem, turns_of(bound.points, None), blocked, settings
        )
        tries += further
    path = Path("cubic_chain", points)
    length = curves.length(path)
    return Plan(
        path=path,
        objective=length,
        claimed_feasible=True,
        evaluations=tries,
        history=np.array([length]),
        stop="exact",
        extra={
            "turns": len(radii),
            "tight_turns": int((radii < settings.turning_radius * (1 - 1e-9)).sum()),
            "least_radius": float(radii.min(initial=math.inf)),
        },
    )


def turns_of(points: np.ndarray, workspace: object) -> Turns:
    """The turns of a shortest path, a polyline (n, 2). Around circles and round corners the
    vertices of an arc are one turn.
    """
    heading = _unit(np.diff(points, axis=0))
    bend = heading[:-1, 0] * heading[1:, 1] - heading[:-1, 1] * heading[1:, 0]
    bends = np.flatnonzero(
        (np.abs(bend) > _STRAIGHT) | ((heading[:-1] * heading[1:]).sum(axis=1) < 0)
    )
    corner, radius = points[bends + 1], np.zeros(len(bends))
    first = np.ones(len(bends), dtype=bool)
    centres, radii, near = _discs(workspace)
    if len(bends) and len(radii):
        depth = np.hypot(*(corner[:, None] - centres).transpose(2, 0, 1)) - radii
        nearest = np.abs(depth).argmin(axis=1)
        round_circle = np.abs(depth)[np.arange(len(bends)), nearest] < near
        corner = np.where(round_circle[:, None], centres[nearest], corner)
        radius = np.where(round_circle, radii[nearest], 0.0)
        first[1:] = ~(round_circle[1:] & round_circle[:-1] & (nearest[1:] == nearest[:-1]))
    begin, end = _runs(first)
    return Turns(
        corner[begin],
        radius[begin],
        heading[bends[begin]],
        heading[bends[end] + 1],
        np.sign(bend[bends[begin]]),
    )


def _discs(workspace: object) -> tuple[np.ndarray, np.ndarray, float]:
    """Centres (n, 2) and radii (n,) of what a shortest path can be round at, and how close to it,
    in units, its vertices lie.
    """
    if isinstance(workspace, Circles):
        return workspace.centres, workspace.radii, _ON_CIRCLE
    if isinstance(workspace, Polygons) and workspace.growth:
        around = workspace.growth.radius * (
            1 + robot.ARC_EXCESS
        )  # outside the tangents at a corner
        return (
            workspace.growth.centres,
            np.full(len(workspace.growth.centres), around),
            robot.ARC_EXCESS * around + robot.TOLERANCE,
        )
    return np.empty((0, 2)), np.empty(0), 0.0


def _runs(begins: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and last indices (m,) of the runs that begin where `begins`, bool (n,), is true; the
    first element is always true.
    """
    first = np.flatnonzero(begins)
    return first, np.append(first[1:], len(begins))[: len(first)] - 1


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.hypot(*vectors.T), np.finfo(float).tiny)[:, None]


def _rounded(
    problem: Problem, turns: Turns, blocked: Region, settings: Settings
) -> tuple[np.ndarray, np.ndarray, int, bool]:
    """Control points of the rounded path, radius (n,) of each turn, the number of paths tried, and
    whether the path is free.

    Where two circles of the same sense get in each other's way, they become one turn and are pulled
    inwards in the same direction. Where that does not help, circles are pulled inwards less, and
    only then shrink. There are no points if that does not help either, as around two round corners
    of a grown map that touch.
    """
    count = len(turns.side)
    # Share of the desired radius, share of the way inwards up to the corner's clearance, and
    # whether a turn begins at a corner.
    share, pull, begins = np.ones(count), np.ones(count), np.ones(count, dtype=bool)
    tries = 0
    while True:
        tries += 1
        radii, centres = _circles(turns, begins, share, pull, settings)
        legs, sweeps, bent_back, crowded = _string(problem, turns, centres, radii)
        if bent_back.any() and _join(begins, bent_back, turns):
            continue
        wrong = _beside(bent_back) | crowded
        if wrong.any():
            slack = wrong & (pull > 0) & (radii > turns.radius)
            if not (slack.any() or share[_of_turns(wrong, begins)].any()):
                return np.empty((0, 2)), radii, tries, False
            pull[slack] = np.where(pull[slack] > 0.1, pull[slack] * _SHRINKING, 0.0)
            _shrink(share, wrong & ~slack, begins)
            continue
        points, owner = _chain(legs, sweeps, centres, radii, turns)
        pieces = np.ascontiguousarray(
            points[np.arange(0, len(points) - 1, 3)[:, None] + np.arange(4)]
        )
        hit = _colliding(from_origin(pieces, blocked), blocked)
        bad = np.zeros(count + 2, dtype=bool)  # with start and target around the turns
        bad[owner[hit].ravel()] = True
        if not bad[1:-1].any() or not share[bad[1:-1]].any():
            return points, radii, tries, not bad.any()
        _shrink(share, bad[1:-1], begins)


def _of_turns(which: np.ndarray, begins: np.ndarray) -> np.ndarray:
    """The marked circles, along with the rest of their turns."""
    turn = np.cumsum(begins)
    return np.isin(turn, turn[which])


def _shrink(share: np.ndarray, which: np.ndarray, begins: np.ndarray) -> None:
    """Shrink the marked circles, along with the rest of their turns."""
    which = _of_turns(which, begins)
    share[which] = np.where(share[which] > _SMALLEST, share[which] * _SHRINKING, 0.0)


def _join(begins: np.ndarray, bent_back: np.ndarray, turns: Turns) -> bool:
    """Merge corners at which the string bends back into one turn with the nearer neighbour of the
    same sense; false if there is none.
    """
    joined = False
    gap = np.hypot(*np.diff(turns.corner, axis=0).T)
    gap = np.where((turns.side[1:] == turns.side[:-1]) & begins[1:], gap, np.inf)
    beside = np.concatenate([[np.inf], gap, [np.inf]])
    for i in np.flatnonzero(bent_back):
        if min(beside[i], beside[i + 1]) < np.inf:
            begins[i if beside[i] <= beside[i + 1] else i + 1] = False
            joined = True
    return joined


def _beside(marks: np.ndarray) -> np.ndarray:
    """The marked ones (n,) and their neighbours."""
    wide = np.concatenate([[False], marks, [False]])
    return wide[:-2] | wide[1:-1] | wide[2:]


def _circles(
    turns: Turns, begins: np.ndarray, share: np.ndarray, pull: np.ndarray, settings: Settings
) -> tuple[np.ndarray, np.ndarray]:
    """Radii (n,) and centres (n, 2) of the circles around which the path runs; the corners lie
    inside them, at the depth of the offset.
    """
    margin = turns.radius + share * settings.offset
    radii = np.maximum(margin, share * settings.turning_radius)
    first, last = _runs(begins)
    inward = _unit(turns.after[last] - turns.before[first])[np.cumsum(begins) - 1]
    return radii, turns.corner + (pull * (radii - margin))[:, None] * inward


def _string(
    problem: Problem, turns: Turns, centres: np.ndarray, radii: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Legs (n + 1, 2, 2) of the string around circles, sweeps (n,) of its arcs in their own sense,
    whether (n,) the string bends back at a circle, and whether a circle overlaps a neighbour so
    that no leg fits between them.
    """
    ends = np.vstack([problem.start, centres, problem.target])
    signed = np.concatenate([[0.0], turns.side * radii, [0.0]])
    step = np.diff(ends, axis=0)
    distance = np.hypot(*step.T)
    across = np.diff(signed)
    fits = np.abs(across) <= distance
    tilt = np.arcsin(
        np.divide(across, distance, out=np.zeros_like(across), where=fits & (distance > 0))
    )
    direction = np.arctan2(step[:, 1], step[:, 0]) - tilt
    normal = np.column_stack([-np.sin(direction), np.cos(direction)])
    legs = np.stack(
        [ends[:-1] - signed[:-1, None] * normal, ends[1:] - signed[1:, None] * normal], axis=1
    )
    sweeps = turns.side * ((np.diff(direction) + math.pi) % math.tau - math.pi)
    return legs, np.maximum(sweeps, 0.0), sweeps < -_STRAIGHT, ~fits[:-1] | ~fits[1:]


def _chain(
    legs: np.ndarray, sweeps: np.ndarray, centres: np.ndarray, radii: np.ndarray, turns: Turns
) -> tuple[np.ndarray, np.ndarray]:
    """Control points (3 k + 1, 2) of legs and arcs as cubic pieces, and for each piece (k, 2) the
    two ends or turns between which it lies, numbered from 0 at the start; for an arc, its turn
    twice.
    """
    points, owner = [legs[0, :1]], []
    for number, (begin, end) in enumerate(legs):
        points.append(begin + (end - begin) * np.array([[1 / 3], [2 / 3], [1.0]]))
        owner.append((number, number + 1))
        if number == len(sweeps) or radii[number] == 0.0 or sweeps[number] == 0.0:
            continue
        parts = math.ceil(sweeps[number] / _PIECE_ANGLE)
        turned = turns.side[number] * sweeps[number] / parts
        spoke = end - centres[number]
        handle = 4 / 3 * math.tan(turned / 4)
        for angle in turned * np.arange(parts):
            a, b = (_turned(spoke, each) for each in (angle, angle + turned))
            points.append(
                centres[number] + np.array([a + handle * _quarter(a), b - handle * _quarter(b), b])
            )
            owner.append((number + 1, number + 1))
        points[-1][-1] = legs[number + 1, 0]
    points[-1][-1] = legs[-1, 1]  # to the last bit
    return np.concatenate(points), np.array(owner)


def _turned(vector: np.ndarray, angle: float) -> np.ndarray:
    return math.cos(angle) * vector + math.sin(angle) * _quarter(vector)


def _quarter(vector: np.ndarray) -> np.ndarray:
    """A vector rotated counterclockwise by a right angle."""
    return np.array([-vector[1], vector[0]])


@compiled
def _colliding(pieces, blocked):
    """Whether (n,) pieces (n, 4, 2) enter the blocked region."""
    hit = np.empty(len(pieces), dtype=np.bool_)
    for k in range(len(pieces)):
        hit[k] = first_collision(pieces[k : k + 1], blocked)[0] < np.inf
    return hit
