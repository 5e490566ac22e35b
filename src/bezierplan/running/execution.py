"""One chunk of runs: one method on every condition of an experiment, for a block of repeats.

A job is a mapping with these keys, all of them names and plain values (built by `jobs.job`):

    study, experiment, method    names
    planner, settings            the planner and its settings, by name
    problems                     problem name -> its workspace's name and, if present, layout,
                                 obstacles and settings of the problem
    vary                         setting or preset -> list of values; every combination of problems
                                 and values is a condition
    presets                       preset -> value, as text -> settings that go with it
    seeds                        a run's seed comes from its id (`own`), from its id without the
                                 method (`shared`), or from study, experiment, layout and repeat
                                 alone (`common`: all methods and conditions share random numbers)
    time_limit                   seconds, including compilation, after which a run ends its job; no
                                 limit without this key
    repeats                      [first, last): the repeats to run
"""

import itertools
import logging
import time
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any, NamedTuple, TypeVar

import numpy as np
import pyarrow as pa

from bezierplan.geometry.region import Region, region
from bezierplan.planners import Plan, planner_module, planner_settings
from bezierplan.running import answer, rows, watchdog
from bezierplan.running.columns import TAKEN, Outcome, Planned, Times
from bezierplan.running.loans import Loan, lend
from bezierplan.workspaces import seeds
from bezierplan.workspaces.problem import Problem

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


class Condition(NamedTuple):
    """A problem and the values of the varied settings."""

    problem: str
    values: dict[str, Any]

    @property
    def name(self) -> str:
        return ",".join([self.problem, *(f"{key}={value}" for key, value in self.values.items())])


def conditions(problems: list[str], vary: dict[str, list]) -> Iterator[Condition]:
    """Every combination of problems and varied values, in the order given."""
    for problem in problems:
        for values in itertools.product(*vary.values()):
            yield Condition(problem, dict(zip(vary, values, strict=True)))


def run_id(job: dict, condition: Condition, repeat: int) -> str:
    """The name of a run: study/experiment/condition/method/repeat."""
    return f"{job['study']}/{job['experiment']}/{condition.name}/{job['method']}/{repeat}"


def settings_in(job: dict, condition: Condition) -> dict[str, Any]:
    """The settings of the job's method under a condition: those of its problem are applied first,
    then the varied values. Presets expand to their settings; varied values that are not settings of
    the planner are left out.
    """
    settings = job["settings"] | job["problems"][condition.problem].get("settings", {})
    for name, value in condition.values.items():
        settings |= (
            job["presets"][name][str(value).lower()] if name in job["presets"] else {name: value}
        )
    accepted = planner_settings(planner_module(job["planner"]))
    return {name: value for name, value in settings.items() if name in accepted}


def generator(job: dict, condition: Condition, repeat: int) -> np.random.Generator:
    """The random generator of a run, seeded from names only, so that nothing depends on order,
    cores or chunks.
    """
    layout = job["problems"][condition.problem].get("layout", "")
    parts = {
        "own": [condition.name, job["method"]],
        "shared": [condition.name],
        "common": [str(layout)],
    }
    name = "/".join([job["study"], job["experiment"], *parts[job["seeds"]], str(repeat)])
    return seeds.generator(name)


def run(job: dict, condition: Condition, repeat: int, problem: Problem) -> Plan:
    """The plan of one run."""
    plan = planner_module(job["planner"]).plan
    return plan(problem, generator(job, condition, repeat), **settings_in(job, condition))


class UnfitAnswer(watchdog.PlannerFailure):
    """A planner's answer that no row may show; the message names run, planner and field."""


def accepted(plan: Any, problem: Problem, job: dict, condition: Condition, repeat: int) -> Plan:
    """A planner's answer as plain values (`answer.accepted`). Raises UnfitAnswer if it is not valid
    for the problem.
    """
    try:
        return answer.accepted(
            plan, problem, {*TAKEN, *settings_in(job, condition), *condition.values}
        )
    except answer.Unfit as fault:
        raise UnfitAnswer(
            f"run {run_id(job, condition, repeat)}: the answer of planner {job['planner']}: {fault}"
        ) from None


def refuse_changed(loan: Loan, job: dict, condition: Condition, repeat: int) -> None:
    """Raise UnfitAnswer if a planner put something else in a workspace that was lent to it."""
    if fault := loan.fault():
        raise UnfitAnswer(
            f"run {run_id(job, condition, repeat)}: planner {job['planner']}: {fault}"
        )


def identity(job: dict, condition: Condition, repeat: int) -> dict[str, Any]:
    """The first columns of a row: the run's id and its parts, its place, and all settings in
    force.
    """
    return {
        "id": run_id(job, condition, repeat),
        "study": job["study"],
        "experiment": job["experiment"],
        "condition": condition.name,
        "problem": condition.problem,
        **{
            key: value
            for key, value in job["problems"][condition.problem].items()
            if key != "settings"
        },
        "method": job["method"],
        "repeat": repeat,
        "planner": job["planner"],
        **settings_in(job, condition),
        **condition.values,
    }


