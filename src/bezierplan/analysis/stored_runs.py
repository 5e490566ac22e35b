"""Run tables below a folder of results: their digests, and single rows of them."""

import json
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as parquet

from bezierplan.machine.digest import hash_text
from bezierplan.running.chunk import find_chunk_files


def list_run_tables(folder: Path) -> dict[str, list[Path]]:
    """List the chunk files of each run table below a folder, by `study/experiment/method`. Raises
    FileNotFoundError if there is none.
    """
    tables: dict[str, list[Path]] = {}
    for file in find_chunk_files(folder.resolve()):
        *_, above, reading, _, experiment, method, _ = file.parts
        # A study under a reading has a folder below the study's own.
        study = file.parts[-7:-4] if above in ("readings", "alternatives") else [reading]
        tables.setdefault("/".join([*study, experiment, method]), []).append(file)
    if not tables:
        raise FileNotFoundError(
            f"{folder}: no runs here; expected a folder of results, such as results/full"
        )
    return tables


def compute_table_digest(files: list[Path]) -> str:
    """Compute a digest of the rows of chunk files, each distinct row once, in the order of their
    text.

    Neither the order of the files nor the split of repeats into chunks matters.
    """
    rows = {format_row(row) for file in files for row in _read_rows(file)}
    return hash_text("\n".join(sorted(rows)))


def format_row(row: dict[str, Any]) -> str:
    """Format a row of a run table as text: columns in order of name, numbers in full precision."""
    return json.dumps(row, sort_keys=True, default=lambda value: value.tolist())


def find_stored_runs(name: str, folder: Path) -> dict[Path, dict[str, Any]]:
    """Find the rows with this name in the run tables below a folder, by file."""
    study, experiment, _, method, _ = name.split("/")
    files = find_chunk_files(folder, f"*/{study}/runs/{experiment}/{method}/*.parquet")
    return {file: row for file in files for row in _read_rows(file, name)}


def is_equal(run: pd.Series, row: dict[str, Any]) -> bool:
    """Return whether a reproduced run equals a stored row, bit for bit."""
    # What only other problems of the chunk have is missing in both.
    return format_row({name: run.get(name) for name in row}) == format_row(row)


def _read_rows(file: Path, identity: str | None = None) -> list[dict[str, Any]]:
    """Read the rows of a chunk file, or those with one id. Raises ValueError if it has no runs."""
    try:
        return parquet.read_table(
            file, filters=[("id", "=", identity)] if identity else None
        ).to_pylist()
    except pa.ArrowException:
        raise ValueError(
            f"{file}: not a whole Parquet file of runs; delete it: the workflow reproduces it"
        ) from None
