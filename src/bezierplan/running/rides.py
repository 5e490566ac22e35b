"""One chunk of runs in moving worlds: like `execution`, of which it keeps names, seeds and columns,
but a run is a simulated drive.

A chunk has a policy: the values of a `simulation.policy.Policy` by name. Columns are those of
`columns.Outcome`, some with a meaning of their own, and `columns.DriveOutcome`; of times, those of
`columns.Times` and `columns.DriveTimes`.
"""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np
import pyarrow as pa

from bezierplan.planners import Plan, is_file, planner_module
from bezierplan.running import apart, execution, rows, watchdog
from bezierplan.running import problems as problem_files
from bezierplan.running.chunk import Chunk, Condition
from bezierplan.running.columns import (
    Bound,
    DriveBound,
    DriveOutcome,
    DriveTimes,
    Outcome,
    Planned,
    Times,
)
from bezierplan.running.loans import lend_once
from bezierplan.running.simulation import bounds, cells, motion_check, ways
from bezierplan.running.simulation.policy import Policy
from bezierplan.running.simulation.robot import Ride, drive
from bezierplan.workspaces.problem import Path, Problem
from bezierplan.workspaces.worlds import ChangingCells, World, from_json, to_json


class _Driver:
    """Makes the plans of a chunk's drives, of one drive after the other.

    What a planner keeps from plan to plan stays here: the generator of the drive, and what `resume`
    returned with a plan, by a number.
    """

    def __init__(self, chunk: Chunk) -> None:
        self._chunk = chunk
        self._policy = Policy.model_construct(**chunk.policy)

    def plan(
        self, condition: Condition, repeat: int, seen: Problem, last: int | None, number: int
    ) -> Any:
        """The answer to what the robot sees. number: of this plan in its drive, from 0. last: the
        number of the plan from which this one starts.
        """
        chunk = self._chunk
        if number == 0:
            self._rng = execution.generator(chunk, condition, repeat)
            self._states = {}
        module, settings = planner_module(chunk.planner), execution.settings_in(chunk, condition)
        loan = lend_once(seen)
        if self._policy.warm:
            state = self._states.get(last)
            answer = module.resume(loan.problem, self._rng, state, **settings)
            if type(answer) is not tuple or len(answer) != 2:
                raise TypeError(
                    f"resume returns a {type(answer).__name__}; expected a Plan and what the next "
                    "call gets as last"
                )
            plan, new = answer
            self._states = {last: state, number: new}
        else:
            plan = module.plan(loan.problem, self._rng, **settings)
        execution.refuse_changed(loan, chunk, condition, repeat)
        return plan


@contextmanager
def driver(chunk: Chunk) -> Iterator[Callable[..., Any]]:
    """Yield what makes the plans of a chunk's drives, for `run`."""
    name = execution.told_chunk(chunk)
    with apart.asking(is_file(chunk.planner), name, _Driver(chunk).plan) as ask:
        yield ask


def run(
    chunk: Chunk,
    condition: Condition,
    repeat: int,
    problem: Problem,
    world: World,
    ask: Callable[..., Any],
) -> Ride:
    """The drive of one run. ask: from `driver`. Raises UnfitAnswer for a plan not valid for what
    the robot saw.
    """
    name, numbers = execution.told_run(chunk, condition, repeat), itertools.count()

    def planner(seen: Problem, last: int | None) -> tuple[Plan, int]:
        number = next(numbers)
        plan = ask(name, condition, repeat, seen, last, number)
        return execution.accepted(plan, seen, chunk, condition, repeat), number

    return drive(world, problem, Policy.model_construct(**chunk.policy), planner)


def row(
    chunk: Chunk, condition: Condition, repeat: int, ride: Ride, problem: Problem, world: World
) -> tuple[dict[str, Any], dict[str, Any]]:
    """One row of the runs table, and one of the table of traces: id; x and y at step 0, 1, ... and
    at the end of the drive, and clearance in each step, all in single precision; and the plans, by
    the time, curve and control points of each.
    """
    verdict = motion_check.check(ride.motion, world)
    points, times = ride.motion
    path = _driven(ride)
    done = ways.lengths(points)
    travelled, collided = float(done[-1]), not math.isnan(verdict.collision_at)
    least = float(verdict.clearance.min())
    lengths = [plan.length for plan in ride.plans]
    driven = [float(np.interp(plan.time, times, done)) for plan in ride.plans]
    # The leg that leads to the collision: what the robot did before, not what it does once it is
    # hit.
    leg = (
        int(np.clip(np.searchsorted(times, verdict.collision_at, side="left"), 1, len(times) - 1))
        if collided
        else 0
    )
    places = ride.motion.at(np.append(np.arange(0, math.ceil(times[-1])), times[-1]))
    # Without regard to what the robot believes: the motion itself leads from start to target.
    joins = (tuple(points[0].tolist()), tuple(points[-1].tolist())) == (
        problem.start,
        problem.target,
    )
    outcome = Outcome(
        objective=float(times[-1]) * world.pace if ride.arrived else math.inf,
        length=travelled,
        claimed_feasible=ride.arrived,
        feasible=ride.arrived and joins and not collided,
        collision_at=verdict.collision_at,
        collision_depth=verdict.depth,
        clearance=max(least, 0.0),
        clearance_error=verdict.tolerance,
        evaluations=sum(plan.evaluations for plan in ride.plans),
        generations=ride.replans,
        stop="arrived" if ride.arrived else "time",
        history=[way + length for way, length in zip(driven, lengths)],
        path_curve=path.curve,
        path_points=path.points.ravel().tolist(),
    )
    driving = DriveOutcome(
        arrival=float(times[-1]) if ride.arrived else math.nan,
        steps=float(times[-1]),
        travelled=travelled,
        first_plan=lengths[0],
        last_plan=lengths[-1],
        last_optimum=_last_optimum(ride, world, problem),
        replans=ride.replans,
        waits=float(ride.waited),
        collision_steps=int((verdict.clearance < -motion_check.TOUCHING).sum())
        if least < 0
        else int(collided),
        hit_waiting=collided and bool(np.array_equal(points[leg], points[leg - 1])),
        clearance_least=least,
    )
    columns = execution.identity(chunk, condition, repeat) | outcome._asdict() | driving._asdict()
    trace = {
        "id": columns["id"],
        "x": places[:, 0].astype(np.float32),
        "y": places[:, 1].astype(np.float32),
        "clearance": verdict.clearance.astype(np.float32),
        "plan_time": [plan.time for plan in ride.plans],
        "plan_curve": [plan.path.curve if plan.path else "" for plan in ride.plans],
        "plan_points": [
            plan.path.points.ravel().tolist() if plan.path else [] for plan in ride.plans
        ],
    }
    return columns, trace


