"""One chunk of runs: one method on every condition of an experiment, for a block of repeats."""

import itertools
import logging
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, TypeVar

import numpy as np
import pyarrow as pa

from bezierplan.geometry.region import Region, region
from bezierplan.planners import Plan, is_file, planner_module
from bezierplan.running import answer, apart, interface, kernel_cache, rows, watchdog
from bezierplan.running.chunk import Chunk, Condition
from bezierplan.running.columns import TAKEN, Outcome, Planned, Times
from bezierplan.running.loans import Loan, lend
from bezierplan.workspaces import seeds
from bezierplan.workspaces.problem import Path, Problem

logger = logging.getLogger(__name__)

T = TypeVar("T")

# Warm-up runs are discarded until this many in a row agree in CPU time to within this share, until
# those after the first have taken this many seconds, or until one takes so long that its loading
# time is negligible.
_ALIKE = 3
_STABLE = 0.1
_WARM_UP = 0.2
_LONG_RUN = 1.0

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


def generator(chunk: Chunk, condition: Condition, repeat: int) -> np.random.Generator:
    """The random generator of a run, seeded from names only, not from order, cores or chunks."""
    layout = chunk.problems[condition.problem].get("layout", "")
    parts = {
        "own": [condition.name, chunk.method],
        "shared": [condition.name],
        "common": [layout],
    }
    return seeds.generator(chunk.study, chunk.experiment, *parts[chunk.seeds], repeat)


def told_run(chunk: Chunk, condition: Condition, repeat: int) -> str:
    """How a message about a run's planner begins."""
    return f"run {run_id(chunk, condition, repeat)}: planner {chunk.planner}"


def told_chunk(chunk: Chunk) -> str:
    """How a message about all runs of a chunk begins."""
    return f"run {chunk.name}: planner {chunk.planner}"


def run(chunk: Chunk, condition: Condition, repeat: int, problem: Problem) -> Plan:
    """The plan of one run."""
    plan = planner_module(chunk.planner).plan
    return plan(problem, generator(chunk, condition, repeat), **settings_in(chunk, condition))


class UnfitAnswer(watchdog.PlannerFailure):
    """A planner's answer that no row may show; the message names run, planner and field."""


def accepted(plan: Any, problem: Problem, chunk: Chunk, condition: Condition, repeat: int) -> Plan:
    """A planner's answer as plain values. Raises UnfitAnswer if it is not valid for the problem."""
    try:
        return answer.accepted(
            plan, problem, {*TAKEN, *settings_in(chunk, condition), *condition.values}
        )
    except answer.Unfit as fault:
        raise UnfitAnswer(f"{told_run(chunk, condition, repeat)}: its answer: {fault}") from None


def refuse_changed(loan: Loan, chunk: Chunk, condition: Condition, repeat: int) -> None:
    """Raise UnfitAnswer if a planner put something else in a workspace that was lent to it."""
    if fault := loan.fault():
        raise UnfitAnswer(f"{told_run(chunk, condition, repeat)}: {fault}")


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
    workspace, of which no planner holds any part.

    Length and verdict are those of the points that the row holds. Raises UnfitAnswer if the answer
    is not valid for this problem: for example, if its path begins or ends elsewhere, or a column
    would overwrite another.
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


