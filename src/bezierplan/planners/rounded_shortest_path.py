"""A baseline: what a practitioner would drive, the exact shortest path with its corners rounded.

At each obstacle corner around which the shortest path turns, a circle of the turning radius is
placed so that it contains the corner; the path is a string of straight legs and arcs pulled tight
around these circles, each of which lies as deep behind its corner as the string pulls it. Corners
too close together for two circles, such as those at the end of a wall, share one. The certified
check then judges the path. The aims, in this order: as few corners as possible stay sharp; the
tightest turn is as wide as can be, up to the radius that is asked; then the others are; and the
path is no longer than allowed. Radii come from one fixed ladder, whatever is asked, so asking for
more does not give less. Three of 1,495 random maps are exceptions: crowded circles can part at one
rung and not at those beside it.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.geometry import curves, shortest_paths
from bezierplan.geometry.checker import find_first_collision
from bezierplan.geometry.checker.hulls import measure_distance
from bezierplan.geometry.region import Region, build_region, from_origin
from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners import About, Path, Plan, Problem, Range
from bezierplan.planners.parts.genetic import copy
from bezierplan.planners.parts.settings import UNITS, with_settings
from bezierplan.workspaces import robot
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.polygons import Polygons, cross, normalise

extra = ("turns", "corners", "least_radius")
exact = True
deterministic = True

# A vertex at which the shortest path turns by less than this, in radians, is not a corner.
_STRAIGHT = 1e-9

# Radii are this factor to a whole power. It is what an answer can miss the widest turn by. The
# rungs do not depend on the radius that is asked: when circles shrank from that one instead, asking
# for a larger radius could keep a smaller one.
_RUNG = 1.02

# A turn without room for this share of the path's length as its radius stays a corner; no turn is
# wider than that multiple of it.
_TIGHTEST, _WIDEST = 1e-3, 10.0

# How often the string is pulled tight. The circles move less with each time.
_PULLS = 12

# How many rungs the search for the widest turn goes down at once, while circles are crowded: a
# ladder has hundreds, and on most maps the upper ones are crowded or too long.
_STRIDE = 16

# After so many pulls circles that still overlap will not part.
_CROWDED_PULLS = 2

# How often, at most, circles that overlap are pushed apart.
_PUSHES = 100

# An arc of at most this angle is one cubic piece, which deviates outwards from its circle by at
# most 4e-6 of the radius.
_PIECE_ANGLE = math.pi / 4
_MOST_PIECES = 9

# A point of the shortest path this close to a circle, in units, lies on it.
_ON_CIRCLE = 1e-3

# A share by which lengths may differ by rounding.
_SAME = 1e-9

# The side of start and target, which are turned around on neither.
_NO_SIDE = 2.0

# What a trial of radii can find.
_FREE, _BLOCKED, _CROWDED, _TOO_LONG = range(4)


class Turns(NamedTuple):
    """The turns of the path, each (n,) or (n, 2).

    In a `Course` start and target are the first and the last, with a radius of 0: so a leg leads
    from one turn to the next, whatever they are.

    corner: the obstacle's corner, or the centre of a circular obstacle.
    radius: the obstacle's, 0 for a corner.
    before, after: unit vectors, the path's direction before and after the turn.
    side: 1 for a turn to the left, -1 to the right.
    angle: by how much it turns, in radians.
    """

    corner: np.ndarray
    radius: np.ndarray
    before: np.ndarray
    after: np.ndarray
    side: np.ndarray
    angle: np.ndarray


class Course(NamedTuple):
    """Conditions that the path must suit.

    turns: (n,), which start and target begin and end.
    region: what is blocked.
    origin: (2,), the region's.
    limit: the length that it may have at most.
    trials: (1,) how many paths have been tried.
    """

    turns: Turns
    region: Region
    origin: np.ndarray
    limit: float
    trials: np.ndarray


class String(NamedTuple):
    """A string pulled tight around m circles, in arrays (n, ...) with room for one circle a turn.

    Start and target are the circles 0 and m + 1, of radius 0.

    crowd: the number of a circle that has no room beside its neighbours, or 0.
    count: m.
    first, last: the turns that a circle contains.
    centres: (n, 2).
    radii: (n,).
    legs: (n, 2, 2) ends of the straight part that leads to a circle.
    sweeps: (n,) angles of the arcs, each in the sense of its turn.
    """

    crowd: int
    count: int
    first: np.ndarray
    last: np.ndarray
    centres: np.ndarray
    radii: np.ndarray
    legs: np.ndarray
    sweeps: np.ndarray


class Settings(NamedTuple):
    """How round the path is. Where there is no room its turns are tighter; extra columns tell."""

    turning_radius: Annotated[
        float,
        Range(0, math.inf),
        About("smallest radius that the path should have; 0 leaves the corners", unit=UNITS),
    ]
    excess: Annotated[
        float,
        Range(0, math.inf),
        About("share by which the path may be longer than the exact shortest one"),
    ]


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Return the exact shortest path (`shortest_paths.shortest_path`), rounded.

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
        turns, how often the shortest path turns; corners, how many turns have no room to be round;
        least_radius, the smallest radius of the others, in units, infinite if there are no turns
        and 0 if all are corners.
    """
    bound = shortest_paths.shortest_path(problem)
    if math.isinf(bound.length):
        nothing = {"turns": 0, "corners": 0, "least_radius": math.nan}
        return Plan.of_one(None, math.inf, "no way", nothing)
    points, radii, trials = _round(problem, bound, settings)
    path = Path("cubic_chain", points)
    is_round = radii > 0
    told = {
        "turns": len(radii),
        "corners": int((~is_round).sum()),
        "least_radius": float(
            radii[is_round].min(initial=math.inf) if is_round.any() or not len(radii) else 0
        ),
    }
    return Plan.of_one(path, curves.length(path), "exact", told)._replace(evaluations=trials)