def _driven(ride: Ride) -> Path:
    """The path of a drive, without its waits."""
    points = ride.motion.points
    moved = np.concatenate([[True], np.any(points[1:] != points[:-1], axis=1)])
    return Path("polyline", points[moved] if moved.sum() > 1 else np.repeat(points[:1], 2, axis=0))


def _last_optimum(ride: Ride, world: World, problem: Problem) -> float:
    """`cells.least_plan` for the last plan of a drive; nan among circles."""
    if not isinstance(world, ChangingCells):
        return math.nan
    time = ride.plans[-1].time
    return cells.least_plan(
        motion_check.between(ride.motion, 0.0, time), world.workspace(time), problem.target
    )


def run_chunk(
    problems: dict[str, Problem], worlds: dict[str, World], chunk: Chunk
) -> tuple[pa.Table, pa.Table, pa.Table]:
    """The runs of a chunk, their times, and their traces (`row`).

    Robots drive in copies of the worlds, and these stay here to judge by. Raises RuntimeError,
    naming the run, if a planner fails, does not return a valid plan, or changes a world.
    """
    texts = {name: to_json(worlds[name]) for name in chunk.problems}
    driven = {name: from_json(text) for name, text in texts.items()}
    drives, times, traces = [], [], []
    with driver(chunk) as ask, watchdog.watching(chunk.time_limit) as watch:
        for condition in chunk.conditions():
            for repeat in range(*chunk.repeats):
                problem, world = problems[condition.problem], worlds[condition.problem]
                name = execution.told_run(chunk, condition, repeat)
                once = partial(
                    run, chunk, condition, repeat, problem, driven[condition.problem], ask
                )
                if not drives:
                    # Compiles and loads.
                    first, *_ = execution.timed(once, name, watch)
                ride, cpu, wall = execution.timed(once, name, watch)
                drive, trace = row(chunk, condition, repeat, ride, problem, world)
                if not drives:
                    again, _ = row(chunk, condition, repeat, first, problem, world)
                    execution.refuse_unrepeatable([again], drive, chunk, deterministic=False)
                drives.append(drive)
                traces.append(trace)
                replans = _replan_times(ride, chunk.policy["step_seconds"])
                times.append(Times(drive["id"], cpu, wall)._asdict() | replans._asdict())
    for name, text in texts.items():
        if to_json(driven[name]) != text:
            raise execution.UnfitAnswer(
                f"{execution.told_chunk(chunk)}: problem: {name}: world: is another after the runs"
            )
    runs = rows.table(drives, Planned, Outcome, DriveOutcome)
    return runs, rows.table(times, Times, DriveTimes), pa.Table.from_pylist(traces)


def rerun(
    chunk: Chunk, row: Mapping[str, Any], problem: Problem, world: World
) -> tuple[Ride, motion_check.Verdict]:
    """The drive of a run, by its row, and the verdict on it: for what no table keeps. Raises
    ValueError if it has another path than the row.
    """
    named = {each.name: each for each in chunk.conditions()}
    with driver(chunk) as ask:
        ride = run(chunk, named[row["condition"]], int(row["repeat"]), problem, world, ask)
    execution.refuse_other_path(row, _driven(ride).points)
    return ride, motion_check.check(ride.motion, world)


def _replan_times(ride: Ride, step_seconds: float) -> DriveTimes:
    seconds = np.array([plan.seconds for plan in ride.plans[1:]])
    late = int((seconds > step_seconds).sum())
    if not len(seconds):
        return DriveTimes(math.nan, math.nan, math.nan, late)
    return DriveTimes(
        float(seconds.mean()), float(np.quantile(seconds, 0.95)), float(seconds.max()), late
    )


def bounds_of(problems: dict[str, Problem], worlds: dict[str, World]) -> pa.Table:
    """One row per problem: columns of `columns.Bound`, without an octile bound, and of
    `columns.DriveBound`.
    """
    made = []
    for name, problem in problems.items():
        least = bounds.least_way(worlds[name], problem)
        arrival = DriveBound(bounds.least_arrival(worlds[name], problem))
        made.append(
            problem_files.bound_row(name, problem, least, math.nan)._asdict() | arrival._asdict()
        )
    return rows.table(made, Bound, DriveBound)
