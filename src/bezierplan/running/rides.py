"""One chunk of runs in moving worlds: like `execution`, of which it keeps names, seeds and columns,
but a run is a simulated drive.

A chunk has a policy: the values of a `simulation.policy.Policy` by name. Columns are those of
`columns.Outcome`, some with a meaning of their own, and `columns.DriveOutcome`; of times, those of
`columns.Times` and `columns.DriveTimes`.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path as File
from typing import Any

import numpy as np
import pyarrow as pa

from bezierplan.planners import Plan, is_file, planner_module
from bezierplan.running import execution, rows
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
from bezierplan.running.guard import process, worker
from bezierplan.running.jobs.watchdog import PlannerFailure, begin, executing
from bezierplan.running.judge import answer
from bezierplan.running.simulation import bounds, cells, motion_check, robot, ways
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.policy import Policy
from bezierplan.running.simulation.robot import Ride
from bezierplan.workspaces.problem import Path, Problem
from bezierplan.workspaces.worlds import ChangingCells, World, from_json, to_json


def drives(
    planner: str,
    policy: dict[str, Any],
    problems: dict[str, Problem],
    worlds: dict[str, World],
    runs: Iterable[tuple[worker.Task, list[str]]],
    begins: Callable[[str], None] = lambda name: None,
) -> Iterator[tuple[Ride, float, float]]:
    """Drives of a robot, one after the other, each with its CPU and wall-clock seconds.

    runs: each with the names that no extra column of its plans may have. begins: told the name of
    each run. Raises PlannerFailure, naming the run, if the planner fails or a plan is not valid for
    what the robot saw.
    """
    rules = Policy.model_construct(**policy)
    for task, taken in runs:
        begins(task.name)
        with executing(task.name):
            asked = _planner(planner, rules.warm, task, taken)
            place = worlds[task.problem], problems[task.problem]
            driven = worker.timed(partial(robot.drive, *place, rules, asked))
        yield driven


def _planner(planner: str, warm: bool, task: worker.Task, taken: list[str]) -> robot.Planner:
    """A planner with its settings and the random numbers of a drive. Its plans are plain values."""
    module, rng = planner_module(planner), task.generator()

    def planned(seen: Problem, last: Any) -> tuple[Plan, Any]:
        if warm:
            pair = module.resume(seen, rng, last, **task.settings)
            if not isinstance(pair, tuple) or len(pair) != 2:
                raise TypeError(
                    f"resume returns a {type(pair).__name__}; expected a Plan and what the next "
                    "call gets as last"
                )
            plan, state = pair
        else:
            plan, state = module.plan(seen, rng, **task.settings), None
        try:
            return answer.accepted(plan, seen, taken), state
        except answer.Unfit as fault:
            raise PlannerFailure(f"{task.name}: its answer: {fault}") from None

    return planned


def plain_drives(
    begins: Callable[[str], None],
    planner: str,
    policy: dict[str, Any],
    problems: dict[str, list[Any]],
    worlds: dict[str, str],
    runs: list[list[Any]],
) -> Iterator[list[Any]]:
    """`drives` as plain values, for a process of its own."""
    met = worker.unpacked_problems(problems)
    moving = {name: from_json(text) for name, text in worlds.items()}
    tasks = [(worker.Task(*task), taken) for task, taken in runs]
    for ride, cpu, wall in drives(planner, policy, met, moving, tasks, begins):
        yield [_packed(ride), cpu, wall]
    again = {name: to_json(world) for name, world in moving.items()}
    worker.refuse_changed(worlds, again, tasks[-1][0].name)


def _packed(ride: Ride) -> list[Any]:
    plans = [[*plan._replace(path=answer.stored(plan.path))] for plan in ride.plans]
    return [ride.motion.points.tolist(), ride.motion.times.tolist(), *ride[1:3], plans]


def _unpacked(points: list, times: list, arrived: bool, waited: float, plans: list) -> Ride:
    of_plans = [robot.Planned(*plan) for plan in plans]
    return Ride(
        Motion(np.array(points, dtype=float).reshape(-1, 2), np.array(times, dtype=float)),
        arrived,
        waited,
        [plan._replace(path=answer.restored(*plan.path)) for plan in of_plans],
    )


def run(
    chunk: Chunk,
    runs: Iterable[tuple[Condition, int]],
    problems: dict[str, Problem],
    worlds: dict[str, World],
) -> Iterator[tuple[Ride, float, float]]:
    """`drives` of runs of a chunk, by condition and repeat."""
    tasks = [
        (task, execution.taken(task, condition))
        for condition, repeat in runs
        for task in [execution.task(chunk, condition, repeat)]
    ]
    if not is_file(chunk.planner):
        begins = partial(begin, chunk.time_limit)
        yield from drives(chunk.planner, chunk.policy, problems, worlds, tasks, begins)
        begin(None, execution.told_chunk(chunk))
        return
    arguments = {
        "planner": str(File(chunk.planner).resolve()),
        "policy": chunk.policy,
        "problems": worker.packed_problems(problems),
        "worlds": {name: to_json(world) for name, world in worlds.items()},
        "runs": tasks,
    }
    name = execution.told_chunk(chunk)
    for ride, cpu, wall in process.answers("rides.plain_drives", arguments, name, chunk.time_limit):
        with process.plain_values(name):
            yield _unpacked(*ride), process.seconds(cpu), process.seconds(wall)


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
    """The runs of a chunk, their times, and their traces (`row`). Raises PlannerFailure, naming the
    run, if a planner fails, does not return a valid plan, or changes a world.
    """
    met = {name: problems[name] for name in chunk.problems}
    moving = {name: worlds[name] for name in chunk.problems}
    runs = [
        (condition, repeat) for condition in chunk.conditions() for repeat in range(*chunk.repeats)
    ]
    # The first drive compiles and loads, and must repeat itself.
    runs = [*runs[:1], *runs]
    again, *made = [
        (*row(chunk, *named, ride, *place), Times("", cpu, wall), ride)
        for named, (ride, cpu, wall) in zip(runs, run(chunk, runs, met, moving), strict=True)
        for place in [(met[named[0].problem], moving[named[0].problem])]
    ]
    execution.refuse_unrepeatable(again[:1], made[0][0], chunk, deterministic=False)
    times = [
        taken._replace(id=drive["id"])._asdict()
        | _replan_times(ride, chunk.policy["step_seconds"])._asdict()
        for drive, _, taken, ride in made
    ]
    return (
        rows.table([drive for drive, *_ in made], Planned, Outcome, DriveOutcome),
        rows.table(times, Times, DriveTimes),
        pa.Table.from_pylist([trace for _, trace, *_ in made]),
    )


def rerun(
    chunk: Chunk, row: Mapping[str, Any], problem: Problem, world: World
) -> tuple[Ride, motion_check.Verdict]:
    """The drive of a run, by its row, and the verdict on it: for what no table keeps. Raises
    ValueError if it has another path than the row.
    """
    named = {each.name: each for each in chunk.conditions()}
    condition, repeat = named[row["condition"]], int(row["repeat"])
    name = condition.problem
    ((ride, *_),) = run(chunk, [(condition, repeat)], {name: problem}, {name: world})
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
