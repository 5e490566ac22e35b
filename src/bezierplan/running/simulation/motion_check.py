"""Decide whether a robot collided: exactly between steps, and independently of what the robot saw
or planned.

Between two vertices of its way the robot moves uniformly, and so does a circle between two steps;
the squared distance is a quadratic in time. On cells, the part driven between two changes is judged
by the certified check. Touching is allowed.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np

from bezierplan.geometry import checker
from bezierplan.geometry.region import build_region
from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.running.simulation import ways
from bezierplan.workspaces.worlds import ChangingCells, MovingCircles, World, positions

TOUCHING = 2 * checker.TOLERANCE
"""Depth in an obstacle, in units, up to which a robot only touches it. A path that the checker
calls free can be so deep.
"""


class Motion(NamedTuple):
    """A timed polyline. points: (n, 2), in units. times: (n,) ascending, in steps."""

    points: np.ndarray
    times: np.ndarray

    def at(self, times: np.ndarray | float) -> np.ndarray:
        """Return places (..., 2) at some times."""
        return ways.find_places(self.points, self.times, times)


class Verdict(NamedTuple):
    """The verdict on a motion.

    collision_at: time of the first collision, in steps; nan without one. clearance: (steps,) least
    distance to an obstacle in each step, in units, negative inside a circle; in changing cells it
    is 0 when colliding, and the border counts. depth: largest depth in an obstacle. tolerance:
    error of depth and clearance, in units.
    """

    collision_at: float
    clearance: np.ndarray
    depth: float
    tolerance: float


def check(motion: Motion, world: World) -> Verdict:
    """Judge a motion in a world."""
    if isinstance(world, ChangingCells):
        return _check_among_cells(motion, world)
    return _check_among_circles(motion, world)


def _check_among_circles(motion: Motion, world: MovingCircles) -> Verdict:
    """Judge a motion among moving circles."""
    walls = np.array(world.walls, dtype=float)
    hit, clearance = _measure_approach(
        motion.points, motion.times, world.centres, world.velocities, walls, world.radii, TOUCHING
    )
    x_low, x_high, y_low, y_high = world.bounds
    x, y = motion.points.T
    outside = np.max([x_low - x, x - x_high, y_low - y, y - y_high], axis=0)
    # The field is convex, so a way leaves it only at a vertex.
    left = motion.times[outside > TOUCHING].min(initial=math.inf)
    collision_at = min(hit, left)
    depth = max(-clearance.min(initial=math.inf), outside.max(), 0.0)
    return Verdict(
        collision_at if math.isfinite(collision_at) else math.nan,
        clearance,
        float(depth) if math.isfinite(collision_at) else 0.0,
        checker.TOLERANCE,
    )


@compile_kernel
def _measure_approach(points, times, centres, velocities, walls, radii, tolerance):
    """Return the time of the first collision, infinite without one, and the least clearance
    (steps,) in each step.
    """
    first_step, last_step = int(np.floor(times[0])), int(np.ceil(times[-1]))
    clearance = np.full(max(last_step - first_step, 1), np.inf)
    collision_at = np.inf
    step = first_step
    before = positions(centres, velocities, walls, step)
    after = positions(centres, velocities, walls, step + 1)
    for i in range(len(times) - 1):
        begin = times[i]
        while True:
            while begin >= step + 1:
                step += 1
                before, after = after, positions(centres, velocities, walls, step + 1)
            end = min(times[i + 1], step + 1.0)
            duration = times[i + 1] - times[i]
            one = (begin - times[i]) / duration if duration > 0.0 else 0.0
            other = (end - times[i]) / duration if duration > 0.0 else 1.0
            for k in range(len(centres)):
                # The robot relative to the circle, at the beginning and at the end.
                dx, dy = _compute_relative(points, i, one, before[k], after[k], begin - step)
                end_x, end_y = _compute_relative(points, i, other, before[k], after[k], end - step)
                ex, ey = end_x - dx, end_y - dy
                nearest = measure_nearest(dx, dy, ex, ey) - radii[k]
                # A motion that ends exactly with a step belongs to that step, not to the next one.
                place = min(step - first_step, len(clearance) - 1)
                clearance[place] = min(clearance[place], nearest)
                if nearest < -tolerance:
                    size, along, apart = ex * ex + ey * ey, dx * ex + dy * ey, dx * dx + dy * dy
                    excess = apart - radii[k] * radii[k]
                    entry = (
                        0.0
                        if excess <= 0.0
                        else (-along - math.sqrt(max(along * along - size * excess, 0.0))) / size
                    )
                    collision_at = min(collision_at, begin + entry * (end - begin))
            if end >= times[i + 1]:
                break
            begin = end
    return collision_at, clearance


@allocation_free
def measure_nearest(dx, dy, ex, ey):
    """Return the least distance from the origin of a point that moves from (dx, dy) by (ex, ey)."""
    size = ex * ex + ey * ey
    share = min(max(-(dx * ex + dy * ey) / size, 0.0), 1.0) if size > 0.0 else 0.0
    return math.hypot(dx + share * ex, dy + share * ey)


@allocation_free
def _compute_relative(points, i, share, before, after, part):
    """Return the robot's place at a share of leg i, relative to a circle at a part of its step."""
    x = points[i, 0] + share * (points[i + 1, 0] - points[i, 0])
    y = points[i, 1] + share * (points[i + 1, 1] - points[i, 1])
    return x - before[0] - part * (after[0] - before[0]), y - before[1] - part * (
        after[1] - before[1]
    )


def _check_among_cells(motion: Motion, world: ChangingCells) -> Verdict:
    """Judge a motion among cells that change."""
    first, last = math.floor(motion.times[0]), math.ceil(motion.times[-1])
    regions = [build_region(each) for each in world.maps]
    clearance = np.full(max(last - first, 1), np.inf)
    collision_at = math.nan
    depth = 0.0
    tolerance = 0.0
    inner = world.moments[(world.moments > motion.times[0]) & (world.moments < motion.times[-1])]
    # Within a cut the map is one and the step is one, so the check of still maps applies.
    cuts = np.unique(
        np.concatenate([[motion.times[0], motion.times[-1]], np.arange(first + 1, last), inner])
    )
    points, times = _add_vertices(motion, cuts)
    legs = np.stack([points[:-1], points[1:]], axis=1)
    for begin, end in itertools.pairwise(np.searchsorted(times, cuts)):
        check = checker.check(legs[begin:end], regions[world.index(times[begin])])
        step = math.floor(times[begin]) - first
        clearance[step] = min(clearance[step], check.clearance)
        depth, tolerance = max(depth, check.depth), max(tolerance, check.tolerance)
        if not check.feasible and math.isnan(collision_at):
            leg = min(int(check.collision_at), end - begin - 1)
            one, other = times[begin + leg : begin + leg + 2]
            collision_at = float(one + (check.collision_at - leg) * (other - one))
    return Verdict(collision_at, clearance, depth, tolerance)


def _add_vertices(motion: Motion, cuts: np.ndarray) -> Motion:
    """Return the same motion with a vertex at each cut. cuts: (k,) ascending times, in steps, the
    first and the last those of the motion.
    """
    others = ~np.isin(motion.times, cuts)
    times = np.concatenate([cuts, motion.times[others]])
    order = np.argsort(times, kind="stable")
    return Motion(np.concatenate([motion.at(cuts), motion.points[others]])[order], times[order])


def cut_motion(motion: Motion, begin: float, end: float) -> Motion:
    """Return the part of a motion between two times, with at least two vertices."""
    return Motion(*ways.cut(*motion, begin, end))
