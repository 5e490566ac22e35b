"""Planners of OMPL beside those of the studies and the baseline `rounded`, on problems of the
studies: `make compare`, in an environment of its own (requirements.txt).

How close the best path comes to the exact shortest one, against the CPU time of one core, for 50
seeds. Only paths that the certified checker accepts count, whatever their planner says of them.
Budgets double from one attempt to the next, so times are known to a factor of two:

* PRM*, BIT* and Informed RRT*, with OMPL's defaults, are interrupted after times that double, and
  the path of each time is simplified by OMPL's simplifier. The shorter of both counts. A
  simplification is charged to its own path only, as in a run that ends there. Their test of a
  motion is exact (`ompl_planners`) but called in Python: a program in C++ would take less time than
  is stated here.
* A study's planners run anew for each number of generations, with the same seed. The best of all
  budgets so far counts, for some keep no best path. Settings are those of the study, but
  tharwat2018's swarm never stops early.
* `rounded` knows the exact shortest path and rounds its corners; its CPU time includes that of
  finding the shortest path.

Compilation is charged to nobody. Lengths of unlike paths are compared: OMPL's are polylines, at
whose corners a robot has to stop; so are those of meledje and of song2016's non-smooth method. All
others have continuous tangents, for which they must swing out, and those of one Bézier curve
continuous curvature as well. So OMPL solves an easier problem.

Writes planners.csv (each path) and planners_times.csv (the table) into results/comparison.
"""

import sys
import time
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path as File
from types import MappingProxyType
from typing import Any, NamedTuple

sys.path.insert(0, str(File(__file__).resolve().parents[2] / "src"))

import frame
import numpy as np
import pandas as pd

from bezierplan.geometry import checker, curves, shortest_paths
from bezierplan.geometry.region import Region, region
from bezierplan.planners import planner_module
from bezierplan.running import execution, problems
from bezierplan.running.chunk import Condition
from bezierplan.study import jobs
from bezierplan.workspaces.problem import Path, Problem

FOLDER = File(__file__).resolve().parents[2] / "results" / "comparison"
SEEDS = 50
TIMES = 0.16 / 2.0 ** np.arange(7, -1, -1)  # seconds, at which OMPL is interrupted
WITHIN = (0.1, 0.05, 0.02, 0.01)
SHARES = tuple(2.0 ** np.arange(-3, 3))
"""Budgets of a study's planner, as shares of the study's own."""
BASELINE = "rounded"


class Contest(NamedTuple):
    """A problem of a study with two of its planners. budget: the setting that says how long they
    search. changes: other settings.
    """

    study: str
    experiment: str
    problem: str
    methods: tuple[str, str]
    budget: str
    changes: Mapping[str, Any] = MappingProxyType({})


CONTESTS = [
    Contest("song2016", "routes", "15_240", ("nonsmooth", "smooth"), "generations"),
    Contest("meledje", "operators", "env2_modified", ("random", "proposed"), "generations"),
    Contest("ma2020", "environments", "environment2", ("bca", "bca_q"), "generations"),
    Contest("elhoseny2017", "maps", "hidden_u", ("mga_plain", "mga"), "iterations"),
    Contest(
        *("tharwat2018", "maps", "equal", ("pso", "cpso2_singer"), "iterations"),
        {"stall_limit": 0},
    ),
]


class Arena(NamedTuple):
    """What a contest is about: its study, problem, blocked region, and the length of the exact
    shortest path, in units.
    """

    contest: Contest
    study: frame.Study
    problem: Problem
    blocked: Region
    bound: float


Attempts = Iterator[tuple[float, Path | None]]
"""CPU seconds of a run and its path, for each of its budgets."""


def arena(contest: Contest) -> Arena:
    study = frame.study(contest.study)
    described = jobs.problems_job(study, contest.experiment, "full")
    built, _ = problems.build_all(described, study.folder)
    problem = built[contest.problem]
    bound = shortest_paths.shortest_path(problem).length
    return Arena(contest, study, problem, region(problem.workspace), bound)


