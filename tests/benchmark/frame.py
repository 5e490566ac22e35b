"""What the parts of `make benchmark` share: CPU time, runs of the studies' methods, and a table.

CPU time is that of one core. Ratios carry over to other machines; the fastest of several rounds is
least disturbed by what else runs.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import pandas as pd

from bezierplan.places import STUDIES
from bezierplan.planners import Plan
from bezierplan.running import execution, problems
from bezierplan.study import jobs, reading
from bezierplan.study.definition import Study

FOLDER = Path(__file__).parents[2] / "results" / "benchmark"
ROUNDS = 5
WIDTH = 14
"""Characters of a column, the first aside."""

Row = tuple[object, ...]


def cpu_seconds(work: Callable[[], object], rounds: int = ROUNDS) -> float:
    """CPU seconds of the fastest of several rounds, after one that compiles."""
    return cpu_seconds_of_each([work], rounds)[0]


def cpu_seconds_of_each(works: Sequence[Callable[[], object]], rounds: int = ROUNDS) -> list[float]:
    """As `cpu_seconds`, of several works, each in turn in every round: what slows a round down
    slows all of them.
    """
    for work in works:
        work()
    return [
        min(seconds) for seconds in zip(*([_once(work) for work in works] for _ in range(rounds)))
    ]


def _once(work: Callable[[], object]) -> float:
    before = time.process_time()
    work()
    return time.process_time() - before


def study(key: str) -> Study:
    return reading.read_study(STUDIES / key)


def studies(small: bool) -> list[Study]:
    """All studies, or the first."""
    keys = sorted(file.parent.name for file in STUDIES.glob("*/experiments.yaml"))
    return [study(key) for key in keys[: 1 if small else None]]


def methods(study: Study) -> Iterator[tuple[str, str]]:
    """Every method with the first experiment that it takes part in; without baselines, which are
    the same everywhere, and drives through worlds that move.
    """
    seen = set(study.baselines)
    for experiment, description in study.experiments.items():
        for method in description.methods:
            if method not in seen and not study.moves(experiment):
                seen.add(method)
                yield experiment, method


def first_run(study: Study, experiment: str, method: str) -> tuple[str, Callable[[int], Plan]]:
    """The first condition of an experiment, and what runs a method on it, for a number of a
    repeat.
    """
    job = jobs.job(study, experiment, method, "smoke", 0)
    built = problems.build_all(jobs.problems_job(study, experiment, "smoke"), study.folder)
    condition = job.conditions()[0]
    problem = built[condition.problem]
    return condition.name, lambda repeat: execution.run(job, condition, repeat, problem)


def table(name: str, columns: Sequence[str], rows: Iterable[Row]) -> None:
    """Print rows as they come, the first column to the left, and write them into a csv file."""
    print(f"\n{name + ': ' + columns[0]:50}" + "".join(f"{c:>{WIDTH}}" for c in columns[1:]))
    lines = []
    for row in rows:
        cells = (f"{v:,.4g}" if isinstance(v, float) else str(v) for v in row[1:])
        print(f"  {row[0]:48}" + "".join(f"{cell:>{WIDTH}}" for cell in cells), flush=True)
        lines.append(row)
    FOLDER.mkdir(parents=True, exist_ok=True)
    pd.DataFrame(lines, columns=list(columns)).to_csv(FOLDER / f"{name}.csv", index=False)