def row(
    job: dict, condition: Condition, repeat: int, plan: Any, problem: Problem, blocked: Region
) -> dict[str, Any]:
    """One row of the runs table, from a planner's answer. `blocked` is the region of the problem's
    workspace, of which no planner holds any part.

    Length and verdict are those of the points that the row holds. Raises UnfitAnswer if the answer
    is not valid for this problem: for example, if its path begins or ends elsewhere, or a column
    would overwrite another.
    """
    plan = accepted(plan, problem, job, condition, repeat)
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
    return identity(job, condition, repeat) | outcome._asdict() | plan.extra


def run_chunk(
    problems: dict[str, Problem], job: dict, timed_alike: bool = True
) -> tuple[pa.Table, pa.Table]:
    """The runs of a job (columns as in `columns`) and, in a separate table because they are never
    reproducible, their times.

    Planners get copies of the problems, and these stay here to judge by. timed_alike: whether a
    warm-up makes times comparable, whose runs must repeat themselves. Raises PlannerFailure, naming
    the run, if a planner fails, does not return a valid plan for the problem (`row`), changes a
    workspace, or gives another plan when its first run is repeated.
    """
    met = {name: problem for name, problem in problems.items() if name in job["problems"]}
    blocked = {name: region(problem.workspace) for name, problem in met.items()}
    loans = lend(met)
    planned = list(conditions(list(job["problems"]), job["vary"]))
    deterministic = getattr(planner_module(job["planner"]), "deterministic", False)
    first, last = job["repeats"]
    outcomes, times = {}, {}
    with watchdog.watching(job.get("time_limit")) as watch:
        for n, (k, repeat) in enumerate(
            _order(job, len(planned), range(first, first + 1 if deterministic else last))
        ):
            condition = planned[k]
            problem, loan = met[condition.problem], loans[condition.problem]
            once = partial(run, job, condition, repeat, loan.problem)
            made = partial(
                row, job, condition, repeat, problem=problem, blocked=blocked[condition.problem]
            )
            if not outcomes:
                # What needs no random numbers must not be changed by others.
                again = (
                    partial(run, job, condition, repeat + 1, loan.problem)
                    if deterministic
                    else once
                )
                warm = (
                    _warm_up(partial(timed, again, job, condition, repeat, watch))
                    if timed_alike
                    else []
                )
            plan, cpu, wall = timed(once, job, condition, repeat, watch)
            refuse_changed(loan, job, condition, repeat)
            outcomes[k, repeat] = made(plan)
            if n == 0:
                refuse_unrepeatable(map(made, warm), outcomes[k, repeat], job, deterministic)
            times[k, repeat] = Times(outcomes[k, repeat]["id"], cpu, wall)._asdict()
            if (n + 1) % _LOGGED == 0:
                logger.info("%d runs done", n + 1)
    if fault := next(filter(None, (loan.thorough_fault() for loan in loans.values())), ""):
        runs_of = f"{job['study']}/{job['experiment']}/*/{job['method']}"
        raise UnfitAnswer(f"run {runs_of}: planner {job['planner']}: {fault}")
    if deterministic:
        for k, repeat in itertools.product(range(len(planned)), range(first + 1, last)):
            outcomes[k, repeat] = outcomes[k, first] | {
                "id": run_id(job, planned[k], repeat),
                "repeat": repeat,
            }
            times[k, repeat] = times[k, first] | {"id": outcomes[k, repeat]["id"]}
    logger.info("all %d runs done", len(outcomes))
    ordered = sorted(outcomes)
    return rows.table([outcomes[key] for key in ordered], Planned, Outcome), rows.table(
        [times[key] for key in ordered], Times
    )


def _order(job: dict, conditions: int, repeats: range) -> list[tuple[int, int]]:
    """All pairs of a condition's number and a repeat, in a random order seeded by the job's name.

    A processor's speed drifts, and the first call of compiled code loads it. This order spreads
    both effects over all conditions. It affects only times.
    """
    pairs = list(itertools.product(range(conditions), repeats))
    name = "/".join([job["study"], job["experiment"], job["method"], str(repeats.start), "order"])
    shuffled = seeds.generator(name).permutation(len(pairs))
    return [pairs[n] for n in shuffled]


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
    repetitions: Iterable[dict[str, Any]], row: dict[str, Any], job: dict, deterministic: bool
) -> None:
    """Raise PlannerFailure, naming the run, if repetitions of a run do not have the bits of its
    row.
    """
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
                f"run {row['id']}: planner {job['planner']}: {reason} its run has another {column}"
            )


def timed(
    once: Callable[[], T],
    job: dict,
    condition: Condition,
    repeat: int,
    watch: Callable[[str], None],
) -> tuple[T, float, float]:
    """What one run returns, its CPU seconds and its wall-clock seconds. Raises PlannerFailure,
    naming the run, if the planner fails.

    watch: told what is under way, and with an empty text that it is over (`watchdog.watching`).
    """
    with watchdog.executing(
        f"run {run_id(job, condition, repeat)}: planner {job['planner']}", watch
    ):
        cpu, wall = time.process_time(), time.perf_counter()
        found = once()
        return found, time.process_time() - cpu, time.perf_counter() - wall