def _round(
    problem: Problem, bound: shortest_paths.Bound, settings: Settings
) -> tuple[np.ndarray, np.ndarray, int]:
    """Round the shortest path.

    Returns control points of the rounded path, the radius (n,) of each turn, and the number of
    paths tried.
    """
    blocked = build_region(problem.workspace)
    trials = np.zeros(1, np.int64)
    # Around corners of a grown obstacle there may be less room than for a circle; then each vertex
    # of the shortest path is a turn of its own.
    for workspace in (problem.workspace, None):
        inner = find_turns(bound.points, workspace)
        turns = Turns(*(np.pad(each, [(1, 1), (0, 0)][: each.ndim]) for each in inner))
        turns.corner[[0, -1]] = problem.ends
        turns.side[[0, -1]] = _NO_SIDE
        course = Course(
            turns,
            blocked,
            -from_origin(np.zeros(2), blocked),
            (1 + _SAME) * (1 + settings.excess) * bound.length,
            trials,
        )
        radii, is_free = _widen(course, bound.length, settings.turning_radius)
        if is_free:
            break
    points, _ = _draw(turns, _shorten(turns, radii))
    return points, radii[1:-1], int(trials[0])


def find_turns(points: np.ndarray, workspace: object) -> Turns:
    """Find the turns of a shortest path, a polyline (n, 2).

    Around circles and round corners the vertices of an arc are one turn.
    """
    heading = normalise(np.diff(points, axis=0))
    bend, along = cross(heading[:-1], heading[1:]), (heading[:-1] * heading[1:]).sum(axis=1)
    bends = np.flatnonzero((np.abs(bend) > _STRAIGHT) | (along < 0))
    corner, radius = points[bends + 1], np.zeros(len(bends))
    first = np.ones(len(bends), bool)
    centres, radii, near = _list_discs(workspace)
    if len(bends) and len(radii):
        depth = np.hypot(*(corner[:, None] - centres).transpose(2, 0, 1)) - radii
        nearest = np.abs(depth).argmin(axis=1)
        round_circle = np.abs(depth)[np.arange(len(bends)), nearest] < near
        corner = np.where(round_circle[:, None], centres[nearest], corner)
        radius = np.where(round_circle, radii[nearest], 0.0)
        first[1:] = ~(round_circle[1:] & round_circle[:-1] & (nearest[1:] == nearest[:-1]))
    begin = np.flatnonzero(first)
    end = np.append(begin[1:], len(bends))[: len(begin)] - 1
    angle = np.abs(np.arctan2(bend, along))[bends]
    return Turns(
        corner[begin],
        radius[begin],
        heading[bends[begin]],
        heading[bends[end] + 1],
        np.sign(bend[bends[begin]]),
        np.add.reduceat(angle, begin) if len(begin) else angle,
    )


