"""One chunk of runs: a method on every condition of an experiment, a block of repeats.

A job is a mapping with these keys, all of them names and plain values (`study.job` makes it):

    study, experiment, method    names
    planner, settings            the planner and its settings, by name
    problems                     problem name -> its workspace's name, and if it has them layout, obstacles, and settings that go with it
    vary                         setting or level -> list of values; every combination of problems and values is a condition
    levels                       level -> value, as text -> settings that go with it
    seeds                        a run's seed comes from its id (`own`), from its id without the method (`shared`), or from study,
                                 experiment, layout and repeat alone (`common`: all methods and conditions share their random numbers)
    repeats                      [first, last): the repeats to run
"""

import hashlib
import itertools
import logging
import math
import time
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from bezierplan import curves
from bezierplan.exact import checker
from bezierplan.exact.region import region
from bezierplan.problem import Plan, Problem, planner_module, planner_settings

logger = logging.getLogger(__name__)

RUN_COLUMNS = (
    *("id", "study", "experiment", "condition", "problem", "workspace", "method", "repeat", "planner"),
    *("objective", "length", "claimed_feasible", "feasible", "collision_at", "collision_depth", "clearance", "clearance_error"),
    *("evaluations", "generations", "stop", "history", "path_curve", "path_points"),
)
"""Columns of every runs table; the settings and a planner's extra columns stand between `planner` and `objective`, and at the end.

objective: the planner's own final value. length: exact arc length of the path, in units (not a number without a path).
claimed_feasible: the planner's own test. feasible, collision_at, collision_depth, clearance, clearance_error: the certified check
(`exact.checker.Check`). generations: done after the first one. history: best objective after each generation.
path_curve, path_points: the path, its control points flat as x0, y0, x1, y1, ...; empty without a path.
"""


NO_PATH = checker.Check(False, math.nan, math.nan, math.nan, math.nan, 0)


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
    """The settings of the job's method under a condition: what goes with its problem is put in, then what is varied. Levels stand for the
    settings that go with them; what is varied and is no setting of the planner is left out.
    """
    settings = job["settings"] | job["problems"][condition.problem].get("settings", {})
    for name, value in condition.values.items():
        settings |= job["levels"][name][str(value).lower()] if name in job["levels"] else {name: value}
    accepted = planner_settings(planner_module(job["planner"]))
    return {name: value for name, value in settings.items() if name in accepted}


def generator(job: dict, condition: Condition, repeat: int) -> np.random.Generator:
    """The random generator of a run, from names only, so that nothing depends on order, cores or chunks."""
    layout = job["problems"][condition.problem].get("layout", "")
    parts = {
        "own": [condition.name, job["method"]],
        "shared": [condition.name],
        "common": [str(layout)],
    }
    name = "/".join([job["study"], job["experiment"], *parts[job["seeds"]], str(repeat)])
    return np.random.default_rng(int.from_bytes(hashlib.sha256(name.encode()).digest()))


def run(job: dict, condition: Condition, repeat: int, problem: Problem) -> Plan:
    """The plan of one run."""
    plan = planner_module(job["planner"]).plan
    return plan(problem, generator(job, condition, repeat), **settings_in(job, condition))


def row(job: dict, condition: Condition, repeat: int, plan: Plan, blocked: Any) -> dict[str, Any]:
    """One row of the runs table; `blocked` is the region of the problem's workspace."""
    path = plan.path
    check = NO_PATH if path is None else checker.check(curves.bezier_pieces(path), blocked)
    return {
        "id": run_id(job, condition, repeat),
        "study": job["study"],
        "experiment": job["experiment"],
        "condition": condition.name,
        "problem": condition.problem,
        **{key: value for key, value in job["problems"][condition.problem].items() if key != "settings"},
        "method": job["method"],
        "repeat": repeat,
        "planner": job["planner"],
        **settings_in(job, condition),
        **condition.values,
        "objective": float(plan.objective),
        "length": math.nan if path is None else curves.length(path),
        "claimed_feasible": bool(plan.claimed_feasible),
        "feasible": check.feasible,
        "collision_at": check.collision_at,
        "collision_depth": check.depth,
        "clearance": check.clearance,
        "clearance_error": check.tolerance,
        "evaluations": int(plan.evaluations),
        "generations": len(plan.history) - 1,
        "stop": plan.stop,
        "history": plan.history.tolist(),
        "path_curve": "" if path is None else path.curve,
        "path_points": [] if path is None else path.points.ravel().tolist(),
        **plan.extra,
    }


def run_chunk(problems: dict[str, Problem], job: dict) -> tuple[pa.Table, pa.Table]:
    """The runs of a job (`RUN_COLUMNS`) and, in a table of their own because they never repeat, their times: id, cpu_s, wall_s.

    Raises RuntimeError, naming the run, if a planner fails.
    """
    blocked = {name: region(problem.workspace) for name, problem in problems.items() if name in job["problems"]}
    deterministic = getattr(planner_module(job["planner"]), "deterministic", False)
    rows, times = [], []
    for condition in conditions(list(job["problems"]), job["vary"]):
        problem = problems[condition.problem]
        if not times:
            # The first run of a process pays for loading compiled code; this one is thrown away.
            _guarded_run(job, condition, job["repeats"][0], problem)
        for repeat in range(*job["repeats"]):
            if repeat > job["repeats"][0] and deterministic:
                rows.append(rows[-1] | {"id": run_id(job, condition, repeat), "repeat": repeat})
                times.append(times[-1] | {"id": rows[-1]["id"]})
                continue
            cpu, wall = time.process_time(), time.perf_counter()
            plan = _guarded_run(job, condition, repeat, problem)
            cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
            rows.append(row(job, condition, repeat, plan, blocked[condition.problem]))
            times.append({"id": rows[-1]["id"], "cpu_s": cpu, "wall_s": wall})
        logger.info("%s: %d runs done", condition.name, len(rows))
    # Not every condition has the same columns, so they are gathered over all rows.
    columns = dict.fromkeys(column for each in rows for column in each)
    return pa.table({column: [each.get(column) for each in rows] for column in columns}), pa.Table.from_pylist(times)


def _guarded_run(job: dict, condition: Condition, repeat: int, problem: Problem) -> Plan:
    try:
        return run(job, condition, repeat, problem)
    except Exception as error:
        raise RuntimeError(f"run {run_id(job, condition, repeat)}: {type(error).__name__}: {error}") from error
