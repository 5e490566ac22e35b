"""The results of one experiment, read back for tables and figures."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import PurePath
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import pyarrow as pa

from bezierplan.running import answer, worlds
from bezierplan.running import problems as problem_files
from bezierplan.running import rows as row_files
from bezierplan.running.chunk import Chunk
from bezierplan.running.columns import TABLES, Table
from bezierplan.running.inputs import Files
from bezierplan.schema.model import one_or_list
from bezierplan.workspaces.problem import Path, Problem
from bezierplan.workspaces.worlds import World


class Results(NamedTuple):
    """Runs, problems and bounds of an experiment.

    runs: one row per run, columns as in `running.columns`, with the bounds of its problem.
    problems: by name. bounds: one row per problem, indexed by name, columns as in
    `problems.bounds_of`. published: the study's published numbers, if requested. jobs: method ->
    the first chunk of its runs, if runs are reproduced. worlds: by problem, where a world
    moves.
    """

    runs: pd.DataFrame
    problems: dict[str, Problem]
    bounds: pd.DataFrame
    published: pd.DataFrame | None = None
    jobs: dict[str, Chunk] | None = None
    worlds: dict[str, World] | None = None


def read(files: Files, repeats: int, experiment: str) -> Results:
    """The results of an experiment, up to a number of repeats.

    Chunks always run whole, so a file may hold more repeats than requested. Raises ValueError,
    naming the run, if a feasible path is shorter than the shortest path, or a drive arrives before
    any robot can: then the checker or the bound is wrong; and naming the file, if one is damaged or
    not in its place.
    """
    table = pd.concat(_chunks(files.runs, experiment), ignore_index=True)
    table = table[table["repeat"] < repeats].reset_index(drop=True)
    bound_table = _read(files.bounds)
    bounded = bound_table.to_pandas()
    for file, known in (
        (files.problems, _read(files.problems).to_pandas()),
        (files.bounds, bounded),
    ):
        if "problem" not in known or not set(table["problem"]) <= set(known["problem"]):
            raise row_files.misplaced(file, "not of the problems that the runs are of")
    _refuse_unlike(files.bounds, bound_table, TABLES["bounds"], "least_arrival")
    results = joined(table, problem_files.read(files.problems), bounded)
    return results._replace(worlds=worlds.read(files.problems))


def _chunks(files: Mapping[str, list[str]], experiment: str) -> Iterator[pd.DataFrame]:
    """The rows of each chunk file with their times. Raises ValueError for a file that is not the
    one that belongs in its place, or lacks a declared column.
    """
    seen: set[str] = set()
    for method, file in ((method, chunk) for method, chunks in files.items() for chunk in chunks):
        table = _read(file, row_files.edited)
        rows = table.to_pandas()
        for column, wanted in (("experiment", experiment), ("method", method)):
            others = set(rows[column]) - {wanted} if column in rows else {"no runs"}
            if others:
                raise row_files.misplaced(
                    file, f"of {column} {min(map(str, others))}, not {wanted}"
                )
        if not seen.isdisjoint(rows["id"]) or rows["id"].duplicated().any():
            raise row_files.misplaced(file, "the runs of another chunk")
        _refuse_unlike(file, table, TABLES["runs"], "arrival")
        seen.update(rows["id"])
        beside = str(PurePath(file).with_suffix(".times.parquet"))
        timed = _read(beside)
        times = timed.to_pandas()
        if "id" not in times or sorted(times["id"]) != sorted(rows["id"]):
            raise row_files.misplaced(beside, f"not the times of {PurePath(file).name}")
        _refuse_unlike(beside, timed, TABLES["times"], "replan_mean_s")
        yield rows.merge(times, on="id", validate="one_to_one")


def _refuse_unlike(file: str, table: pa.Table, declared: Table, driven: str) -> None:
    """Raise ValueError, naming the file, if it lacks a declared column or has it in another type.
    driven: the column by which drives are known.
    """
    if fault := row_files.fault(
        table.schema, *declared.every, *([declared.drives] if driven in table.column_names else [])
    ):
        raise row_files.misplaced(file, fault)


def _read(file: str, edited: Callable[[pa.Table], bool] = lambda table: False) -> pa.Table:
    """`rows.read`, which also refuses a table that was edited."""
    table = row_files.read(file)
    if edited(table):
        raise row_files.misplaced(file, "its rows are not those that were written")
    return table


def joined(runs: pd.DataFrame, problems: dict[str, Problem], bounds: pd.DataFrame) -> Results:
    """Runs with the bounds of their problems, as from `problems.bounds_of`. Raises ValueError as
    `read` does.
    """
    bounds = bounds.set_index("problem")
    runs = runs.join(bounds.drop(columns="least_length", errors="ignore"), on="problem")
    least = runs["problem"].map(bounds["least_length"])
    _refuse(runs, runs["length"] < least, "length", "bound")
    if "least_arrival" in runs and "arrival" in runs:
        # The allowance of the length, at the pace of the world.
        _refuse(
            runs,
            runs["arrival"] < runs["least_arrival"] * (least / runs["bound"]),
            "arrival",
            "least_arrival",
        )
    return Results(runs, problems, bounds)


def _refuse(runs: pd.DataFrame, below: pd.Series, column: str, bound: str) -> None:
    """Raise ValueError, naming the run, if a feasible one lies below a bound."""
    impossible = runs["feasible"] & below
    if impossible.any():
        run = runs[impossible].iloc[0]
        values = f"its {column} {run[column]:.12g} lies below the bound {run[bound]:.12g}"
        raise ValueError(f"run {run['id']} is said to be feasible, but {values}")


def read_all(files: Mapping[str, Files], repeats: Mapping[str, int]) -> dict[str, Results]:
    """Results by experiment, each up to its number of repeats."""
    return {
        experiment: read(files[experiment], number, experiment)
        for experiment, number in repeats.items()
    }


def published_table(file: str) -> pd.DataFrame:
    """A file of published numbers. Only an empty cell is a missing value: `none` and `NA` may be
    names.
    """
    return pd.read_csv(file, keep_default_na=False, na_values=[""])


def joined_numbers(published: Mapping[str, pd.DataFrame]) -> pd.DataFrame | None:
    """The published numbers of several tables, concatenated, with the name of each in the column
    `table`.

    Tables in another format are left out. None if none remains.
    """
    tables = [table.assign(table=name) for name, table in published.items()]
    tidy = [table for table in tables if {"metric", "statistic", "value"} <= set(table)]
    return pd.concat(tidy, ignore_index=True) if tidy else None


def path_of(run: Mapping[str, Any] | pd.Series) -> Path | None:
    """The path of a run, or None if it has none."""
    return answer.restored(run["path_curve"], run["path_points"])


def select(runs: pd.DataFrame, where: dict) -> pd.DataFrame:
    """The runs whose columns equal the given values, or one of the values in a list."""
    chosen = [runs[column].isin(one_or_list(wanted)) for column, wanted in where.items()]
    return runs[np.logical_and.reduce(chosen)] if chosen else runs


def pick(runs: pd.DataFrame, which: dict) -> pd.Series | None:
    """One of the given runs: `{lowest: column}` or `{median: column}` of the feasible ones, or
    `{repeat: n}`; None if there is none.

    The median of an even number of runs is the lower of the middle two; ties go to the first
    repeat.
    """
    (word, value), *_ = which.items()
    if word == "repeat":
        chosen = runs[runs["repeat"] == value]
        return None if chosen.empty else chosen.iloc[0]
    ordered = runs[runs["feasible"]].sort_values([value, "repeat"], kind="stable")
    if ordered.empty:
        return None
    return ordered.iloc[0 if word == "lowest" else (len(ordered) - 1) // 2]
