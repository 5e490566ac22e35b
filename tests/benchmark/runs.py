"""Median CPU time of a run of every method of every study."""

import statistics
from collections.abc import Iterator
from functools import partial

import frame

COLUMNS = ("a run", "median ms", "condition")
RUNS = 5


def rows(small: bool) -> Iterator[frame.Row]:
    """Each method of each study on the first condition of its first experiment."""
    for study in frame.studies(small):
        for experiment, method in [*frame.methods(study)][: 2 if small else None]:
            condition, run = frame.first_run(study, experiment, method)
            seconds = [frame.cpu_seconds(partial(run, repeat), 1) for repeat in range(RUNS)]
            yield f"{study.key} {method}", 1e3 * statistics.median(seconds), condition
