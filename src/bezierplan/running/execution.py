"""Run a chunk: one method on each condition of an experiment, for a block of repeats. In a world
that moves, a run is a drive.
"""

import itertools
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import pyarrow as pa

from bezierplan.geometry.region import Region, build_region
from bezierplan.planners import is_file
from bezierplan.running import answer, drives, table_files
from bezierplan.running.chunk import Chunk, Condition, Settings
from bezierplan.running.columns import (
    ANSWER,
    TAKEN,
    DriveOutcome,
    DriveTimes,
    Outcome,
    Planned,
    Row,
    Times,
)
from bezierplan.running.guard import interface, process, worker
from bezierplan.running.jobs import log
from bezierplan.running.jobs.watchdog import PlannerFailure, begin
from bezierplan.running.problems import Problems, Worlds
from bezierplan.running.simulation import motion_check
from bezierplan.running.simulation.robot import Ride
from bezierplan.workspaces import seeds
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import World


def run_id(chunk: Chunk, condition: Condition, repeat: int) -> str:
    """Return the name of a run: study/experiment/condition/method/repeat."""
    return f"{chunk.study}/{chunk.experiment}/{condition.name}/{chunk.method}/{repeat}"


def resolve_settings(chunk: Chunk, condition: Condition) -> Settings:
    """Return all settings of a chunk's method under a condition.

    Those of the problem come first, then the varied values. Those that are no settings of the
    planner are left out.
    """
    settings = chunk.settings | chunk.problems[condition.problem].get("settings", {})
    settings |= condition.values
    accepted = interface.read_traits(chunk.planner).settings
    return {name: value for name, value in settings.items() if name in accepted}


def build_task(chunk: Chunk, condition: Condition, repeat: int) -> worker.Task:
    """Return a run in the form that `guard.worker` executes."""
    layout = chunk.problems[condition.problem].get("layout", "")
    # The seed follows from names only, not from order, cores or chunks, so any run can be repeated
    # alone.
    parts = {
        "own": [condition.name, chunk.method],
        "shared": [condition.name],
        "common": [layout],
    }
    return worker.Task(
        f"run {run_id(chunk, condition, repeat)}: planner {chunk.planner}",
        condition.problem,
        [chunk.study, chunk.experiment, *parts[chunk.seeds], repeat],
        resolve_settings(chunk, condition),
    )


def describe_chunk(chunk: Chunk) -> str:
    """Return how a message about all runs of a chunk begins, with a star for conditions."""
    return f"run {chunk.study}/{chunk.experiment}/*/{chunk.method}: planner {chunk.planner}"


def run_tasks(
    chunk: Chunk,
    problems: Problems,
    tasks: Sequence[worker.Task],
    again: Sequence[worker.Task] = (),
    worlds: Worlds | None = None,
    function: str = "plan",
) -> Iterator[worker.Reply]:
    """Run tasks of a chunk's planner, as `worker.run_tasks` does: in this process, or in one of its
    own if the planner is a user's file. Raises PlannerFailure, naming the run.
    """
    work = worker.Work(chunk.planner, problems, function, worlds, chunk.policy)
    # A user's file may crash or stall the process that runs it.
    if is_file(chunk.planner):
        yield from process.run_isolated(work, tasks, again, describe_chunk(chunk), chunk.time_limit)
        return
    yield from worker.run_tasks(work, tasks, again, partial(begin, chunk.time_limit))
    # The limit of time is for runs; judging the last one does not count.
    begin(None, describe_chunk(chunk))


def run(
    chunk: Chunk,
    condition: Condition,
    repeat: int,
    problem: Problem,
    world: World | None = None,
    function: str = "plan",
) -> Any:
    """Make one run and return its plan; its ride, in a world that moves.

    function: `plan`, or `track` for the control points (n, 2) of the best path after each
    iteration.
    """
    name, tasks = condition.problem, [build_task(chunk, condition, repeat)]
    worlds = {name: world} if world else None
    (only,) = run_tasks(chunk, {name: problem}, tasks, worlds=worlds, function=function)
    return only.result


def track_again(chunk: Chunk, row: Mapping[str, Any], problem: Problem) -> list[np.ndarray]:
    """Repeat a stored run, and return its track. Raises ValueError if it ends in another path than
    its row.
    """
    track = run(chunk, *_find_condition(chunk, row), problem, function="track")
    _refuse_other_path(row, track[-1])
    return track


