"""Median CPU time of a run of every method of every study."""

import time
from collections.abc import Callable, Iterator

import numpy as np

from bezierplan.running import execution, problems
from bezierplan.study import definition, jobs, reading

RUNS = 5


def _milliseconds(run: Callable[[int], object]) -> float:
    """Median of several runs, by number, after one that compiles."""
    run(0)
    taken = []
    for number in range(RUNS):
        before = time.process_time()
        run(number)
        taken.append(1e3 * (time.process_time() - before))
    return float(np.median(taken))


def methods(study: definition.Study) -> Iterator[tuple[str, str]]:
    """Every method with the first experiment that it takes part in; baselines are the same
    everywhere and left out, and so are drives through worlds that move (`simulation.py`).
    """
    seen = set(study.baselines)
    for experiment, description in study.experiments.items():
        if study.moves(experiment):
            continue
        for method in description.methods:
            if method not in seen:
                seen.add(method)
                yield experiment, method


def benchmark_runs() -> None:
    """Each method of each study on the first condition of its first experiment."""
    print(f"\n{'a run':44}{'median ms':>12}   under")
    for key, study in reading.load(reading.read_config({})).items():
        for experiment, method in methods(study):
            job = jobs.job(study, experiment, method, "smoke", 0)
            made = problems.build_all(jobs.problems_job(study, experiment, "smoke"), study.folder)
            condition = job.conditions()[0]
            problem = made[condition.problem]
            taken = _milliseconds(lambda number: execution.run(job, condition, number, problem))  # noqa: B023
            print(f"  {key + ' ' + method:42}{taken:12.2f}   {condition.name}", flush=True)
