"""One path for a robot, through way points: what a planner answers, and how long it takes."""

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from typing import Any, NamedTuple, TypeVar

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.planners import Plan
from bezierplan.running import answer, apart, legs, watchdog
from bezierplan.running.columns import TAKEN
from bezierplan.running.loans import lend
from bezierplan.running.problems import Regions
from bezierplan.workspaces.problem import Problem

T = TypeVar("T")

# The most CPU seconds of a planner that is called a second time.
_LONG = 2.0


class Task(NamedTuple):
    """What to plan with.

    name: how messages about the planner begin. planner: its name in this package, empty for
    another one. plan: its function. settings: all of them. seed: of its random numbers. foreign:
    whether it is executed in a process of its own. timed: whether it is called a second time if it
    is fast, since the first call also loads compiled code.
    """

    name: str
    planner: str
    plan: Callable[..., Any]
    settings: dict[str, Any]
    seed: int
    foreign: bool = False
    timed: bool = False


class Course(NamedTuple):
    """A problem with way points, and its legs with their exact shortest paths."""

    problem: Problem
    via: Sequence[tuple[float, float]]
    parts: list[Problem]
    bounds: list[shortest_paths.Bound]

    @property
    def shortest(self) -> shortest_paths.Bound:
        """The exact shortest path through all legs."""
        return legs.whole(self.bounds)


def course(problem: Problem, via: Sequence[tuple[float, float]], regions: Regions) -> Course:
    """The course of a problem. Raises ValueError for a way point that is not free."""
    parts = legs.legs(problem, via, regions)
    return Course(problem, via, parts, legs.shortest(parts, regions(problem.workspace)))


def planned(task: Task, course: Course) -> tuple[Plan, float]:
    """A planner's answer to a course, as plain values (`answer.accepted`), and its CPU seconds.
    Raises PlannerFailure, beginning with the task's name, for an answer that is none.
    """
    taken = {*TAKEN, *task.settings}
    try:
        given, seconds = _asked(task, course.parts)
        return legs.joined(
            [answer.accepted(plan, part, taken) for plan, part in zip(given, course.parts)]
        ), seconds
    except answer.Unfit as unfit:
        raise watchdog.PlannerFailure(f"{task.name}: its answer: {unfit}") from None


def _asked(task: Task, parts: Sequence[Problem]) -> tuple[list[Any], float]:
    """What a planner answers to each leg, of which it gets a copy, and its CPU seconds."""
    loans = [lend({part.name: part})[part.name] for part in parts]

    def plan(leg: int) -> Any:
        return task.plan(loans[leg].problem, np.random.default_rng(task.seed), **task.settings)

    def fault() -> str:
        return next(filter(None, (loan.thorough_fault() for loan in loans)), "")

    with (
        watchdog.watching(None) as watch,
        apart.asking(task.foreign, task.name, plan, fault) as ask,
        # What a program plans with fails as its own code does.
        watchdog.executing(task.name, watch) if task.foreign else nullcontext(),
    ):
        return _timed(lambda: [ask(task.name, leg) for leg in range(len(parts))], task.timed)


def _timed(once: Callable[[], T], again: bool) -> tuple[T, float]:
    """What a call returns, and its CPU seconds; of a second call, if the first one is fast."""
    for _ in range(1 + again):
        before = apart.clock()
        found = once()
        seconds = float((apart.clock() - before)[0])
        if seconds > _LONG:
            break
    return found, seconds
