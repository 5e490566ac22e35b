"""The outcome of a drive: columns of `columns.Outcome`, some with a meaning of their own, of
`columns.DriveOutcome`, and of `columns.DriveTimes`.
"""

import math

import numpy as np

from bezierplan.running import answer
from bezierplan.running.columns import DriveOutcome, DriveTimes, Outcome, Row
from bezierplan.running.simulation import cells, motion_check, ways
from bezierplan.running.simulation.robot import Ride
from bezierplan.workspaces.problem import Path, Problem
from bezierplan.workspaces.worlds import ChangingCells, World


def judge_drive(ride: Ride, drew: bool, problem: Problem, world: World) -> tuple[Row, Row]:
    """Judge a drive; return its columns (`Outcome`, `DriveOutcome`) and its trace.

    The trace has x and y at step 0, 1, ... and at the end, the clearance in each step, all in
    single precision, and time, curve and control points of each plan.
    """
    verdict = motion_check.check(ride.motion, world)
    points, times = ride.motion
    end = float(times[-1])
    curve, vertices = answer.store_path(trace_path(ride))
    done = ways.measure_lengths(points)
    travelled, collision = float(done[-1]), not math.isnan(verdict.collision_at)
    least = float(verdict.clearance.min())
    # The leg that leads to the collision: what the robot did before, not what it does once it is
    # hit.
    leg = 1 + np.searchsorted(times[1:-1], verdict.collision_at)
    places = ride.motion.at(np.append(np.arange(0, math.ceil(end)), end))
    outcome = Outcome(
        drew=drew,
        objective=end * world.pace if ride.arrived else math.inf,
        length=travelled,
        claimed_feasible=ride.arrived,
        # Without regard to what the robot believes: the motion leads from start to target.
        feasible=ride.arrived and joins_ends(points, problem) and not collision,
        collision_at=verdict.collision_at,
        collision_depth=verdict.depth,
        clearance=max(least, 0.0),
        clearance_error=verdict.tolerance,
        evaluations=sum(plan.evaluations for plan in ride.plans),
        generations=ride.replans,
        stop="arrived" if ride.arrived else "time",
        history=[float(np.interp(plan.time, times, done)) + plan.length for plan in ride.plans],
        path_curve=curve,
        path_points=vertices,
    )
    driving = DriveOutcome(
        arrival=end if ride.arrived else math.nan,
        steps=end,
        travelled=travelled,
        first_plan=ride.plans[0].length,
        last_plan=ride.plans[-1].length,
        last_optimum=_last_optimum(ride, world, problem),
        replans=ride.replans,
        waits=float(ride.waited),
        # Clearances below 0 exist within circles alone: any other collision counts as one step.
        collision_steps=int((verdict.clearance < -motion_check.TOUCHING).sum())
        if least < 0
        else int(collision),
        hit_waiting=collision and bool(np.array_equal(points[leg], points[leg - 1])),
        clearance_least=least,
    )
    plans = [answer.store_path(plan.path) for plan in ride.plans]
    trace = {
        "x": places[:, 0].astype(np.float32),
        "y": places[:, 1].astype(np.float32),
        "clearance": verdict.clearance.astype(np.float32),
        "plan_time": [plan.time for plan in ride.plans],
        "plan_curve": [curve for curve, _ in plans],
        "plan_points": [points for _, points in plans],
    }
    return outcome._asdict() | driving._asdict(), trace


def joins_ends(points: np.ndarray, problem: Problem) -> bool:
    """Return whether a way (n, 2) leads exactly from a problem's start to its target."""
    return np.array_equal(points[[0, -1]], problem.ends)


def trace_path(ride: Ride) -> Path:
    """Return the path of a drive, without its waits."""
    points = ways.build_way(ride.motion.points).points
    # A polyline has two points at least, also that of a robot which never moved.
    return Path("polyline", points if len(points) > 1 else np.repeat(points, 2, axis=0))


def _last_optimum(ride: Ride, world: World, problem: Problem) -> float:
    """Return `cells.bound_plan` for the last plan of a drive; nan among circles."""
    if not isinstance(world, ChangingCells):
        return math.nan
    time = ride.plans[-1].time
    return cells.bound_plan(
        motion_check.cut_motion(ride.motion, 0.0, time), world.workspace(time), problem.target
    )


def replan_times(ride: Ride) -> DriveTimes:
    """Return statistics of the CPU seconds of all plans after the first."""
    # Without a further plan all are nan.
    seconds = [plan.seconds for plan in ride.plans[1:]] or [math.nan]
    return DriveTimes(
        float(np.mean(seconds)), float(np.quantile(seconds, 0.95)), float(np.max(seconds))
    )
