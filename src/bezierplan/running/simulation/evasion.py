"""The step aside of a robot that cannot stay: to the place that stays free longest."""

import math

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.running.simulation.motion_check import measure_nearest
from bezierplan.running.simulation.policy import Policy
from bezierplan.workspaces.worlds import MovingCircles

# A robot that evades compares standing still with a drive in each of so many directions, during one
# of so many steps, after which it stays. It looks so many steps ahead.
_DIRECTIONS = 32
_DRIVES = (1, 2, 4, 8)
_AHEAD = 20.0


def find_refuge(world: MovingCircles, robot: np.ndarray, step: int, policy: Policy) -> np.ndarray:
    """Return the best place (2,), in units, for the robot at the end of a step: where it stands,
    unless a circle is about to come there.

    The robot knows what its policy lets it see. A step that meets no circle is better than one that
    meets one. Of two such steps, the better one begins the drive on which no circle comes nearer
    than `check_margin` for longer; of two equal ones, it ends farther from all circles.

    step: the number of the one that begins.
    """
    looked = step + (policy.sees == "after")
    seen = world.at(looked)
    knows = policy.knows == "velocities"
    drift = world.at(looked + 1) - seen if knows else np.zeros_like(seen)
    angles = 2.0 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    moves = world.pace * np.concatenate(
        [np.zeros((1, 2)), np.column_stack([np.cos(angles), np.sin(angles)])]
    )
    # Circles that are seen after their step were a drift behind when it began.
    during = seen - drift if policy.sees == "after" else seen
    return _find_best(
        robot,
        moves,
        during,
        drift,
        world.radii,
        float(policy.check_margin),
        np.array(world.bounds, dtype=float),
    )


@compile_kernel
def _find_best(robot, moves, centres, drift, radii, margin, bounds):
    """Return the place (2,) at the end of the best step, as `find_refuge` ranks them.

    moves (n, 2): in units per step; the first is to stay. centres (k, 2): the circles at the
    beginning of the step, with their drift (k, 2) in units per step and radii (k,). bounds (4,):
    the field, as in `MovingCircles`. Lengths are in units.
    """
    best, best_depth, best_time, best_apart = robot, -np.inf, 0.0, 0.0
    for i in range(len(moves)):
        for steps in _DRIVES:
            end_x = min(max(robot[0] + steps * moves[i, 0], bounds[0]), bounds[1])
            end_y = min(max(robot[1] + steps * moves[i, 1], bounds[2]), bounds[3])
            move_x, move_y = (end_x - robot[0]) / steps, (end_y - robot[1]) / steps
            depth, free, apart = 0.0, _AHEAD, np.inf
            for k in range(len(radii)):
                # Relative to the circle: during the first step, during the drive, and then while
                # the robot stays.
                dx, dy = robot[0] - centres[k, 0], robot[1] - centres[k, 1]
                vx, vy = move_x - drift[k, 0], move_y - drift[k, 1]
                depth = min(depth, measure_nearest(dx, dy, vx, vy) - radii[k])
                reach = radii[k] + margin
                met = _find_contact(dx, dy, vx, vy, reach)
                if met >= steps:
                    met = steps + _find_contact(
                        dx + steps * vx, dy + steps * vy, -drift[k, 0], -drift[k, 1], reach
                    )
                free = min(free, met)
                apart = min(apart, math.hypot(dx + vx, dy + vy) - radii[k])
            if (depth, free, apart) > (best_depth, best_time, best_apart):
                best = robot + np.array([move_x, move_y])
                best_depth, best_time, best_apart = depth, free, apart
            # To stay is free as far as the robot looks: it does not move without need.
            if i == 0 and depth == 0.0 and free == _AHEAD:
                return robot
    return best


@allocation_free
def _find_contact(dx, dy, vx, vy, reach):
    """Return when, in steps, a point at (dx, dy) with a velocity comes nearer than `reach` to the
    origin; at most `_AHEAD`.
    """
    excess, along, size = dx * dx + dy * dy - reach * reach, dx * vx + dy * vy, vx * vx + vy * vy
    if excess < 0.0:
        return 0.0
    root = along * along - size * excess
    if along >= 0.0 or root <= 0.0:
        return _AHEAD
    return min((-along - math.sqrt(root)) / size, _AHEAD)
