"""CPU time, and what is timed: runs of the studies' methods."""

import io
import json
import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bezierplan.places import STUDIES
from bezierplan.planners import Plan, load_planner
from bezierplan.running import execution, problems
from bezierplan.running.jobs.watchdog import measure_cpu_time
from bezierplan.study import jobs, loading
from bezierplan.study.definition import Study
from bezierplan.workspaces.problem import Problem

Work = Callable[[], object]

Measure = Callable[[], float]
"""What measures a cost once."""

LEAST, LONG = 0.02, 0.8
"""CPU seconds for which a short work is repeated, so that clocks can tell; and from which a long
one is measured once, after one that warms caches.
"""
ROUNDS = 4
COUNTED = Path(__file__).with_name("counted.py")

COSTLY = {
    "elhoseny2017": "fields100",
    "ma2020": "environments",
    "meledje": "operators",
    "song2016": "routes",
    "tharwat2018": "maps",
}
"""By study, the experiment whose runs take longest."""


def cpu_seconds(work: Work) -> float:
    """CPU seconds of this process and of those that it has started and waited for; of a command
    that `start` runs, of all its descendants.
    """
    before = measure_cpu_time()
    work()
    return measure_cpu_time() - before


def start(*command: str | Path, folder: str | Path = ".", **variables: str | Path) -> int:
    """Run a command of Python in a folder, with variables of the environment, and wait for all that
    it has started; the most memory that one of its processes had, in bytes.
    """
    process = subprocess.Popen(
        [sys.executable, COUNTED, sys.executable, *command],
        cwd=folder,
        env=os.environ | {name: str(value) for name, value in variables.items()},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, process.args)
    return used.ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def fixed() -> None:
    """A fixed piece of work, such as programs, kernels and tables do: text, lists, arrays, frames
    of strings.
    """
    rows = [{"name": str(number), "value": number % 97} for number in range(3000)]
    json.dumps(sorted(json.loads(json.dumps(rows)), key=lambda row: (row["value"], row["name"])))
    values = np.arange(1.0, 60_001.0)
    for _ in range(10):
        np.sqrt(values).cumsum().sort()
    table = pd.DataFrame(rows)
    for value in range(5):
        table[table["name"].str.endswith(str(value))].groupby("value")["name"].count()
    io.StringIO(table.to_csv()).read()


def ratio(work: Work, cold: bool = False) -> float:
    """CPU time of a work as a multiple of that of `fixed`, each the least of some rounds in turn:
    what else a machine does slows both down. cold: a work that no other may warm is measured once.
    """
    once = cold or cpu_seconds(work)
    if not cold and once < LONG:  # it may have compiled
        once = cpu_seconds(work)
    times, rounds = 1 + int(LEAST / once), ROUNDS if once < LONG else 1

    def again() -> None:
        for _ in range(times):
            work()

    fixed_seconds, seconds = [], []
    for _ in range(rounds):
        fixed_seconds += [cpu_seconds(fixed) for _ in range(3)]
        seconds.append(cpu_seconds(again) / times)
    fixed_seconds += [cpu_seconds(fixed) for _ in range(3)]
    return min(seconds) / min(fixed_seconds)


def study(key: str) -> Study:
    """A study of this project."""
    return loading.load([STUDIES / key])[key]


def studies() -> list[Study]:
    """All studies of this project."""
    return [study(file.parent.name) for file in sorted(STUDIES.glob("*/experiments.yaml"))]


def first_places() -> list[tuple[Study, str, str]]:
    """Study, experiment and method: each method of the costliest experiment of a study; and of each
    planner that has no place there its first one, in a world that stands still if there is one.
    """
    places = [
        (study, experiment, method)
        for study in studies()
        for experiment in study.experiments
        for method in study.methods_of(experiment)
    ]
    places.sort(key=lambda place: place[0].moves(place[1]))
    costly = [
        place
        for place in places
        if place[1] == COSTLY.get(place[0].key) and place[2] not in place[0].baselines
    ]
    first = {place[0].planner(place[2]): place for place in reversed(places)}
    known = {own.planner(method) for own, _, method in costly}
    return costly + [place for planner, place in first.items() if planner not in known]


def first_run(own: Study, experiment: str, method: str) -> tuple[Problem, Work]:
    """The problem of a method's first condition in an experiment, and a run on it."""
    job = jobs.build_chunk(own, experiment, method, "smoke", 0)
    built, _ = problems.build_all(jobs.build_problems_job(own, experiment, "smoke"), own.folder)
    condition = job.conditions()[0]
    problem, settings = built[condition.problem], execution.resolve_settings(job, condition)
    plan = load_planner(own.planner(method)).plan
    return problem, partial(_plan, plan, problem, settings)


def first_drive(own: Study, experiment: str, method: str) -> Work:
    """A drive, from plan to rows and traces."""
    job = jobs.build_chunk(own, experiment, method, "smoke", 0)
    built, moving = problems.build_all(
        jobs.build_problems_job(own, experiment, "smoke"), own.folder
    )
    first = next(iter(job.problems))
    job = job._replace(problems={first: job.problems[first]}, repeats=[0, 1])
    return partial(execution.run_chunk, built, job, moving)


def _plan(plan: Callable[..., Plan], problem: Problem, settings: dict[str, Any]) -> Plan:
    """A run with always the same random numbers."""
    return plan(problem, np.random.default_rng(0), **settings)


if __name__ == "__main__":
    first_run(study(sys.argv[1]), *sys.argv[2:])[1]()
