"""Runs that an alternative of an assumption changes."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import pyarrow.parquet as parquet

from bezierplan.running import execution, problems, rows
from bezierplan.running.inputs import Files


def with_chunks(
    experiments: Mapping[str, Files], chunks: Iterable[tuple[int, dict[str, Any]]], folder: Path
) -> dict[str, Files]:
    """Run chunks, by number and job, and write each with its times into
    `<folder>/<experiment>/<method>`; returns the files of experiments with theirs.
    """
    files = {name: each._replace(runs={**each.runs}) for name, each in experiments.items()}
    made = {name: problems.read(each.problems) for name, each in experiments.items()}
    for number, job in chunks:
        file = folder / job["experiment"] / job["method"] / f"{number}.parquet"
        file.parent.mkdir(parents=True, exist_ok=True)
        runs, times = execution.run_chunk(made[job["experiment"]], job)
        rows.write(runs, str(file))
        parquet.write_table(times, file.with_suffix(".times.parquet"))
        files[job["experiment"]].runs.setdefault(job["method"], []).append(str(file))
    return files
