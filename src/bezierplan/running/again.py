"""Runs that an alternative of an assumption changes."""

from collections.abc import Iterable, Mapping
from pathlib import Path

import pyarrow.parquet as parquet

from bezierplan.running import execution, problems, rows
from bezierplan.running.chunk import Chunk
from bezierplan.running.inputs import Files


def with_chunks(
    experiments: Mapping[str, Files], chunks: Iterable[tuple[int, Chunk]], folder: Path
) -> dict[str, Files]:
    """Run chunks, each with its number, and write each with its times into
    `<folder>/<experiment>/<method>`; returns the files of experiments with theirs.
    """
    files = {name: each._replace(runs={**each.runs}) for name, each in experiments.items()}
    made = {name: problems.read(each.problems) for name, each in experiments.items()}
    for number, chunk in chunks:
        file = folder / chunk.experiment / chunk.method / f"{number}.parquet"
        file.parent.mkdir(parents=True, exist_ok=True)
        runs, times = execution.run_chunk(made[chunk.experiment], chunk)
        rows.write(runs, str(file))
        parquet.write_table(times, file.with_suffix(".times.parquet"))
        files[chunk.experiment].runs.setdefault(chunk.method, []).append(str(file))
    return files