def planned(at: Arena, method: str, shares: tuple[float, ...], seed: int) -> Attempts:
    """Runs of a study's method, one for each share of its own budget."""
    contest = at.contest
    job = jobs.job(at.study, contest.experiment, method, "full", 0)
    condition = Condition(contest.problem, {})
    settings, planner = execution.settings_in(job, condition), planner_module(job.planner)
    budget = settings.get(contest.budget)
    if budget:
        settings |= contest.changes
    for share in shares if budget else (1.0,):
        if budget:
            settings[contest.budget] = max(1, round(share * budget))
        rng, before = execution.task(job, condition, seed).generator(), time.process_time()
        plan = planner.plan(at.problem, rng, **settings)
        yield time.process_time() - before, plan.path


def with_ompl(at: Arena) -> dict[str, Any]:
    """Runs of OMPL's planners, by name. Their random numbers are one stream for all seeds."""
    import ompl_planners

    ompl_planners.start(seed=1)
    is_free = ompl_planners.segment_test(at.blocked)

    def run(planner: str, seed: int) -> Attempts:
        for seconds, points in ompl_planners.attempts(planner, at.problem, is_free, TIMES):
            yield seconds, None if points is None else Path("polyline", points)

    return {name: partial(run, name) for name in ompl_planners.PLANNERS}


def excess(at: Arena, path: Path | None) -> float:
    """Length of a path over the exact shortest one's, less 1; infinite unless it joins start and
    target and the checker accepts it.
    """
    if path is None:
        return np.inf
    pieces = curves.bezier_pieces(path)
    joins = (tuple(pieces[0, 0]), tuple(pieces[-1, -1])) == (at.problem.start, at.problem.target)
    if not joins or not checker.check(pieces, at.blocked).feasible:
        return np.inf
    return curves.length(path) / at.bound - 1


def compete(at: Arena, others: dict[str, Any], seeds: int = SEEDS) -> pd.DataFrame:
    """All attempts on a problem: problem, method, seed, cpu_s, excess. Planners take turns, so that
    what else runs on the machine disturbs all alike.
    """
    rivals = {method: partial(planned, at, method, SHARES) for method in at.contest.methods}
    rivals |= others | {BASELINE: partial(planned, at, BASELINE, (1.0,))}
    for run in rivals.values():
        next(run(seeds), None)  # compiles
    name = f"{at.contest.study}, {at.contest.problem}"
    rows = [
        (name, method, seed, seconds, excess(at, path))
        for seed in range(seeds)
        for method, run in rivals.items()
        for seconds, path in run(seed)
    ]
    return pd.DataFrame(rows, columns=["problem", "method", "seed", "cpu_s", "excess"])


def time_table(attempts: pd.DataFrame) -> pd.DataFrame:
    """One row for each problem, method and share of `WITHIN`: the median over seeds of the CPU
    seconds until a path is within the share of the exact length (infinite if fewer than half of the
    runs get there), and the share of seeds that get there.
    """
    rows = []
    for (problem, method), runs in attempts.groupby(["problem", "method"], sort=False):
        for share in WITHIN:
            near = runs["cpu_s"].where(runs["excess"] <= share, np.inf)
            until = near.groupby(runs["seed"]).min().to_numpy()
            median = np.quantile(until, 0.5, method="inverted_cdf")
            rows.append((problem, method, share, median, np.isfinite(until).mean()))
    return pd.DataFrame(rows, columns=["problem", "method", "within", "median_s", "reached"])


def main() -> None:
    tables = []
    for contest in CONTESTS:
        at = arena(contest)
        tables.append(compete(at, with_ompl(at)))
        print(f"{contest.study}: {len(tables[-1]):,} paths", flush=True)
    FOLDER.mkdir(parents=True, exist_ok=True)
    attempts = pd.concat(tables, ignore_index=True)
    attempts.to_csv(FOLDER / "planners.csv", index=False)
    table = time_table(attempts)
    table.to_csv(FOLDER / "planners_times.csv", index=False)
    print(table.to_string(index=False))


if __name__ == "__main__":
    main()
