"""What executes planners: those of this package in the process of a job, all others in a process of
their own, which is this file as a command (`guard`).
"""

import importlib
import json
import os
import resource
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from bezierplan.planners import planner_module
from bezierplan.running.jobs.log import account
from bezierplan.running.jobs.watchdog import (
    LEFT,
    PlannerFailure,
    cpu_time,
    end_with_parent,
    executing,
)
from bezierplan.running.judge import answer
from bezierplan.schema.words import told
from bezierplan.workspaces import files, seeds
from bezierplan.workspaces.problem import Problem

T = TypeVar("T")

LIMITS = {"RLIMIT_AS": 16 << 30, "RLIMIT_FSIZE": 1 << 30, "RLIMIT_CPU": 30 * 86_400}
"""Bytes of memory, bytes of a file, and CPU seconds that a process may have."""

# Warm-up runs are discarded until this many in a row agree in CPU time to within this share, until
# those after the first have taken this many seconds, or until one takes so long that its loading
# time is negligible.
_ALIKE = 3
_STABLE = 0.1
_WARM_UP = 0.2
_LONG_RUN = 1.0
# And until there are so many, whatever clocks say.
_MOST = 50


class Task(NamedTuple):
    """One run. name: how a message about its planner begins. problem: by name. seed: the parts of
    the name of its generator, or a number. settings: all of the planner.
    """

    name: str
    problem: str
    seed: list[str | int] | int
    settings: dict[str, Any]

    def generator(self) -> np.random.Generator:
        """Its random numbers."""
        return (
            np.random.default_rng(self.seed)
            if isinstance(self.seed, int)
            else seeds.generator(*self.seed)
        )


class Made(NamedTuple):
    """A planner's answer. number: of its task, -1 of a warm-up. cpu, wall: seconds."""

    number: int
    plan: Any
    cpu: float
    wall: float


def plans(
    planner: str,
    problems: dict[str, Problem],
    tasks: Iterable[Task],
    again: Task | None = None,
    begin: Callable[[str], None] = lambda name: None,
) -> Iterator[Made]:
    """Answers of a planner, one after the other. again: the task of warm-up runs before them, of
    which the first and the last are yielded. begin: told the name of each run. Raises
    PlannerFailure, naming the run.
    """

    def made(number: int, task: Task) -> Made:
        begin(task.name)
        with executing(task.name):
            plan, rng, problem = planner_module(planner).plan, task.generator(), task.problem
            return Made(number, *timed(lambda: plan(problems[problem], rng, **task.settings)))

    if again:
        yield from warm_up(lambda: made(-1, again))
    for number, task in enumerate(tasks):
        yield made(number, task)


def timed(once: Callable[[], T]) -> tuple[T, float, float]:
    """What a call returns, its CPU seconds and its wall-clock seconds."""
    cpu, wall = cpu_time(), time.perf_counter()
    found = once()
    return found, cpu_time() - cpu, time.perf_counter() - wall


def warm_up(once: Callable[[], Made]) -> list[Made]:
    """The first and the last of some runs, which are made until their CPU time is stable or they
    are long: the first ones of a process load code and wake the processor.
    """
    taken: list[float] = []
    made: list[Made] = []
    while len(taken) < _ALIKE or max(taken[-_ALIKE:]) > (1 + _STABLE) * min(taken[-_ALIKE:]):
        made[1:] = [once()]
        taken.append(made[-1].cpu)
        if taken[-1] > _LONG_RUN or sum(taken[1:]) > _WARM_UP or len(taken) == _MOST:
            break
    return made


# --------------------------------------------------------------------------------------------------
# Work of processes of their own, whose answers are plain values


def packed_problems(problems: dict[str, Problem]) -> dict[str, list[Any]]:
    """Problems by name as plain values: name, workspace as text, start and target."""
    return {
        name: [each.name, files.to_json(each.workspace), each.start, each.target]
        for name, each in problems.items()
    }


