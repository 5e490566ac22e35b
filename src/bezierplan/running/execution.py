"""One chunk of runs: one method on every condition of an experiment, for a block of repeats."""

import itertools
import logging
from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path as File
from typing import Any

import numpy as np
import pyarrow as pa

from bezierplan.geometry.region import Region, region
from bezierplan.planners import Plan, is_file, planner_module
from bezierplan.running import rows
from bezierplan.running.chunk import Chunk, Condition
from bezierplan.running.columns import TAKEN, Outcome, Planned, Times
from bezierplan.running.guard import interface, process, worker
from bezierplan.running.jobs.watchdog import PlannerFailure, begin, executing
from bezierplan.running.judge import answer
from bezierplan.workspaces import seeds
from bezierplan.workspaces.problem import Problem

logger = logging.getLogger(__name__)

# Number of runs between two lines of the log.
_LOGGED = 100


def run_id(chunk: Chunk, condition: Condition, repeat: int) -> str:
    """The name of a run: study/experiment/condition/method/repeat."""
    return f"{chunk.study}/{chunk.experiment}/{condition.name}/{chunk.method}/{repeat}"


def settings_in(chunk: Chunk, condition: Condition) -> dict[str, Any]:
    """The settings of a chunk's method under a condition: those of its problem are applied first,
    then the varied values. Presets expand to their settings; varied values that are not settings of
    the planner are left out.
    """
    settings = chunk.settings | chunk.problems[condition.problem].get("settings", {})
    for name, value in condition.values.items():
        settings |= (
            chunk.presets[name][str(value).lower()] if name in chunk.presets else {name: value}
        )
    accepted = interface.traits(chunk.planner).settings
    return {name: value for name, value in settings.items() if name in accepted}


def task(chunk: Chunk, condition: Condition, repeat: int) -> worker.Task:
    """A run as what executes planners needs it. Its generator is seeded from names only, not from
    order, cores or chunks.
    """
    layout = chunk.problems[condition.problem].get("layout", "")
    parts = {
        "own": [condition.name, chunk.method],
        "shared": [condition.name],
        "common": [layout],
    }
    return worker.Task(
        f"run {run_id(chunk, condition, repeat)}: planner {chunk.planner}",
        condition.problem,
        [chunk.study, chunk.experiment, *parts[chunk.seeds], repeat],
        settings_in(chunk, condition),
    )


def generator(chunk: Chunk, condition: Condition, repeat: int) -> np.random.Generator:
    """The random generator of a run."""
    return task(chunk, condition, repeat).generator()


def told_chunk(chunk: Chunk) -> str:
    """How a message about all runs of a chunk begins."""
    return f"run {chunk.name}: planner {chunk.planner}"


def plans(
    chunk: Chunk,
    problems: dict[str, Problem],
    tasks: Iterable[worker.Task],
    again: worker.Task | None = None,
) -> Iterator[worker.Made]:
    """`worker.plans` of a chunk's planner. Raises PlannerFailure, naming the run."""
    if not is_file(chunk.planner):
        begins = partial(begin, chunk.time_limit)
        return worker.plans(chunk.planner, problems, tasks, again, begins)
    return process.plans(chunk.planner, problems, tasks, again, told_chunk(chunk), chunk.time_limit)


def run(chunk: Chunk, condition: Condition, repeat: int, problem: Problem) -> Plan:
    """The plan of one run."""
    (made,) = plans(chunk, {condition.problem: problem}, [task(chunk, condition, repeat)])
    return made.plan


def track(chunk: Chunk, condition: Condition, repeat: int, problem: Problem) -> list[np.ndarray]:
    """The control points (n, 2) of the best path after each iteration of a run."""
    run_task = task(chunk, condition, repeat)
    if not is_file(chunk.planner):
        with executing(run_task.name):
            made = planner_module(chunk.planner).track(
                problem, run_task.generator(), **run_task.settings
            )
            return list(made)
    arguments = {
        "planner": str(File(chunk.planner).resolve()),
        "problem": worker.packed_problems({condition.problem: problem}),
        "task": run_task,
    }
    return list(
        map(
            np.array,
            process.answers("guard.worker.tracked", arguments, run_task.name, chunk.time_limit),
        )
    )


def accepted(plan: Any, problem: Problem, chunk: Chunk, condition: Condition, repeat: int) -> Plan:
    """A planner's answer as plain values. Raises PlannerFailure if it is not valid for the
    problem.
    """
    run = task(chunk, condition, repeat)
    try:
        return answer.accepted(plan, problem, taken(run, condition))
    except answer.Unfit as fault:
        raise PlannerFailure(f"{run.name}: its answer: {fault}") from None


def taken(run: worker.Task, condition: Condition) -> list[str]:
    """Names that no extra column of a run may have."""
    return [*TAKEN, *run.settings, *condition.values]