def drive_again(
    chunk: Chunk, row: Mapping[str, Any], problem: Problem, world: World
) -> tuple[Ride, motion_check.Verdict]:
    """Repeat a stored drive, and return it with its verdict, because no table keeps all of a drive.
    Raises ValueError if it ends in another path than its row.
    """
    ride = run(chunk, *_find_condition(chunk, row), problem, world)
    _refuse_other_path(row, drives.trace_path(ride).points)
    return ride, motion_check.check(ride.motion, world)


def _find_condition(chunk: Chunk, row: Mapping[str, Any]) -> tuple[Condition, int]:
    """Return the condition and the repeat of a row."""
    return {each.name: each for each in chunk.conditions()}[row["condition"]], int(row["repeat"])


def _refuse_other_path(run: Mapping[str, Any], points: np.ndarray) -> None:
    """Raise ValueError unless a repeated run has the points (n, 2) of its row's path."""
    if not np.array_equal(points.ravel(), run["path_points"]):
        raise ValueError(
            f"run {run['id']}: its rerun ends in another path; the runs table comes from another "
            "version of the code"
        )


def identify_run(chunk: Chunk, condition: Condition, repeat: int) -> Row:
    """Return the first columns of a row: the run's id and its parts, its place, and all
    settings.
    """
    return {
        "id": run_id(chunk, condition, repeat),
        "study": chunk.study,
        "experiment": chunk.experiment,
        "condition": condition.name,
        "problem": condition.problem,
        **{
            key: value
            for key, value in chunk.problems[condition.problem].items()
            if key != "settings"
        },
        "method": chunk.method,
        "repeat": repeat,
        "planner": chunk.planner,
        **resolve_settings(chunk, condition),
        **condition.values,
    }


def build_row(
    chunk: Chunk,
    condition: Condition,
    repeat: int,
    plan: Any,
    drew: bool,
    problem: Problem,
    blocked: Region,
) -> Row:
    """Build one row of the runs table from a planner's answer.

    drew: the run drew random numbers. blocked: the region of the problem's workspace. Raises
    PlannerFailure if the answer is not valid for this problem: for example, if its path begins or
    ends elsewhere, or a column would overwrite another.
    """
    run = build_task(chunk, condition, repeat)
    with answer.wrap_errors(run.name):
        plan = answer.accept_answer(plan, problem, [*TAKEN, *run.settings, *condition.values])
        answer.check_history(plan, interface.read_traits(chunk.planner).keeps_best)
    curve, points = answer.store_path(plan.path)
    outcome = Outcome(
        drew=drew,
        objective=plan.objective,
        claimed_feasible=plan.claimed_feasible,
        # The verdict is that of the points which the row holds.
        **answer.judge_path(answer.restore_path(curve, points), blocked),
        evaluations=plan.evaluations,
        generations=len(plan.history) - 1,
        stop=plan.stop,
        history=plan.history.tolist(),
        path_curve=curve,
        path_points=points,
    )
    return identify_run(chunk, condition, repeat) | outcome._asdict() | plan.extra


def make_rows_again(
    chunk: Chunk,
    runs: list[tuple[Condition, int]],
    problems: Problems,
    worlds: Worlds,
) -> list[Row]:
    """Repeat some runs and return their rows."""
    tasks = [build_task(chunk, *run) for run in runs]
    met = {condition.problem: problems[condition.problem] for condition, _ in runs}
    judge_reply = _build_judge(chunk, met, worlds)
    return [
        judge_reply(*run, each)[0]
        for run, each in zip(runs, run_tasks(chunk, met, tasks, worlds=worlds))
    ]


def _build_judge(
    chunk: Chunk, problems: Problems, worlds: Worlds
) -> Callable[[Condition, int, worker.Reply], tuple[Row, Row]]:
    """Return a function that turns a worker's reply into a row and, for a drive, its trace."""
    # Built once: all runs on a problem are judged on the same region.
    regions = (
        {} if worlds else {name: build_region(each.workspace) for name, each in problems.items()}
    )

    def judge_reply(condition: Condition, repeat: int, reply: worker.Reply) -> tuple[dict, dict]:
        name, result, drew = condition.problem, reply.result, reply.drew
        if not worlds:
            return build_row(
                chunk, condition, repeat, result, drew, problems[name], regions[name]
            ), {}
        known = identify_run(chunk, condition, repeat)
        outcome, trace = drives.judge_drive(result, drew, problems[name], worlds[name])
        return known | outcome, {"id": known["id"]} | trace

    return judge_reply


