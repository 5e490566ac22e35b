"""Why a robot collided, seen from the end: when it could have known, and whether it could still
have escaped then.
"""

import math
from dataclasses import replace

import numpy as np

from bezierplan.running.simulation import clairvoyant
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.policy import Policy
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import ChangingCells, MovingCircles, World

# A prediction meets the robot if it comes this close, in units, at one of so many moments of the
# step that follows the collision.
_TOUCH = 1e-6
_MOMENTS = 21

# An escape is looked for during this multiple of the time that the straight way to the target
# takes, and so many steps more.
_DETOUR = 2.0
_LONGER = 50.0


def known_at(motion: Motion, collision_at: float, world: World, policy: Policy) -> float:
    """The first step from which on the robot could know of its collision, in steps; nan if it never
    could.

    Among circles: from then on the one that it meets, moved on as its policy lets the robot
    foresee, meets it where and when it did. Among cells: when the map in force began, if that was
    before the collision.
    """
    if isinstance(world, ChangingCells):
        began = float(np.concatenate([[0.0], world.moments])[world.index(collision_at)])
        return began if began < collision_at else math.nan
    moments = np.linspace(collision_at, min(collision_at + 1.0, motion.times[-1]), _MOMENTS)
    robot = motion.at(moments)
    hit = _met(robot[0], collision_at, world)
    moment, step = math.nan, math.floor(collision_at)
    while step >= 0:
        looked = step + (policy.sees == "after")
        seen = world.at(looked)[hit]
        drift = world.at(looked + 1)[hit] - seen if policy.knows == "velocities" else np.zeros(2)
        apart = np.hypot(*(robot - seen - np.outer(moments - looked, drift)).T)
        if apart.min() > world.radii[hit] + _TOUCH:
            break
        moment, step = float(step), step - 1
    return moment


def _met(place: np.ndarray, time: float, world: MovingCircles) -> int:
    """The number of the circle that touches a place (2,) at a time."""
    step = math.floor(time)
    centres = world.at(step) + (time - step) * (world.at(step + 1) - world.at(step))
    return int(np.argmin(np.hypot(*(centres - place).T) - world.radii))


def avoidable(motion: Motion, since: float, world: World, problem: Problem) -> bool:
    """Whether a robot that knew the future could, from where this one was at a step, have arrived
    without a collision. True is certain; the search can miss a way. False for a step that is nan.
    """
    if math.isnan(since):
        return False
    robot = tuple(motion.at(since).tolist())
    enough = _LONGER + _DETOUR * math.dist(robot, problem.target) / world.pace
    end = math.ceil(min(world.end - since, enough))
    if isinstance(world, ChangingCells):
        first = world.index(since)
        later = replace(
            world, maps=world.maps[first:], moments=world.moments[first:] - since, end=end
        )
    else:
        later = replace(world, centres=world.centres + world.velocities * since, end=end)
    return clairvoyant.reachable(later, problem._replace(start=robot))
