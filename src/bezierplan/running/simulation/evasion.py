"""Where a robot steps that must not stay: aside, to the place that stays free longest."""

import math

import numpy as np
from numba import njit

from bezierplan.running.simulation.policy import Policy
from bezierplan.workspaces.worlds import MovingCircles, positions

# A robot that evades compares standing still with a step in each of this many directions, and looks so many steps ahead.
_DIRECTIONS = 32
_AHEAD = 10.0


def refuge(world: MovingCircles, place: np.ndarray, step: int, policy: Policy) -> np.ndarray:
    """The place (2,) where the robot is best at the end of a step: where it stands, unless a circle is about to come there.

    It knows what its policy lets it see. A step in which it meets no circle is better than one in which it does, then the later one comes
    nearer to it than `check_margin`, and then the farther it is from all of them.
    """
    walls = np.array(world.walls, dtype=float)
    looked = step + (policy.sees == "after")
    seen = positions(world.centres, world.velocities, walls, looked)
    drift = positions(world.centres, world.velocities, walls, looked + 1) - seen if policy.knows == "velocities" else np.zeros_like(seen)
    angles = 2.0 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    steps = world.pace * np.concatenate([np.zeros((1, 2)), np.column_stack([np.cos(angles), np.sin(angles)])])
    x_low, x_high, y_low, y_high = world.bounds
    places = np.clip(place + steps, [x_low, y_low], [x_high, y_high])
    during = seen - drift if policy.sees == "after" else seen
    return places[_best(place, places, during, drift, world.radii, float(policy.check_margin))]


@njit(cache=True)
def _best(place, places, centres, drift, radii, margin):
    """The number of the best of some places (n, 2) at the end of a step. centres: at its beginning, drift: per step."""
    best, best_depth, best_time, best_apart = 0, -np.inf, 0.0, 0.0
    for i in range(len(places)):
        depth, free, apart = 0.0, _AHEAD, np.inf
        for k in range(len(radii)):
            # Relative to the circle: during the step, and then while the robot stays.
            dx, dy = place[0] - centres[k, 0], place[1] - centres[k, 1]
            end_x, end_y = places[i, 0] - centres[k, 0] - drift[k, 0], places[i, 1] - centres[k, 1] - drift[k, 1]
            depth = min(depth, _nearest(dx, dy, end_x - dx, end_y - dy) - radii[k])
            free = min(free, _comes_at(end_x, end_y, -drift[k, 0], -drift[k, 1], radii[k] + margin))
            apart = min(apart, math.hypot(end_x, end_y) - radii[k])
        if (depth, free, apart) > (best_depth, best_time, best_apart):
            best, best_depth, best_time, best_apart = i, depth, free, apart
        if i == 0 and depth == 0.0 and free == _AHEAD:
            return 0
    return best


@njit(cache=True)
def _nearest(dx, dy, ex, ey):
    """Least distance from the origin of a point that moves from (dx, dy) by (ex, ey)."""
    size = ex * ex + ey * ey
    share = min(max(-(dx * ex + dy * ey) / size, 0.0), 1.0) if size > 0.0 else 0.0
    return math.hypot(dx + share * ex, dy + share * ey)


@njit(cache=True)
def _comes_at(dx, dy, vx, vy, reach):
    """When a point at (dx, dy) with a velocity comes nearer than `reach` to the origin, in steps; at most `_AHEAD`."""
    excess, along, size = dx * dx + dy * dy - reach * reach, dx * vx + dy * vy, vx * vx + vy * vy
    if excess < 0.0:
        return 0.0
    root = along * along - size * excess
    if along >= 0.0 or root <= 0.0:
        return _AHEAD
    return min((-along - math.sqrt(root)) / size, _AHEAD)
