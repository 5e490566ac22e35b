"""A robot among cells that change: it follows a way from one change to the next, until there is
something to decide.
"""

import itertools
import math
from typing import Literal

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.geometry.region import build_region, is_blocked
from bezierplan.running.simulation import ways
from bezierplan.running.simulation.circles import ARRIVED, BLOCKED, DUE, ENDED, STOPPED
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.policy import Policy
from bezierplan.running.simulation.ways import Way
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import ChangingCells


def follow(
    world: ChangingCells, way: Way, time: float, policy: Policy
) -> tuple[int, np.ndarray, np.ndarray]:
    """Follow a newly planned way from a time on, in steps. If it begins in a cell that has become
    occupied, the robot first drives out of it.

    Returns why it ends, and times (n,) with the lengths of way (n,) reached at them; between them
    the robot moves uniformly or waits.
    """
    s, fresh, out = 0.0, True, find_way_out(world.workspace(time), way)
    times, progress = [time], [s]
    checks = policy.replan == "when_blocked"
    while True:
        free = (
            find_blocked_length(world.workspace(time), way, max(s, out))
            if checks or policy.waits
            else math.inf
        )
        # A new way is followed first, because to plan again at the same moment changes nothing.
        if not fresh and policy.replan in ("every_step", "when_changed"):
            event = DUE
            break
        if not fresh and checks and free < way.length:
            event = BLOCKED
            break
        fresh = False
        limit = (
            way.length
            if free >= way.length or not policy.waits
            else max(s, out, free - policy.brake)
        )
        following = find_next_event(world, time, policy)
        arrival = time + (limit - s) / world.pace
        if arrival <= following:
            time, s = arrival, limit
            # No moment stands twice, except for the end of the way.
            if s >= way.length or time > times[-1]:
                times, progress = [*times, time], [*progress, s]
            if s >= way.length:
                event = ARRIVED
                break
            if policy.replan != "never":
                event = STOPPED
                break
            time = following  # it waits for the next change
        else:
            s += (following - time) * world.pace
            time = following
        times, progress = [*times, time], [*progress, s]
        if time >= world.end:
            event = ENDED
            break
    return event, np.array(times), np.array(progress)


def find_next_event(world: ChangingCells, time: float, policy: Policy) -> float:
    """Return the next moment, in steps, at which the world changes, a plan is due, or time
    is over.
    """
    changes = world.moments[world.moments > time]
    due = (
        (math.floor(time / policy.every) + 1) * policy.every
        if policy.replan == "every_step"
        else math.inf
    )
    return float(min(changes.min(initial=math.inf), due, world.end))


def find_blocked_length(grid: Grid, way: Way, s: float) -> float:
    """Return the length along a way, from its beginning, at which it first enters an occupied cell
    after `s`; infinite if never.
    """
    points, _ = ways.cut(*way, s, way.length)
    collision_at = ways.find_first_collision(points, build_region(grid))
    lengths = s + ways.measure_lengths(points)
    return float(np.interp(collision_at, np.arange(len(lengths)), lengths, right=math.inf))


def find_way_out(grid: Grid, way: Way) -> float:
    """Return the length of a way after which it first leaves the occupied cells; 0 if it does not
    begin in one, or does not leave them.
    """
    cells = build_region(grid)
    if not is_blocked(cells, tuple(way.points[0])):
        return 0.0
    for begin, (start, end) in zip(way.at, itertools.pairwise(way.points)):
        ends = grid.in_cells(np.array([start, end]))
        cuts = np.unique(np.concatenate([[0.0, 1.0], *map(_find_crossings, *ends)]))
        # Between two crossings of grid lines the way stays in one cell, so its middle decides.
        for enters, leaves in itertools.pairwise(cuts):
            if not is_blocked(cells, tuple(start + (enters + leaves) / 2 * (end - start))):
                return float(begin + enters * math.dist(start, end))
    return 0.0


def _find_crossings(begin: float, end: float) -> np.ndarray:
    """Return the shares of a leg at which it crosses a grid line, from one of its ends' coordinates
    to the other, in cells.
    """
    lines = np.arange(math.floor(min(begin, end)) + 1, math.ceil(max(begin, end)))
    return (lines - begin) / (end - begin)


# A robot drives back in parts of this length, in units.
_BACK = 0.01


def find_way_to_start(
    motion: Motion, grid: Grid, start: Literal["position", "centre"]
) -> np.ndarray:
    """Return points (n, 2) from where a motion ends to where a plan begins: there, or at the centre
    of its cell.

    If that place is occupied, they lead back along the motion to a free one; if there is none, only
    the end of the motion is returned.
    """
    back = motion.points[::-1]
    lengths = ways.measure_lengths(back)
    for s in itertools.chain([0.0], np.arange(_BACK, lengths[-1], _BACK)):
        robot = Way(back, lengths).place(s)
        begin = _find_start(grid, robot, start)
        if begin is not None:
            return np.concatenate([back[lengths < s], [robot, begin]])
    return back[:1]


def bound_plan(motion: Motion, grid: Grid, target: tuple[float, float]) -> float:
    """Return the least length, in units, of a plan after a motion: to the centre of its cell, as
    `find_way_to_start` says, and from cell centre to cell centre to the target.

    Infinite if there is none; nan if the target is no centre, or the map too large.
    """
    approach = find_way_to_start(motion, grid, "centre")
    try:
        rest = shortest_paths.centre_path(
            Problem("rest", grid, tuple(approach[-1].tolist()), target)
        ).length
    except ValueError:
        return math.nan
    return ways.build_way(approach).length + rest


def _find_start(
    grid: Grid, place: np.ndarray, start: Literal["position", "centre"]
) -> np.ndarray | None:
    """Return where a plan begins for a robot at a place, or None if that is occupied."""
    if start == "position":
        return None if is_blocked(build_region(grid), tuple(place)) else place
    cell = grid.cell_of(*place)
    return None if grid.occupied[cell] else grid.in_units(np.array(cell[::-1]) + 0.5)
