"""A robot among cells that change: from one moment of change to the next along a way, until there is something to decide."""

import math

import numpy as np

from bezierplan.geometry import checker
from bezierplan.geometry.region import region
from bezierplan.running.simulation.circles import ARRIVED, BLOCKED, DUE, ENDED, STOPPED
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.policy import Policy
from bezierplan.running.simulation.ways import Way
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.worlds import ChangingCells


def follow(world: ChangingCells, way: Way, time: float, policy: Policy) -> tuple[int, np.ndarray, np.ndarray]:
    """Follow a way from its beginning, which has just been planned, from a time on, in steps.

    Returns why it ends, and times (n,) with the lengths of way (n,) reached at them; between them the robot moves uniformly or waits.
    """
    s, fresh = 0.0, True
    times, reached = [time], [s]
    checks = policy.replan == "when_blocked"
    while True:
        free = free_length(world.workspace(time), way, s) if checks or policy.waits else math.inf
        if not fresh and policy.replan == "every_step":
            return DUE, np.array(times), np.array(reached)
        if not fresh and checks and free < way.length:
            return BLOCKED, np.array(times), np.array(reached)
        fresh = False
        limit = way.length if free >= way.length or not policy.waits else max(s, free - policy.brake)
        following = next_event(world, time, policy)
        arrival = time + (limit - s) / world.pace
        if arrival <= following:
            time, s = arrival, limit
            if s >= way.length:
                return ARRIVED, np.array([*times, time]), np.array([*reached, s])
            if time > times[-1]:
                times, reached = [*times, time], [*reached, s]
            if policy.replan != "never" and limit < way.length:
                return STOPPED, np.array(times), np.array(reached)
            time = following  # it waits for the next change
        else:
            s += (following - time) * world.pace
            time = following
        times, reached = [*times, time], [*reached, s]
        if time >= world.end:
            return ENDED, np.array(times), np.array(reached)


def next_event(world: ChangingCells, time: float, policy: Policy) -> float:
    """The next moment, in steps, at which the world changes, a plan is due, or time is over."""
    changes = world.moments[world.moments > time]
    due = (math.floor(time / policy.every) + 1) * policy.every if policy.replan == "every_step" else math.inf
    return float(min(changes.min(initial=math.inf), due, world.end))


def free_length(grid: Grid, way: Way, s: float) -> float:
    """The length of a way, from a length s of it on, at which it first enters an occupied cell; infinite if it does not."""
    points = way.part(s, way.length)
    collision_at, _ = checker.first_collision(np.stack([points[:-1], points[1:]], axis=1) - np.array(grid.origin), region(grid))
    if math.isinf(collision_at):
        return math.inf
    lengths = np.concatenate([[s], s + np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    return float(np.interp(collision_at, np.arange(len(lengths)), lengths))


# A robot drives back in parts of this length, in units.
_BACK = 0.01


def way_to_centre(motion: Motion, grid: Grid) -> np.ndarray:
    """Points (n, 2) from where a motion ends to the centre of that cell; if the cell is occupied, back along the motion to a free one."""
    place = motion.points[-1]
    centre = _centre(grid, place)
    if centre is not None:
        return np.array([place, centre])
    back = motion.points[::-1]
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(back, axis=0).T))])
    for s in np.arange(_BACK, lengths[-1], _BACK):
        place = np.array([np.interp(s, lengths, back[:, axis]) for axis in range(2)])
        centre = _centre(grid, place)
        if centre is not None:
            return np.concatenate([back[lengths < s], [place, centre]])
    return motion.points[-1:]


def _centre(grid: Grid, place: np.ndarray) -> np.ndarray | None:
    """The centre of a place's cell, or None if that is occupied."""
    row, column = grid.cell_of(*place)
    return None if grid.occupied[row, column] else np.array(grid.centre(row * grid.occupied.shape[1] + column))
