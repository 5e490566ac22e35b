"""Simulate a drive: plans, motion, and records of both."""

import itertools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from bezierplan.geometry.region import build_region, is_blocked
from bezierplan.planners import Plan
from bezierplan.running.jobs.watchdog import measure_cpu_time
from bezierplan.running.simulation import cells, circles
from bezierplan.running.simulation.circles import ARRIVED, STOPPED
from bezierplan.running.simulation.evasion import find_refuge
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.policy import Policy
from bezierplan.running.simulation.ways import Way, build_drivable, build_way
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.limits import Place
from bezierplan.workspaces.problem import Path, Problem
from bezierplan.workspaces.worlds import ChangingCells, MovingCircles, World

Planner = Callable[[Problem, Any], tuple[Plan, Any]]
"""A planner with its settings and random numbers. It takes a problem and, for a warm start, the
state that it returned beside its last plan.
"""


class DrivePlan(NamedTuple):
    """A plan that the robot made.

    time: in steps. path: the planner's, or None. length: that of the way to it and along it, in
    units. seconds: CPU time. evaluations: as in `Plan`.
    """

    time: float
    path: Path | None
    length: float
    seconds: float
    evaluations: int


class Ride(NamedTuple):
    """A robot's way through a world. arrived: it reached the target. waited: time, in steps."""

    motion: Motion
    arrived: bool
    waited: float
    plans: list[DrivePlan]

    @property
    def replans(self) -> int:
        """Return the number of plans after the first."""
        return len(self.plans) - 1


class _Log:
    """The motion so far."""

    def __init__(self, place: Place) -> None:
        self.points, self.times, self.waited = [np.array([place], dtype=float)], [np.zeros(1)], 0.0

    def motion(self) -> Motion:
        """Return the motion so far, with at least two vertices."""
        points, times = np.concatenate(self.points), np.concatenate(self.times)
        # A motion of one vertex has no leg to judge.
        if len(times) == 1:
            points, times = np.repeat(points, 2, axis=0), np.repeat(times, 2)
        return Motion(points, times)

    def follow(self, along: Way, times: np.ndarray, progress: np.ndarray, pace: float) -> None:
        """Add a drive along a way: the lengths of it reached at some times.

        Between these the robot waits or drives at its pace. It may reach the last length before its
        time.
        """
        for k, (begin, end) in enumerate(itertools.pairwise(progress)):
            if end == begin:
                self.wait(times[k + 1])
                continue
            inside = along.at[(along.at > begin) & (along.at < end)]
            lengths = np.append(inside, end)
            self.points.append(along.place(lengths))
            self.times.append(times[k] + (lengths - begin) / pace)

    def drive(self, place: np.ndarray, until: float) -> None:
        """Append a straight drive from the last point to a place (2,), reached `until` a step."""
        self.points.append(place[None])
        self.times.append(np.array([until]))

    def wait(self, until: float) -> None:
        """Add a wait."""
        self.waited += until - self.times[-1][-1]
        self.drive(self.points[-1][-1], until)


def drive(world: World, problem: Problem, policy: Policy, planner: Planner) -> Ride:
    """Drive from start to target, until the robot arrives or the world's time is over."""
    log, plans, state = _Log(problem.start), [], None
    time, changing = 0.0, isinstance(world, ChangingCells)
    follow = cells.follow if changing else circles.follow
    while time < world.end:
        made, along, state = _plan(
            world, problem, policy, planner, log, time, state if policy.warm else None
        )
        plans.append(made)
        event = STOPPED
        if along is not None:
            event, times, reached = follow(world, along, time, policy)
            log.follow(along, times, reached, world.pace)
            time = float(times[-1])
        if event == ARRIVED:
            return Ride(log.motion(), True, log.waited, plans)
        if event == STOPPED:
            place = log.points[-1][-1]
            aside = place
            if policy.evades and not changing:
                aside = find_refuge(world, place, round(time), policy)
            # A robot without a way looks again after a step, or as soon as a cell changes.
            changes = world.moments[world.moments > time] if changing else np.empty(0)
            time = float(min(math.floor(time) + 1, changes.min(initial=math.inf), world.end))
            if np.array_equal(aside, place):
                log.wait(time)
            else:
                log.drive(aside, time)
    return Ride(log.motion(), False, log.waited, plans)


def _plan(
    world: World,
    problem: Problem,
    policy: Policy,
    planner: Planner,
    log: _Log,
    time: float,
    state: Any,
) -> tuple[DrivePlan, Way | None, Any]:
    """Plan from where the robot is; return the plan, the way that it then follows (None without a
    path), and the planner's state.
    """
    motion = log.motion()
    approach, evaluations, began = motion.points[-1:], 0, measure_cpu_time()

    def record_plan(path: Path | None, length: float) -> DrivePlan:
        """Return a plan with the CPU time so far."""
        return DrivePlan(time, path, length, measure_cpu_time() - began, evaluations)

    changing = isinstance(world, ChangingCells)
    looked = time if changing else round(time) + (policy.sees == "after")
    if policy.start == "centre" or changing:
        approach = cells.find_way_to_start(motion, world.workspace(time), policy.start)
    # Cells do not grow.
    margins = (0.0,) if changing else policy.plan_margins
    obstacles = build_region(world.obstacles(looked))
    for margin in margins:
        position = tuple(map(float, approach[-1]))
        seen = Problem(problem.name, world.workspace(looked, margin), position, problem.target)
        if position == problem.target:
            return record_plan(None, 0.0), build_way(approach), state
        # The next margin may leave both ends free.
        if not (_is_free(world, seen, position) and _is_free(world, seen, problem.target)):
            continue
        plan, next_state = planner(seen, state)
        evaluations += plan.evaluations
        if plan.path is not None and plan.claimed_feasible:
            along = build_way(
                np.concatenate([approach, build_drivable(plan.path, policy.spacing, obstacles)])
            )
            return record_plan(plan.path, along.length), along, next_state
    return record_plan(None, math.inf), None, state


def _is_free(world: World, problem: Problem, point: Place) -> bool:
    """Return whether a place is free in the workspace that a planner sees. Where circles are drawn
    as cells, the whole cell must be.
    """
    seen = problem.workspace
    if isinstance(world, MovingCircles) and isinstance(seen, Grid):
        cell = seen.cell_of(*point)
        return cell is not None and not seen.occupied[cell]
    return not is_blocked(build_region(seen), point)
