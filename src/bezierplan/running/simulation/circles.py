"""A robot among moving circles: it follows a way step by step, until there is something to
decide.
"""

import math
from typing import NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.running.simulation.motion_check import TOUCHING
from bezierplan.running.simulation.policy import Policy
from bezierplan.running.simulation.ways import Way
from bezierplan.workspaces.worlds import MovingCircles, positions

ARRIVED, BLOCKED, DUE, STOPPED, ENDED = range(5)
"""Reasons why a robot stops following its way: it is there; the rest of the way is blocked; another
plan is due; something is right in front of it; the world's time is over.
"""


class _Rules(NamedTuple):
    """A policy in the form that kernels take."""

    every: int
    plans: bool
    checks: bool
    brakes: bool
    looks_after: bool
    foresees: bool
    check_margin: float
    brake: float
    horizon: float


def follow(
    world: MovingCircles, way: Way, time: float, policy: Policy
) -> tuple[int, np.ndarray, np.ndarray]:
    """Follow a newly planned way from a step on, given as its time.

    Returns why it ends, the times (steps + 1,) of this and every following step, and the lengths of
    way at them; the last one may be reached before its step.
    """
    # A circle that moves changes the world at every step. Touching is allowed.
    changes = policy.replan == "when_changed" and bool(world.velocities.any())
    rules = _Rules(
        every=policy.every if policy.replan == "every_step" else int(changes),
        plans=policy.replan != "never",
        checks=policy.replan == "when_blocked",
        brakes=policy.waits,
        looks_after=policy.sees == "after",
        foresees=policy.knows == "velocities",
        check_margin=policy.check_margin - TOUCHING,
        brake=float(policy.brake),
        horizon=float(policy.horizon),
    )
    circles = (world.centres, world.velocities, np.array(world.walls, dtype=float), world.radii)
    event, reached = _follow(
        way.points, way.at, round(time), circles, float(world.pace), world.end, rules
    )
    return event, time + np.arange(len(reached)), reached


@compile_kernel
def _follow(points, at, step, circles, pace, end, rules):
    """Run the loop of `follow`."""
    centres, velocities, walls, radii = circles
    progress = np.empty(end - step + 1)
    n, s, total = 0, 0.0, at[-1]
    progress[0] = s
    while step + n < end:
        # A robot that foresees motion needs the circles where they are now: their drift is added on
        # the way.
        places = positions(
            centres, velocities, walls, step + n + (rules.looks_after and not rules.foresees)
        )
        drift = (
            positions(centres, velocities, walls, step + n + 1) - places
            if rules.foresees
            else np.zeros_like(places)
        )
        if n > 0:
            if rules.every > 0 and (step + n) % rules.every == 0:
                return DUE, progress[: n + 1]
            if rules.checks and is_near(
                points,
                at,
                s,
                min(s + rules.horizon, total),
                places,
                drift,
                radii,
                rules.check_margin,
                pace,
            ):
                return BLOCKED, progress[: n + 1]
        if rules.brakes and is_near(
            points, at, s, min(s + rules.brake, total), places, drift, radii, -TOUCHING, pace
        ):
            if rules.plans:
                return STOPPED, progress[: n + 1]
        else:
            s = min(s + pace, total)
        n += 1
        progress[n] = s
        if s >= total:
            return ARRIVED, progress[: n + 1]
    return ENDED, progress[: n + 1]


@allocation_free
def is_near(points, at, begin, end, centres, drift, radii, margin, pace):
    """Return whether a robot that drives the part of a way between two lengths comes nearer to a
    circle than its radius plus a margin.

    points (n, 2), at (n,): as in `Way`. centres (k, 2): when the robot is at `begin`. drift (k, 2):
    motion of the circles, in units per step. radii (k,). pace: the robot's, in units per step. All
    lengths are in units.
    """
    for k in range(len(centres)):
        reach = radii[k] + margin
        closing = 1.0 + math.hypot(drift[k, 0], drift[k, 1]) / pace
        i = min(np.searchsorted(at, begin, side="right"), len(at) - 1)
        s, (x, y) = begin, _place(points, at, begin)
        while True:
            following = min(at[i], end)
            next_x, next_y = (
                (points[i, 0], points[i, 1]) if at[i] <= end else _place(points, at, end)
            )
            step_x, step_y = next_x - x, next_y - y
            early, late = (s - begin) / pace, (following - begin) / pace
            dx = x - centres[k, 0] - drift[k, 0] * early
            dy = y - centres[k, 1] - drift[k, 1] * early
            ex, ey = step_x - drift[k, 0] * (late - early), step_y - drift[k, 1] * (late - early)
            last_x, last_y = dx + ex, dy + ey
            along, size = -(dx * ex + dy * ey), ex * ex + ey * ey
            if along > 0.0 and size > 0.0:
                # The squared distance is a quadratic in time; this is its least within the leg.
                share = min(along / size, 1.0)
                dx, dy = dx + share * ex, dy + share * ey
            if dx * dx + dy * dy < reach * reach:
                return True
            # The distance shrinks by at most `closing` per unit of way, so the circle is out of
            # reach until then.
            clear = following + (math.hypot(last_x, last_y) - reach) / closing
            if following >= end or clear >= end or i + 1 >= len(at):
                break
            i = max(i + 1, np.searchsorted(at, clear, side="right"))
            x, y, s = points[i - 1, 0], points[i - 1, 1], at[i - 1]
    return False


@allocation_free
def _place(points, at, s):
    """Return the point after a length of way."""
    i = min(max(np.searchsorted(at, s, side="right"), 1), len(at) - 1)
    if i == 0 or at[i] == at[i - 1]:
        return points[i, 0], points[i, 1]
    share = min(max((s - at[i - 1]) / (at[i] - at[i - 1]), 0.0), 1.0)
    return points[i - 1, 0] + share * (points[i, 0] - points[i - 1, 0]), points[
        i - 1, 1
    ] + share * (points[i, 1] - points[i - 1, 1])
