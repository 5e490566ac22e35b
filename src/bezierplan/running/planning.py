"""Plan one path through way points: a problem for each leg, an answer to each, and the
joined path.
"""

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.planners import Plan
from bezierplan.running import answer, problems
from bezierplan.running.chunk import Settings
from bezierplan.running.columns import TAKEN
from bezierplan.running.guard import process, worker
from bezierplan.workspaces.limits import Place
from bezierplan.workspaces.problem import Path, Problem

ROUNDED = "rounded_shortest_path"
"""The planner that is used if no method is named; it rounds corners to a turning radius."""

CHAINED = (ROUNDED, "shortest_path")
"""Planners whose paths can be joined, because they are chains of pieces."""

EXCESS = 0.01
"""Without a turning radius, turns are as wide as a path allows that is longer than the shortest by
this share at most.
"""

# Directions of travel that differ by less, in radians, are one: points carry rounding errors. A
# radius that is smaller than asked by less than `_SAME`, as a share, is the one asked for.
_STRAIGHT = 1e-8
_SAME = 1e-9


def choose_rounding(names: Collection[str]) -> dict[str, float]:
    """Return settings of the planner that rounds corners, beside those that are given by `names`.
    To keep a given radius, the path may be as long as it needs.
    """
    if "turning_radius" in names:
        return {"excess": math.inf}
    return {"turning_radius": math.inf, "excess": EXCESS}


def split_into_legs(problem: Problem, via: Sequence[Place]) -> list[Problem]:
    """Return the problems from the start to the first way point, and so on to the target.

    via: way points (x, y). Raises ValueError for one that is not free, or equals its neighbour.
    """
    places = [problems.read_place("via", {"via": point}, problem.workspace) for point in via]
    pairs = list(pairwise([problem.start, *places, problem.target]))
    # Without way points a start may be the target: the path then has no length.
    for start, target in pairs if via else ():
        if start == target:
            raise ValueError(f"via: {target}: the same place as the one before; expected another")
    return [problem._replace(start=start, target=target) for start, target in pairs]


def find_shortest(parts: Sequence[Problem]) -> shortest_paths.Bound:
    """Return the exact shortest path through all legs."""
    bounds = [shortest_paths.shortest_path(part) for part in parts]
    return shortest_paths.Bound(
        sum(bound.length for bound in bounds), np.concatenate([bound.points for bound in bounds])
    )


class Run(NamedTuple):
    """The calls of a planner for the legs of a problem, one for each.

    label: how messages about it begin. bound: the exact shortest path through all legs.
    """

    label: str
    problem: Problem
    legs: Sequence[Problem]
    bound: shortest_paths.Bound
    settings: Settings
    seed: int


def yield_plans(
    plan: Callable[..., Any], runs: Sequence[Run], file: str
) -> Iterator[tuple[Run, Plan, float]]:
    """Yield each run with the planner's answer, as plain values, and its CPU seconds.

    plan: the planner's function. file: the path of the planner's file, which then runs in a process
    of its own; empty for a planner of this package. Raises PlannerFailure for an answer that is not
    valid.
    """
    problems, tasks = {}, []
    for run in runs:
        for leg in run.legs:
            task = worker.Task(run.label, f"{len(tasks)}", run.seed, run.settings)
            problems[task.problem] = leg
            tasks.append(task)
    if file:
        replies = process.run_isolated(worker.Work(file, problems), tasks, (), runs[0].label)
    else:
        calls = (
            partial(plan, problems[task.problem], task.generator(), **task.settings)
            for task in tasks
        )
        replies = (worker.Reply(0, *worker.time_call(call), True) for call in calls)
    for run in runs:
        # Names that a runs table refuses are refused here too: what plans here runs in a study.
        made, taken = [next(replies) for _ in run.legs], {*TAKEN, *run.settings}
        with answer.wrap_errors(run.label):
            legs = [
                answer.accept_answer(each.result, leg, taken) for each, leg in zip(made, run.legs)
            ]
        yield run, join_answers(legs), sum(each.cpu for each in made)


def join_answers(answers: Sequence[Plan]) -> Plan:
    """Join the answers to all legs into one. A corner at a way point counts as a turn.

    If a leg has no path, its answer is returned.
    """
    lost = next((answer for answer in answers if answer.path is None), None)
    # A path of which one leg is missing is no path.
    if lost or len(answers) == 1:
        return lost or answers[0]
    paths = [answer.path for answer in answers]
    corners = sum(_has_corner(arriving, leaving) for arriving, leaving in pairwise(paths))
    extra = {name: sum(answer.extra[name] for answer in answers) for name in answers[0].extra}
    if "least_radius" in extra:
        extra |= {name: extra[name] + corners for name in ("turns", "corners")}
        extra["least_radius"] = min(answer.extra["least_radius"] for answer in answers)
    points = [paths[0].points, *(path.points[1:] for path in paths[1:])]
    objective = sum(answer.objective for answer in answers)
    return answers[0]._replace(
        path=Path(paths[0].curve, np.concatenate(points)),
        objective=objective,
        claimed_feasible=all(answer.claimed_feasible for answer in answers),
        evaluations=sum(answer.evaluations for answer in answers),
        history=np.array([objective]),
        extra=extra,
    )


def _has_corner(arriving: Path, leaving: Path) -> bool:
    """Return whether the direction of travel changes between two chains."""
    last, first = np.diff(arriving.points[-2:], axis=0)[0], np.diff(leaving.points[:2], axis=0)[0]
    cross = last[0] * first[1] - last[1] * first[0]
    return abs(math.atan2(cross, float(last @ first))) > _STRAIGHT


def is_radius_kept(wish: float, radius: float) -> bool:
    """Return whether a path's tightest turn (nan without a path) keeps a turning radius."""
    return radius >= wish * (1 - _SAME)