def unpacked_problems(packed: dict[str, list[Any]]) -> dict[str, Problem]:
    """The reverse; problems in one workspace share its object."""
    workspaces = {text: files.from_json(text) for text in {each[1] for each in packed.values()}}
    return {
        key: Problem(name, workspaces[text], tuple(start), tuple(target))
        for key, (name, text, start, target) in packed.items()
    }


def plain_plans(
    begin: Callable[[str], None],
    planner: str,
    problems: dict[str, list[Any]],
    tasks: list[list[Any]],
    again: list[Any] | None,
) -> Iterator[list[Any]]:
    """`plans` as plain values."""
    met, name = unpacked_problems(problems), ""
    of_tasks = [Task(*each) for each in tasks]
    for number, plan, cpu, wall in plans(planner, met, of_tasks, again and Task(*again), begin):
        name = of_tasks[max(number, 0)].name
        try:
            yield [number, answer.packed(answer.plain(plan)), cpu, wall]
        except answer.Unfit as unfit:
            raise PlannerFailure(f"{name}: its answer: {unfit}") from None
    refuse_changed(problems, packed_problems(met), name)


def refuse_changed(before: dict[str, Any], after: dict[str, Any], name: str) -> None:
    """Raise PlannerFailure, beginning with a name, for a problem that a planner has changed."""
    # Plain values make no difference between lists and tuples.
    for problem in before:
        if json.dumps(before[problem]) != json.dumps(after[problem]):
            raise PlannerFailure(
                f"{name}: problem: {problem}: is another after the run; a planner copies what it "
                "changes"
            )


def tracked(
    begin: Callable[[str], None],
    planner: str,
    problem: dict[str, list[Any]],
    task: list[Any],
) -> Iterator[list[Any]]:
    """The control points after each iteration of a run (`track` of planners)."""
    run = Task(*task)
    begin(run.name)
    (met,) = unpacked_problems(problem).values()
    track = planner_module(planner).track(met, run.generator(), **run.settings)
    for points in track:
        yield np.asarray(points, dtype=float).tolist()


# --------------------------------------------------------------------------------------------------
# The command


def main(job_file: str, lines_file: str) -> None:
    """Do what a file says, and append lines to another one; then end, whatever a planner has left
    to do at an exit.
    """
    job = json.loads(Path(job_file).read_text(encoding="utf-8"))
    end_with_parent()
    for name, most in LIMITS.items():
        with suppress(ValueError, OSError, AttributeError):  # not every system has each
            resource.setrlimit(getattr(resource, name), (most, most))
    with open(lines_file, "a", encoding="utf-8") as lines:

        def say(kind: str, value: Any) -> None:
            lines.write(f"{json.dumps({kind: value})}\n")
            lines.flush()

        name = job["name"]

        def begin(run: str) -> None:
            nonlocal name
            name = run
            say("begins", run)

        try:
            module, _, function = job["work"].rpartition(".")
            work = getattr(importlib.import_module(f"bezierplan.running.{module}"), function)
            for each in work(begin, **job["given"]):
                _refuse_left(name)
                say("answer", each)
            say("took", cpu_time())
        # Code of unknown origin may raise anything, SystemExit and KeyboardInterrupt included.
        except BaseException as error:
            text = str(error) if isinstance(error, PlannerFailure) else f"{name}: {told(error)}"
            say("fails", [text, account(error)])
        for stream in filter(None, (sys.stdout, sys.stderr)):
            with suppress(OSError, ValueError):
                stream.flush()
        os._exit(0)


def _refuse_left(name: str) -> None:
    """Raise PlannerFailure for children that still run, which are ended on Linux; those of the same
    process group end with this process.
    """
    tracking = sys.modules.get("multiprocessing.resource_tracker")
    if tracking:  # Python's own child, which would end with this process
        tracking._resource_tracker._stop()
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        return
    for file in Path("/proc/self/task").glob("*/children"):
        for child in map(int, file.read_text().split()):
            with suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)
    raise PlannerFailure(f"{name}: {LEFT}")


if __name__ == "__main__":
    main(*sys.argv[1:])