def refuse_other_path(run: Mapping[str, Any], points: np.ndarray) -> None:
    """Raise ValueError unless a run that was made again has the points (n, 2) of its row's path."""
    if not np.array_equal(points.ravel(), run["path_points"]):
        raise ValueError(
            f"run {run['id']}: its rerun ends in another path; the runs table comes from another "
            "version of the code"
        )


def identity(chunk: Chunk, condition: Condition, repeat: int) -> dict[str, Any]:
    """The first columns of a row: the run's id and its parts, its place, all settings in force."""
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
        **settings_in(chunk, condition),
        **condition.values,
    }


def row(
    chunk: Chunk, condition: Condition, repeat: int, plan: Any, problem: Problem, blocked: Region
) -> dict[str, Any]:
    """One row of the runs table, from a planner's answer. `blocked` is the region of the problem's
    workspace.

    Length and verdict are those of the points that the row holds. Raises PlannerFailure if the
    answer is not valid for this problem: for example, if its path begins or ends elsewhere, or a
    column would overwrite another.
    """
    plan = accepted(plan, problem, chunk, condition, repeat)
    curve, points = answer.stored(plan.path)
    length, check = answer.verdict(answer.restored(curve, points), blocked)
    outcome = Outcome(
        objective=plan.objective,
        length=length,
        claimed_feasible=plan.claimed_feasible,
        feasible=check.feasible,
        collision_at=check.collision_at,
        collision_depth=check.depth,
        clearance=check.clearance,
        clearance_error=check.tolerance,
        evaluations=plan.evaluations,
        generations=len(plan.history) - 1,
        stop=plan.stop,
        history=plan.history.tolist(),
        path_curve=curve,
        path_points=points,
    )
    return identity(chunk, condition, repeat) | outcome._asdict() | plan.extra


def run_chunk(problems: dict[str, Problem], chunk: Chunk) -> tuple[pa.Table, pa.Table]:
    """The runs of a chunk (columns as in `columns`) and, in a separate table because they are never
    reproducible, their times.

    A warm-up makes times comparable, and its runs must repeat themselves. Raises PlannerFailure,
    naming the run, if a planner fails, does not return a valid plan for the problem (`row`),
    changes a problem, or gives another plan when its first run is repeated.
    """
    met = {name: problem for name, problem in problems.items() if name in chunk.problems}
    blocked = {name: region(problem.workspace) for name, problem in met.items()}
    planned = chunk.conditions()
    deterministic = interface.traits(chunk.planner).deterministic
    first, last = chunk.repeats
    order = _order(chunk, len(planned), range(first, first + 1 if deterministic else last))
    # What needs no random numbers must not be changed by others.
    warm_up = task(chunk, planned[order[0][0]], order[0][1] + deterministic)
    warm, outcomes, times = [], {}, {}
    for number, plan, cpu, wall in plans(
        chunk,
        met,
        [task(chunk, planned[k], repeat) for k, repeat in order],
        warm_up,
    ):
        k, repeat = order[max(number, 0)]
        problem = planned[k].problem
        made = row(chunk, planned[k], repeat, plan, met[problem], blocked[problem])
        if number < 0:
            warm.append(made)
            continue
        if number == 0:
            refuse_unrepeatable(warm, made, chunk, deterministic)
        outcomes[k, repeat], times[k, repeat] = made, Times(made["id"], cpu, wall)._asdict()
        if (number + 1) % _LOGGED == 0:
            logger.info("%d runs done", number + 1)
    begin(None, told_chunk(chunk))
    if deterministic:
        for k, repeat in itertools.product(range(len(planned)), range(first + 1, last)):
            outcomes[k, repeat] = outcomes[k, first] | {
                "id": run_id(chunk, planned[k], repeat),
                "repeat": repeat,
            }
            times[k, repeat] = times[k, first] | {"id": outcomes[k, repeat]["id"]}
    logger.info("all %d runs done", len(outcomes))
    ordered = sorted(outcomes)
    return rows.table([outcomes[key] for key in ordered], Planned, Outcome), rows.table(
        [times[key] for key in ordered], Times
    )


def _order(chunk: Chunk, conditions: int, repeats: range) -> list[tuple[int, int]]:
    """All pairs of a condition's number and a repeat, in a random order seeded by the chunk's name.

    A processor's speed drifts, and the first call of compiled code loads it. This order spreads
    both effects over all conditions. It affects only times.
    """
    pairs = list(itertools.product(range(conditions), repeats))
    name = chunk.study, chunk.experiment, chunk.method, repeats.start, "order"
    return [pairs[n] for n in seeds.generator(*name).permutation(len(pairs))]


def refuse_unrepeatable(
    repetitions: Iterable[dict[str, Any]], row: dict[str, Any], chunk: Chunk, deterministic: bool
) -> None:
    """Raise PlannerFailure, naming the run, if its repetitions do not have the bits of its row."""
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
