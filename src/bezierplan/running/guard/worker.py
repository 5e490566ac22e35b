"""Execute planners: those of this package in the process of a job, all others in separate processes
(`guard.process`), which run this file as a command.
"""

import json
import os
import pickle
import resource
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from bezierplan.machine import opened_files
from bezierplan.planners import Plan, load_planner
from bezierplan.running import answer
from bezierplan.running.chunk import Settings
from bezierplan.running.guard import plain_values
from bezierplan.running.jobs.log import describe_error
from bezierplan.running.jobs.watchdog import (
    LEFT,
    PlannerFailure,
    end_with_parent,
    measure_cpu_time,
)
from bezierplan.running.simulation import robot
from bezierplan.running.simulation.policy import Policy
from bezierplan.schema.safe_text import describe_in_one_line
from bezierplan.workspaces import seeds
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import World

LIMITS = {"RLIMIT_AS": 16 << 30, "RLIMIT_FSIZE": 1 << 30, "RLIMIT_CPU": 30 * 86_400}
"""Most bytes of memory, bytes of a file, and CPU seconds of a separate process."""

ALIKE = {
    False: "all repeats are equal and count as one, for it draws no number from the rng that it is "
    "given; a planner that needs none says deterministic = True",
    True: "all repeats are equal, though it draws numbers from the rng that it is given: has it a "
    "seed of its own?",
}
"""Did the planner draw random numbers -> message about its equal repeats."""

# Warm-up runs are discarded until this many in a row agree in CPU time to within this share, until
# those after the first have taken this many seconds, or until one takes so long that its loading
# time is negligible.
_ALIKE = 3
_STABLE = 0.1
_WARM_UP = 0.2
_LONG_RUN = 1.0
# Never more than this many, whatever the clocks say.
_MOST = 50


class Task(NamedTuple):
    """One run of a planner.

    name: how a message about its planner begins. problem: its name. seed: the parts of the name of
    its generator, or a number. settings: all of the planner.
    """

    name: str
    problem: str
    seed: list[str | int] | int
    settings: Settings

    def generator(self) -> np.random.Generator:
        """Return a new generator with the run's random numbers."""
        return (
            np.random.default_rng(self.seed)
            if isinstance(self.seed, int)
            else seeds.generator(*self.seed)
        )


class Work(NamedTuple):
    """The work of a planner: its function `plan` or `track` on problems, by name; or, with the
    problems' worlds, drives of a robot by its plans under a policy.
    """

    planner: str
    problems: dict[str, Problem]
    function: str = "plan"
    worlds: dict[str, World] | None = None
    policy: Settings | None = None

    def run_task(self, task: Task, rng: np.random.Generator) -> Any:
        """Make a plan, a track or a ride."""
        module, problem = load_planner(self.planner), self.problems[task.problem]
        if self.worlds:
            rules = Policy.model_construct(**self.policy)
            asked = partial(_plan_for_view, module, rng, task.settings, rules.warm)
            return robot.drive(self.worlds[task.problem], problem, rules, asked)
        return getattr(module, self.function)(problem, rng, **task.settings)


def _plan_for_view(
    module: ModuleType,
    rng: np.random.Generator,
    settings: Settings,
    warm: bool,
    view: Problem,
    last: Any,
) -> tuple[Plan, Any]:
    """Plan for a robot's view of its world; return the plan as plain values, and the state that the
    next one gets as `last`.
    """
    if not warm:
        return answer.accept_answer(module.plan(view, rng, **settings), view), None
    pair = module.resume(view, rng, last, **settings)
    if not isinstance(pair, tuple) or len(pair) != 2:
        raise TypeError(
            f"resume returns a {type(pair).__name__}; expected a Plan and what the next call gets "
            "as last"
        )
    return answer.accept_answer(pair[0], view), pair[1]


class Reply(NamedTuple):
    """The result of a planner for a task.

    number: that of its task; a repetition counts from the end, with -1 for the last task. cpu,
    wall: seconds. drew: it drew random numbers from its generator.
    """

    number: int
    result: Any
    cpu: float
    wall: float
    drew: bool


def run_tasks(
    work: Work,
    tasks: Sequence[Task],
    again: Sequence[Task] = (),
    begin: Callable[[str], None] = lambda name: None,
    goes_on: bool = False,
) -> Iterator[Reply]:
    """Run tasks one after the other, and yield a reply for each.

    again: tasks to repeat. The first of them is also the warm-up, whose first and last runs are
    yielded before all others. begin: gets the name of each run. goes_on: a failure becomes the
    run's result, and the next run follows; otherwise PlannerFailure, naming the run, is raised.
    """

    def run_one(number: int, task: Task) -> Reply:
        """Run one task and return the reply."""
        begin(task.name)
        rng = task.generator()
        try:
            with answer.wrap_errors(task.name):
                made = time_call(partial(work.run_task, task, rng))
        except PlannerFailure as failure:
            if not goes_on:
                raise
            return Reply(number, failure, 0.0, 0.0, True)
        return Reply(number, *made, has_drawn(task.generator(), rng))

    if again:
        yield from warm_up(partial(run_one, -len(tasks), again[0]))
    for number, task in enumerate(tasks):
        yield run_one(number, task)