def run_chunk(
    problems: dict[str, Problem], chunk: Chunk, timed_alike: bool = True
) -> tuple[pa.Table, pa.Table]:
    """The runs of a chunk (columns as in `columns`) and, in a separate table because they are never
    reproducible, their times.

    Planners get copies of the problems, a user's planner in another process (`apart`), and these
    stay here to judge by. timed_alike: whether a warm-up makes times comparable, whose runs must
    repeat themselves. Raises PlannerFailure, naming the run, if a planner fails, does not return a
    valid plan for the problem (`row`), changes a workspace, or gives another plan when its first
    run is repeated.
    """
    met = {name: problem for name, problem in problems.items() if name in chunk.problems}
    blocked = {name: region(problem.workspace) for name, problem in met.items()}
    loans = lend(met)
    planned = chunk.conditions()
    deterministic = interface.traits(chunk.planner).deterministic
    first, last = chunk.repeats
    outcomes, times = {}, {}

    def plan(k: int, repeat: int) -> Any:
        loan = loans[planned[k].problem]
        found = run(chunk, planned[k], repeat, loan.problem)
        refuse_changed(loan, chunk, planned[k], repeat)
        return found

    def fault() -> str:
        return next(filter(None, (loan.thorough_fault() for loan in loans.values())), "")

    with (
        apart.asking(is_file(chunk.planner), told_chunk(chunk), plan, fault) as ask,
        watchdog.watching(chunk.time_limit) as watch,
    ):
        kernel_cache.meanwhile[:] = _judgements(met, blocked)

        def asked(k: int, repeat: int) -> tuple[Any, float, float]:
            name = told_run(chunk, planned[k], repeat)
            return timed(partial(ask, name, k, repeat), name, watch)

        for n, (k, repeat) in enumerate(
            _order(chunk, len(planned), range(first, first + 1 if deterministic else last))
        ):
            condition = planned[k]
            made = partial(
                row,
                chunk,
                condition,
                repeat,
                problem=met[condition.problem],
                blocked=blocked[condition.problem],
            )
            if n == 0:
                # What needs no random numbers must not be changed by others.
                again = partial(asked, k, repeat + deterministic)
                warm = _warm_up(again) if timed_alike else []
            found, cpu, wall = asked(k, repeat)
            outcomes[k, repeat] = made(found)
            if n == 0:
                refuse_unrepeatable(map(made, warm), outcomes[k, repeat], chunk, deterministic)
            times[k, repeat] = Times(outcomes[k, repeat]["id"], cpu, wall)._asdict()
            if (n + 1) % _LOGGED == 0:
                logger.info("%d runs done", n + 1)
        kernel_cache.meanwhile.clear()
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


def _judgements(
    problems: dict[str, Problem], blocked: dict[str, Region]
) -> list[Callable[[], object]]:
    """The check of two paths in each type of region: of one that stays at the start, and so is
    free, and of the straight line, which mostly collides. They need all kernels of the check.
    """
    one_of_each = {type(blocked[name]): name for name in problems}
    return [
        partial(
            answer.verdict,
            Path("polyline", np.array([problems[name].start, end], dtype=float)),
            blocked[name],
        )
        for name in one_of_each.values()
        for end in (problems[name].target, problems[name].start)
    ]


def _order(chunk: Chunk, conditions: int, repeats: range) -> list[tuple[int, int]]:
    """All pairs of a condition's number and a repeat, in a random order seeded by the chunk's name.

    A processor's speed drifts, and the first call of compiled code loads it. This order spreads
    both effects over all conditions. It affects only times.
    """
    pairs = list(itertools.product(range(conditions), repeats))
    name = chunk.study, chunk.experiment, chunk.method, repeats.start, "order"
    return [pairs[n] for n in seeds.generator(*name).permutation(len(pairs))]


def _warm_up(once: Callable[[], tuple[T, float, float]]) -> list[T]:
    """What the first and the last of some runs return, which are made until their CPU time is
    stable or they are long: the first ones of a process load code and wake the processor.
    """
    taken, answers = [], []
    while len(taken) < _ALIKE or max(taken[-_ALIKE:]) > (1 + _STABLE) * min(taken[-_ALIKE:]):
        plan, cpu, _ = once()
        taken.append(cpu)
        answers[1:] = [plan]
        if taken[-1] > _LONG_RUN or sum(taken[1:]) > _WARM_UP:
            break
    return answers


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
            raise watchdog.PlannerFailure(
                f"run {row['id']}: planner {chunk.planner}: {reason} its run has another {column}"
            )


def timed(once: Callable[[], T], name: str, watch: Callable[[str], None]) -> tuple[T, float, float]:
    """What one run returns, its CPU seconds and its wall-clock seconds. Raises PlannerFailure,
    beginning with the run's name, if the planner fails.

    watch: told what is under way, and with an empty text that it is over (`watchdog.watching`).
    """
    with watchdog.executing(name, watch):
        before = apart.clock()
        found = once()
        cpu, wall = (apart.clock() - before).tolist()
        return found, cpu, wall