def run_chunk(
    problems: Problems, chunk: Chunk, worlds: Worlds | None = None
) -> tuple[pa.Table, ...]:
    """Run a chunk; return tables of its runs and its times (columns as in `columns`), and of traces
    if the runs are drives.

    Raises PlannerFailure, naming the run, if a planner fails, does not return a valid plan for the
    problem (`build_row`), or gives another plan when its first or last run is repeated. If all
    repeats of a planner are equal, and it does not declare so, a line on stderr says it.
    """
    met = {name: problems[name] for name in chunk.problems}
    moving = {name: worlds[name] for name in met} if worlds else {}
    every, judge_reply = chunk.conditions(), _build_judge(chunk, met, moving)
    deterministic = interface.read_traits(chunk.planner).deterministic
    order = _order(chunk, len(every), range(*chunk.repeats))
    tasks = [build_task(chunk, every[k], repeat) for k, repeat in order]
    # They are made twice: the first run, and in a process of its own the last one. A deterministic
    # planner gets another repeat's generator, which must change nothing.
    again = [
        build_task(chunk, every[k], repeat + deterministic) for k, repeat in (order[0], order[-1])
    ]
    warm, done, first, failures = defaultdict(list), {}, None, {}
    for reply in run_tasks(chunk, met, tasks, again, moving):
        (k, repeat), first = order[reply.number], first or reply.result
        try:
            outcome, trace = judge_reply(every[k], repeat, reply)
            if not moving:
                with answer.wrap_errors(tasks[reply.number].name):
                    answer.check_columns(reply.result, first, is_file(chunk.planner))
            if reply.number < 0:
                # A repetition comes before its run and is numbered from the end.
                warm[reply.number + len(order)].append(outcome)
                continue
            refuse_unrepeatable(warm[reply.number], outcome, chunk, deterministic)
        except PlannerFailure as failure:
            # The other runs go on, so that all that fail are named.
            failures[str(failure)] = None
            continue
        times = Times(outcome["id"], reply.cpu, reply.wall)._asdict()
        if moving:
            times |= drives.replan_times(reply.result)._asdict()
        done[k, repeat] = outcome, times, trace
    if failures:
        raise PlannerFailure("\n".join(failures))
    # Rows are in the order of conditions and repeats, whatever the order of runs was.
    runs, times, traces = zip(*(done[key] for key in sorted(done)))
    found = [row for row in runs if row["path_curve"]]
    answers = {repr([row[name] for name in (*ANSWER, "condition")]) for row in found}
    drew, wanted = any(row["drew"] for row in runs), len({row["condition"] for row in found})
    # A few repeats of a planner that draws may be equal by chance; without draws two tell.
    many = len(found) >= wanted * (5 if drew else 2)
    if not deterministic and 0 < wanted == len(answers) and many:
        log.say(f"{describe_chunk(chunk)}: {worker.ALIKE[drew]}")
    # Columns of drives alone are declared for all runs: where no row has them, there are none.
    tables = (
        table_files.build_table(runs, Planned, Outcome, DriveOutcome),
        table_files.build_table(times, Times, DriveTimes),
    )
    return (*tables, pa.Table.from_pylist(traces)) if moving else tables


def _order(chunk: Chunk, conditions: int, repeats: range) -> list[tuple[int, int]]:
    """Return all pairs of a condition's number and a repeat, in a random order seeded by the
    chunk's name.

    A processor's speed drifts, and the first call of compiled code loads it. This order spreads
    both effects over all conditions. It affects only times.
    """
    pairs = list(itertools.product(range(conditions), repeats))
    name = chunk.study, chunk.experiment, chunk.method, repeats.start, "order"
    return [pairs[n] for n in seeds.generator(*name).permutation(len(pairs))]


def refuse_unrepeatable(
    repetitions: Iterable[Row], row: Row, chunk: Chunk, deterministic: bool
) -> None:
    """Raise PlannerFailure, naming the run, unless its repetitions equal its row in every bit."""
    for again in repetitions:
        # The text of a number tells all its bits, and unlike the number a NaN is equal to itself.
        column = next(
            (name for name in row | again if repr(row.get(name)) != repr(again.get(name))), None
        )
        if column:
            reason = (
                "has deterministic = True, but with another generator"
                if deterministic
                else "a plan must follow from problem, rng and settings alone: no other random "
                "numbers, no clock, no id() or hash(), "
                "nothing kept from an earlier run; but with the same generator"
            )
            raise PlannerFailure(
                f"run {row['id']}: planner {chunk.planner}: {reason} its run has another {column}"
            )