def has_drawn(before: np.random.Generator, after: np.random.Generator) -> bool:
    """Return whether random numbers were drawn from a generator: it has gone on in its own
    sequence, which its increment identifies, or has spawned others.
    """
    old, new = before.bit_generator.state, after.bit_generator.state
    goes_on = old["state"]["inc"] == new["state"]["inc"] and old != new
    return goes_on or after.bit_generator.seed_seq.n_children_spawned > 0


def time_call(once: Callable[[], Any]) -> tuple[Any, float, float]:
    """Call a function; return its result, CPU seconds and wall-clock seconds."""
    cpu, wall = measure_cpu_time(), time.perf_counter()
    found = once()
    return found, measure_cpu_time() - cpu, time.perf_counter() - wall


def warm_up(once: Callable[[], Reply]) -> list[Reply]:
    """Repeat a run until its CPU time is stable, or it is long; return the first and the last
    reply.

    The first runs of a process load code and wake the processor.
    """
    taken: list[float] = []
    made: list[Reply] = []
    while len(taken) < _ALIKE or max(taken[-_ALIKE:]) > (1 + _STABLE) * min(taken[-_ALIKE:]):
        made[1:] = [once()]
        taken.append(made[-1].cpu)
        if taken[-1] > _LONG_RUN or sum(taken[1:]) > _WARM_UP or len(taken) == _MOST:
            break
    return made


# --------------------------------------------------------------------------------------------------
# Work of processes of their own, whose answers are plain values


def yield_plain_answers(
    begin: Callable[[str], None], work: Work, tasks: Sequence[Task], again: Sequence[Task]
) -> Iterator[Reply | PlannerFailure]:
    """Yield the replies of `run_tasks` with plain values; a run that fails yields its failure."""
    for reply in run_tasks(work, tasks, again, begin, goes_on=True):
        task, plan = tasks[reply.number], reply.result
        try:
            if isinstance(plan, PlannerFailure):
                raise plan
            with answer.wrap_errors(task.name):
                if work.function == "plan" and not work.worlds:
                    plan = answer.convert_answer(plan)
            yield reply._replace(result=plain_values.pack(plan))
        except PlannerFailure as failure:
            yield failure


# --------------------------------------------------------------------------------------------------
# The command


def run_job_file(job_file: str, lines_file: str) -> None:
    """Do the work in a file, append lines to another one, and end the process."""
    name, work = pickle.loads(Path(job_file).read_bytes())
    end_with_parent()
    for limit, most in LIMITS.items():
        with suppress(ValueError, OSError, AttributeError):  # not every system has each
            resource.setrlimit(getattr(resource, limit), (most, most))
    opened_files.watch()
    with open(lines_file, "a", encoding="utf-8") as lines:

        def say(kind: str, value: Any) -> None:
            lines.write(f"{json.dumps({kind: value})}\n")
            lines.flush()

        def begin(run: str) -> None:
            nonlocal name
            name = run
            say("begins", run)

        try:
            for each in work(begin):
                _refuse_left(name)
                if isinstance(each, PlannerFailure):
                    say("fails", [str(each), describe_error(each)])
                else:
                    say("answer", each)
        # Code of unknown origin may raise anything, SystemExit and KeyboardInterrupt included.
        except BaseException as error:
            text = (
                str(error)
                if isinstance(error, PlannerFailure)
                else f"{name}: {describe_in_one_line(error)}"
            )
            say("fails", [text, describe_error(error)])
        say("done", sorted(opened_files.SEEN))
        for stream in filter(None, (sys.stdout, sys.stderr)):
            with suppress(OSError, ValueError):
                stream.flush()
        # Not `sys.exit`: a planner may have left work to do at an exit.
        os._exit(0)


def _refuse_left(name: str) -> None:
    """Raise PlannerFailure if child processes still run; on Linux they are ended. Others of the
    same process group end with this process.
    """
    tracking = sys.modules.get("multiprocessing.resource_tracker")
    if tracking:  # Python's own child, which would end with this process
        tracking._resource_tracker._stop()
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    # The usual case; a thousand of these calls take a millisecond.
    except ChildProcessError:
        return
    for file in Path("/proc/self/task").glob("*/children"):
        for child in map(int, file.read_text().split()):
            with suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)
    raise PlannerFailure(f"{name}: {LEFT}")


if __name__ == "__main__":
    run_job_file(*sys.argv[1:])
