"""CPU time, and what is timed: runs of the studies' methods."""

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from bezierplan.places import STUDIES
from bezierplan.planners import Plan, load_planner
from bezierplan.running import execution, problems
from bezierplan.running.jobs.watchdog import measure_cpu_time
from bezierplan.study import jobs, reading
from bezierplan.study.definition import Study
from bezierplan.workspaces.problem import Problem

Work = Callable[[], object]

LEAST, LONG = 0.02, 0.8
"""CPU seconds for which a short work is repeated, so that clocks can tell; and from which a long
one is measured once, after one that warms caches.
"""
ROUNDS = 4
COUNTED = Path(__file__).with_name("counted.py")


def cpu_seconds(work: Work) -> float:
    """CPU seconds of this process and of those that it has started and waited for; of a command
    that `start` runs, of all its descendants.
    """
    before = measure_cpu_time()
    work()
    return measure_cpu_time() - before


def start(*command: str | Path, folder: str | Path = ".") -> None:
    """Run a command of Python in a folder, and wait for all that it has started."""
    words = [sys.executable, COUNTED, sys.executable, *command]
    subprocess.run(words, cwd=folder, capture_output=True, check=True)


def fixed() -> None:
    """A fixed piece of work, such as programs and kernels do: text, lists, arrays."""
    rows = [{"name": str(number), "value": number % 97} for number in range(6000)]
    json.dumps(sorted(json.loads(json.dumps(rows)), key=lambda row: (row["value"], row["name"])))
    values = np.arange(1.0, 60_001.0)
    for _ in range(20):
        np.sqrt(values).cumsum().sort()


def ratio(work: Work) -> float:
    """CPU time of a work as a multiple of that of `fixed`, each the least of some rounds in turn:
    what else a machine does slows both down.
    """
    once = cpu_seconds(work)
    if once < LONG:  # it may have compiled
        once = cpu_seconds(work)
    times, rounds = 1 + int(LEAST / once), ROUNDS if once < LONG else 1

    def again() -> None:
        for _ in range(times):
            work()

    fixed_seconds, seconds = [], []
    for _ in range(rounds):
        fixed_seconds += [cpu_seconds(fixed) for _ in range(3)]
        seconds.append(cpu_seconds(again) / times)
    return min(seconds) / min(fixed_seconds)


def study(key: str) -> Study:
    """A study of this project."""
    return reading.read_study(STUDIES / key)


def studies() -> list[Study]:
    """All studies of this project."""
    return [study(file.parent.name) for file in sorted(STUDIES.glob("*/experiments.yaml"))]


def first_runs() -> Iterator[tuple[str, Problem, Work]]:
    """Of each planner that a study uses, a problem and a run on it: the first condition of the
    first experiment, of those in worlds that stand still if there is one.
    """
    places = [
        (study, experiment, method)
        for study in studies()
        for experiment in study.experiments
        for method in study.methods_of(experiment)
    ]
    places.sort(key=lambda place: place[0].moves(place[1]))
    first = {place[0].planner(place[2]): place for place in reversed(places)}
    for planner, (own, experiment, method) in first.items():
        job = jobs.build_chunk(own, experiment, method, "smoke", 0)
        built, _ = problems.build_all(jobs.build_problems_job(own, experiment, "smoke"), own.folder)
        condition = job.conditions()[0]
        problem, settings = built[condition.problem], execution.resolve_settings(job, condition)
        plan = load_planner(planner).plan
        yield planner, problem, partial(_plan, plan, problem, settings)


def _plan(plan: Callable[..., Plan], problem: Problem, settings: dict[str, Any]) -> Plan:
    """A run with always the same random numbers."""
    return plan(problem, np.random.default_rng(0), **settings)
