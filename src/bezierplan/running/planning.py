"""One path for a robot, through way points: what a planner answers, and how long it takes."""

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from functools import partial
from typing import Any, NamedTuple, TypeVar

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.geometry.region import Region
from bezierplan.planners import Plan
from bezierplan.running import answer, apart, legs, watchdog
from bezierplan.running.columns import TAKEN
from bezierplan.running.loans import lend
from bezierplan.running.problems import Placed, Regions
from bezierplan.workspaces.problem import Problem

T = TypeVar("T")

# The most CPU seconds of a planner that is called a second time.
_LONG = 2.0


class Task(NamedTuple):
    """What to plan with.

    name: how messages about the planner begin. planner: its name in this package, empty for
    another one. plan: its function. settings: all of them, headings in the world. smooth: one of
    `legs.SMOOTH`. seed: of its random numbers. foreign: whether it is executed in a process of its
    own. timed: whether it is called a second time if it is fast, since the first call also loads
    compiled code.
    """

    name: str
    planner: str
    plan: Callable[..., Any]
    settings: dict[str, Any]
    smooth: str
    seed: int
    foreign: bool = False
    timed: bool = False


class Course(NamedTuple):
    """A problem with way points in the world, its legs in the map's frame with their exact shortest
    paths, and the region that is blocked for all.
    """

    problem: Placed
    via: Sequence[tuple[float, float]]
    parts: list[Problem]
    bounds: list[shortest_paths.Bound]
    blocked: Region

    @property
    def shortest(self) -> shortest_paths.Bound:
        """The exact shortest path through all legs."""
        return legs.whole(self.bounds)


def course(problem: Placed, via: Sequence[tuple[float, float]], regions: Regions) -> Course:
    """The course of a problem. Raises ValueError for a way point that is not free."""
    parts, blocked = legs.legs(problem, via, regions), regions(problem.near.workspace)
    return Course(problem, via, parts, legs.shortest(parts, blocked), blocked)


def planned(task: Task, course: Course) -> tuple[Plan, float]:
    """A planner's answer to a course, as plain values (`answer.accepted`), and its CPU seconds.
    Raises PlannerFailure, beginning with the task's name, for an answer that is none.
    """
    settings = legs.inward(task.settings, course.problem.frame)
    taken = {*TAKEN, *settings}
    try:
        if task.planner in legs.TURNING:
            plan, seconds = _timed(
                partial(
                    legs.solved,
                    task.planner,
                    course.parts,
                    course.bounds,
                    course.blocked,
                    settings,
                    task.smooth,
                ),
                task.timed,
            )
            whole = course.parts[0]._replace(target=course.parts[-1].target)
            return answer.accepted(plan, whole, taken), seconds
        given, seconds = _asked(task, course.parts, settings)
        return legs.joined(
            [answer.accepted(plan, part, taken) for plan, part in zip(given, course.parts)]
        ), seconds
    except answer.Unfit as unfit:
        raise watchdog.PlannerFailure(f"{task.name}: its answer: {unfit}") from None


def _asked(
    task: Task, parts: Sequence[Problem], settings: dict[str, Any]
) -> tuple[list[Any], float]:
    """What a planner answers to each leg, of which it gets a copy, and its CPU seconds."""
    loans = [lend({part.name: part})[part.name] for part in parts]

    def plan(leg: int) -> Any:
        return task.plan(loans[leg].problem, np.random.default_rng(task.seed), **settings)

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