def _list_discs(workspace: object) -> tuple[np.ndarray, np.ndarray, float]:
    """List the discs around which a shortest path can bend.

    Returns their centres (n, 2) and radii (n,), and how close to them, in units, the path's
    vertices lie.
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


@compile_kernel
def _widen(course, shortest, wish):
    """Find the widest radii: the radius (n,) of each turn, and whether the path is free."""
    levels = _list_radii(min(wish, _TIGHTEST * shortest), min(wish, _WIDEST * shortest))
    top = len(levels) - 1
    radii = course.turns.radius.copy()

    # Turns without room for the least radius stay corners. The nearer end of a leg that meets
    # something may not have been to blame, so each is tried again.
    live = np.ones(len(radii), np.bool_)
    live[0] = live[-1] = False
    verdict, first, last = _try(course, radii, live, levels[0])
    while verdict != _FREE and live.any():
        if not live[first : last + 1].any():
            live[:] = False
        live[first : last + 1] = False
        verdict, first, last = _try(course, radii, live, levels[0])
    for i in np.flatnonzero(~live)[1:-1]:
        live[i] = True
        live[i] = _try(course, radii, live, levels[0])[0] == _FREE

    # The tightest turn. Wider circles have less room beside each other, and strings around them are
    # longer; but a path that meets something at some radius may be free at a larger one.
    k = top
    while k > _STRIDE and _try(course, radii, live, levels[k])[0] >= _CROWDED:
        k -= _STRIDE
    k = min(k + _STRIDE, top)
    while k > 0 and _try(course, radii, live, levels[k])[0] != _FREE:
        k -= 1
    radii = _raise_radii(course.turns, radii, live, levels[k])

    # The others grow together, and whichever meets something stops.
    while k < top and live.any():
        verdict, first, last = _try(course, radii, live, levels[top])
        if verdict == _FREE:
            return _raise_radii(course.turns, radii, live, levels[top]), True
        above = top
        while above - k > 1:
            # A bisection: here the path is free at k and not at `above`.
            middle = (k + above) // 2
            there = _try(course, radii, live, levels[middle])
            if there[0] == _FREE:
                k = middle
            else:
                above = middle
                verdict, first, last = there
        radii = _raise_radii(course.turns, radii, live, levels[k])
        if verdict == _TOO_LONG or not live[first : last + 1].any():
            break
        live[first : last + 1] = False
    return radii, _try(course, radii, np.zeros_like(live), 0.0)[0] == _FREE


@compile_kernel
def _list_radii(least, most):
    """List the radii to try, ascending: whole powers of one number, between two given ends."""
    if least == most:
        return np.array([most])
    low = math.floor(math.log(least) / math.log(_RUNG)) + 1
    high = math.ceil(math.log(most) / math.log(_RUNG)) - 1
    levels = np.empty(high - low + 3)
    levels[0], levels[-1] = least, most
    for k in range(low, high + 1):
        levels[k - low + 1] = _RUNG**k
    return levels


@compile_kernel
def _raise_radii(turns, radii, live, level):
    """Return radii (n,) with those of live turns raised to a level, or as wide as the obstacle."""
    raised = radii.copy()
    for i in np.flatnonzero(live):
        raised[i] = max(level, turns.radius[i])
    return raised


@compile_kernel
def _try(course, radii, live, level):
    """Try the path with some radii (n,), those of live turns raised to a level.

    Returns what was found, and if it is blocked, the first and the last of the turns that are to
    blame.
    """
    course.trials[0] += 1
    string = _shorten(course.turns, _raise_radii(course.turns, radii, live, level))
    if string.crowd > 0:
        return _CROWDED, string.first[string.crowd], string.last[string.crowd]
    if _measure_string(string) > course.limit:
        return _TOO_LONG, 0, len(radii) - 1
    points, part = _draw(course.turns, string)
    piece = np.empty((1, 4, 2))
    for k in range(len(part)):
        for i in range(4):
            for axis in range(2):
                piece[0, i, axis] = points[3 * k + i, axis] - course.origin[axis]
        at = find_first_collision(piece, course.region)[0]
        if at < np.inf:
            # An arc's own turns are to blame, or those at the nearer end of a leg.
            circle = min(max((part[k] - (at < 0.5)) // 2, 1), string.count)
            return _BLOCKED, string.first[circle], string.last[circle]
    return _FREE, 0, 0


@compile_kernel
def _shorten(turns, radii):
    """Return the string around circles of some radii (n,)."""
    string, other = _pull(turns, radii, False), _pull(turns, radii, True)
    return other if _measure_string(other) < _measure_string(string) else string


@allocation_free
def _measure_string(string):
    """Return the length of a string, infinite if its circles are crowded."""
    length = 0.0 if string.crowd == 0 else math.inf
    for begin, end in string.legs[1 : string.count + 2]:
        length += measure_distance(begin, end)
    for k in range(1, string.count + 1):
        length += string.radii[k] * string.sweeps[k]
    return length


@compile_kernel
def _pull(turns, radii, patient):
    """Pull the string tight around circles of some radii (n,).

    Circles that are in each other's way join at once or, if patient, when the others have come to
    rest: either may be shorter. Each circle lies where the string's pull and its corners hold it,
    as far inwards as these allow.
    """
    n = len(radii)
    first, last, count = np.arange(n), np.arange(n), n - 2
    centres, reach, side = turns.corner.copy(), radii.copy(), turns.side.copy()
    legs, heading = np.empty((n, 2, 2)), np.empty((n, 2))
    inward, sweeps, wrong = np.empty((n, 2)), np.empty(n), 0
    pulls = 0
    while pulls < _PULLS:
        for k in range(1, count + 1):
            for axis in range(2):
                # Half of the old direction and half of the new one: without the old one the
                # circles would swing to and fro.
                pull = turns.after[last[k], axis] - turns.before[first[k], axis]
                if pulls > 0:
                    pull = inward[k, axis] + heading[k + 1, axis] - heading[k, axis]
                inward[k, axis] = pull
            size = math.hypot(inward[k, 0], inward[k, 1])
            for axis in range(2 if size > 0.0 else 0):
                inward[k, axis] /= size
            if not _place(turns, first[k], last[k], reach[k], inward[k], centres[k]):
                return String(k, count, first, last, centres, reach, legs, sweeps)
        _separate_circles(turns, first, last, count, reach, side, centres)
        wrong, signed_radii = 0, side * reach
        for k in range(1, count + 2):
            if not _draw_leg(centres, signed_radii, k - 1, k, legs[k], heading[k]):
                # The last leg leads to no circle, so it names the one it comes from.
                wrong = min(k, count)
        crowd = wrong
        for k in range(1, count + 1):
            expected = turns.angle[first[k] : last[k] + 1].sum()
            cross = heading[k, 0] * heading[k + 1, 1] - heading[k, 1] * heading[k + 1, 0]
            dot = heading[k, 0] * heading[k + 1, 0] + heading[k, 1] * heading[k + 1, 1]
            # Directions tell an arc's angle but for whole turns; the shortest path's turn there
            # tells those.
            more = side[k] * math.atan2(cross, dot) - expected
            sweeps[k] = expected + (more + math.pi) % math.tau - math.pi
            if sweeps[k] < -_STRAIGHT and (wrong == crowd or sweeps[k] < sweeps[wrong]):
                wrong = k
        pulls += 1
        if crowd > 0 and pulls > _CROWDED_PULLS:
            break
        # A circle that bends the string back shares one with its nearer neighbour, unless the
        # string passes outside its corners without it.
        if wrong == 0 or (patient and pulls < _PULLS):
            continue
        gone, neighbour = wrong, _find_neighbour(centres, side, wrong)
        x, y = centres[neighbour]
        is_inside = neighbour > 0 and _contains_corners(
            turns, first[wrong], last[wrong], reach[neighbour], x, y
        )
        if not is_inside and _is_needless(turns, centres, signed_radii, first, last, wrong):
            if pulls < _PULLS:
                continue
        elif neighbour == 0:
            continue
        else:
            gone, neighbour = max(wrong, neighbour), min(wrong, neighbour)
            last[neighbour] = last[gone]
            reach[neighbour] = max(reach[neighbour], reach[gone])
        count -= 1
        for k in range(gone, count + 2):
            first[k], last[k] = first[k + 1], last[k + 1]
            reach[k], side[k] = reach[k + 1], side[k + 1]
            centres[k, 0], centres[k, 1] = centres[k + 1, 0], centres[k + 1, 1]
        # The rest has to settle anew without the circle.
        pulls = 0
    return String(wrong, count, first, last, centres, reach, legs, sweeps)


@allocation_free
def _find_neighbour(centres, side, k):
    """Return the number of the nearer neighbour of circle `k` on its side, 0 if it has none."""
    nearest, gap = 0, np.inf
    for j in (k - 1, k + 1):
        if side[j] == side[k]:
            apart = measure_distance(centres[j], centres[k])
            if apart < gap:
                nearest, gap = j, apart
    return nearest


@allocation_free
def _place(turns, first, last, radius, inward, centre):
    """Put the centre (2,) of a circle as far inwards as the corners that it contains allow.

    Returns whether it can contain them all.
    """
    for i in range(first, last + 1):
        depth = radius - turns.radius[i]
        x = turns.corner[i, 0] + depth * inward[0]
        y = turns.corner[i, 1] + depth * inward[1]
        if _contains_corners(turns, first, last, radius, x, y):
            centre[0], centre[1] = x, y
            return True
    # Between two corners: where circles of the centre's distance from each meet.
    deepest = -math.inf
    for i in range(first, last):
        for j in range(i + 1, last + 1):
            dx = turns.corner[j, 0] - turns.corner[i, 0]
            dy = turns.corner[j, 1] - turns.corner[i, 1]
            apart = math.hypot(dx, dy)
            one, other = radius - turns.radius[i], radius - turns.radius[j]
            # Circles around the two corners do not meet: no centre has both distances.
            if apart == 0.0 or not abs(one - other) <= apart <= one + other:
                continue
            # By the law of cosines, as a share of the way between the corners: how far along it
            # both circles meet, and how far beside it.
            share = 0.5 * (1.0 + (one * one - other * other) / (apart * apart))
            height = math.sqrt(max(0.0, (one / apart) ** 2 - share * share))
            for sign in (-1.0, 1.0):
                x = turns.corner[i, 0] + share * dx - sign * height * dy
                y = turns.corner[i, 1] + share * dy + sign * height * dx
                depth = x * inward[0] + y * inward[1]
                if depth > deepest and _contains_corners(turns, first, last, radius, x, y):
                    deepest = depth
                    centre[0], centre[1] = x, y
    return deepest > -math.inf


@allocation_free
def _separate_circles(turns, first, last, count, reach, side, centres):
    """Move circles apart, as far as their corners allow, where no leg of a string fits between
    them.

    These are circles that overlap the next one, of the other sense, or contain an end of the path.
    """
    for _ in range(_PUSHES):
        largest = 0.0
        for k in range(count + 1):
            if side[k] == side[k + 1]:
                continue
            across, up = centres[k + 1, 0] - centres[k, 0], centres[k + 1, 1] - centres[k, 1]
            apart, needed = math.hypot(across, up), reach[k] + reach[k + 1]
            # Twice the share at which the pushes end: after the last one circles are still apart by
            # more than their radii, so rounding does not let a leg fail.
            missing = (1.0 + 2.0 * _SAME) * needed - apart
            if apart == 0.0 or missing <= 0.0:
                continue
            largest = max(largest, missing / needed)
            for j, share in ((k, -0.5), (k + 1, 0.5)):
                if 0 < j <= count:
                    centres[j, 0] += share * missing / apart * across
                    centres[j, 1] += share * missing / apart * up
                    _hold(turns, first[j], last[j], reach[j], centres[j])
        if largest <= _SAME:
            break


@allocation_free
def _hold(turns, first, last, radius, centre):
    """Move a circle back to where it contains its corners, one after the other."""
    for i in range(first, last + 1):
        x, y = centre[0] - turns.corner[i, 0], centre[1] - turns.corner[i, 1]
        depth, apart = radius - turns.radius[i], math.hypot(x, y)
        if apart > depth:
            centre[0] = turns.corner[i, 0] + depth / apart * x
            centre[1] = turns.corner[i, 1] + depth / apart * y


@allocation_free
def _contains_corners(turns, first, last, radius, x, y):
    """Tell whether a circle contains the corners of some turns."""
    for i in range(first, last + 1):
        distance = math.hypot(x - turns.corner[i, 0], y - turns.corner[i, 1])
        if distance + turns.radius[i] > radius * (1.0 + _SAME):
            return False
    return True


@allocation_free
def _draw_leg(centres, signed_radii, k, j, leg, heading):
    """Draw the leg (2, 2) from circle k to circle j and its unit direction (2,), and return whether
    it fits.

    signed_radii: positive where the string turns left.
    """
    (ax, ay), (bx, by) = centres[k], centres[j]
    radius, next_radius = signed_radii[k], signed_radii[j]
    distance = math.hypot(bx - ax, by - ay)
    across = next_radius - radius
    fits = abs(across) <= distance
    # Where it does not fit, both circles touch it at one place.
    tilt = (
        math.asin(across / distance)
        if fits and distance > 0.0
        else math.copysign(0.5 * math.pi, across)
    )
    direction = math.atan2(by - ay, bx - ax) - tilt
    heading[0], heading[1] = math.cos(direction), math.sin(direction)
    leg[0, 0], leg[0, 1] = ax + radius * heading[1], ay - radius * heading[0]
    leg[1, 0], leg[1, 1] = bx + next_radius * heading[1], by - next_radius * heading[0]
    return fits


@compile_kernel
def _is_needless(turns, centres, signed_radii, first, last, k):
    """Tell whether the leg past a circle leaves its corners on the side to which the path turns
    there.

    It leads from the circle before to the next.
    """
    leg, heading = np.empty((2, 2)), np.empty(2)
    if not _draw_leg(centres, signed_radii, k - 1, k + 1, leg, heading):
        return False
    for i in range(first[k], last[k] + 1):
        x, y = turns.corner[i, 0] - leg[0, 0], turns.corner[i, 1] - leg[0, 1]
        if turns.side[i] * (heading[0] * y - heading[1] * x) < turns.radius[i]:
            return False
    return True


@compile_kernel
def _draw(turns, string):
    """Draw legs and arcs as cubic pieces.

    Returns their control points (3 k + 1, 2), and what each piece (k,) is: 2 i for the leg to
    circle i, 2 i + 1 for the arc around it.
    """
    most = string.count * (_MOST_PIECES + 1) + 1
    points, part = np.empty((3 * most + 1, 2)), np.empty(most, np.int64)
    copy(turns.corner[0], points[0])
    pieces = 0
    for k in range(1, string.count + 2):
        begin, end = string.legs[k]
        for third in range(1, 4):
            share = third / 3
            for axis in range(2):
                points[3 * pieces + third, axis] = begin[axis] + (end[axis] - begin[axis]) * share
        part[pieces] = 2 * k
        pieces += 1
        if string.radii[k] == 0.0 or string.sweeps[k] <= 0.0:
            continue
        arcs = math.ceil(string.sweeps[k] / _PIECE_ANGLE)
        angle = turns.side[string.first[k]] * string.sweeps[k] / arcs
        # The cubic piece that touches its arc at both ends and in the middle.
        handle = 4 / 3 * math.tan(angle / 4)
        cosine, sine = math.cos(angle), math.sin(angle)
        centre_x, centre_y = string.centres[k]
        x, y = end[0] - centre_x, end[1] - centre_y
        for _ in range(arcs):
            along = points[3 * pieces + 1 : 3 * pieces + 4]
            along[0, 0], along[0, 1] = centre_x + x - handle * y, centre_y + y + handle * x
            x, y = cosine * x - sine * y, sine * x + cosine * y
            along[1, 0], along[1, 1] = centre_x + x + handle * y, centre_y + y - handle * x
            along[2, 0], along[2, 1] = centre_x + x, centre_y + y
            part[pieces] = 2 * k + 1
            pieces += 1
        # Rounding of the rotations must not leave a gap to the next leg.
        copy(string.legs[k + 1, 0], points[3 * pieces])
    copy(turns.corner[-1], points[3 * pieces])  # to the last bit
    return points[: 3 * pieces + 1], part[:pieces]
