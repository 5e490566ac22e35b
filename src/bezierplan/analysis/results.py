"""The results of one experiment, read back for tables and figures."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path as FilePath
from pathlib import PurePath
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bezierplan.running import answer, table_files
from bezierplan.running import problems as problem_files
from bezierplan.running.chunk import Chunk, find_chunk_files
from bezierplan.running.columns import ANSWER, TABLES
from bezierplan.running.inputs import Files, group_by_table
from bezierplan.schema.model import convert_to_list
from bezierplan.workspaces.problem import Path, Problem
from bezierplan.workspaces.worlds import World


class Results(NamedTuple):
    """Runs, problems and bounds of an experiment.

    runs: one row per run, columns as in `running.columns`, with the bounds of its problem; one that
    drew no random numbers, and is equal to all others, stands for every repeat.
    problems: by name. bounds: one row per problem, indexed by name, columns as in
    `problems.compute_bounds`. published: the study's published numbers, if requested. jobs: method
    -> the first chunk of its runs, if runs are reproduced. worlds: by problem, where a world moves.
    """

    runs: pd.DataFrame
    problems: dict[str, Problem]
    bounds: pd.DataFrame
    published: pd.DataFrame | None = None
    jobs: dict[str, Chunk] | None = None
    worlds: dict[str, World] | None = None


def read(files: Files, repeats: int, experiment: str) -> Results:
    """Read the results of an experiment, up to a number of repeats.

    Chunks always run whole, so a file may hold more repeats than requested. Raises ValueError,
    naming the run, if a feasible path is shorter than the shortest path, or a drive arrives before
    any robot can: then the checker or the bound is wrong; and naming the file, if one is damaged or
    not in its place.
    """
    table = pd.concat(_read_chunks(files.runs, experiment), ignore_index=True)
    table = table[table["repeat"] < repeats].reset_index(drop=True)
    known, bounded = table_files.read(files.problems).to_pandas(), _read(files.bounds, "bounds")
    # A file of another experiment may lie in the place of this one.
    for file, rows in ((files.problems, known), (files.bounds, bounded)):
        if "problem" not in rows or not set(table["problem"]) <= set(rows["problem"]):
            raise table_files.describe_misplaced(file, "not of the problems that the runs are of")
    problems, moving = problem_files.read(files.problems)
    return join_bounds(table, problems, bounded)._replace(worlds=moving)


def read_folder(folder: FilePath, experiment: str) -> Results:
    """Read the results of an experiment of a study from the study's folder at a scale. Raises
    ValueError as `read` does, and if there are none.
    """
    runs: dict[str, list[str]] = {}
    for chunk in find_chunk_files(folder, "runs/*/*/*.parquet"):
        if chunk.parent.parent.name == experiment:
            runs.setdefault(chunk.parent.name, []).append(str(chunk))
    if not runs:
        raise ValueError(f"experiment: {experiment}: no runs of it in {folder}/runs")
    problems = f"{folder}/problems/{experiment}"
    files = Files(runs, f"{problems}.parquet", f"{problems}.bounds.parquet")
    # As many repeats as there are.
    return read(files, 10**9, experiment)


def _read_chunks(files: Mapping[str, list[str]], experiment: str) -> Iterator[pd.DataFrame]:
    """Yield the rows of each chunk file with their times. Raises ValueError for a file that is not
    the one that belongs in its place, or lacks a declared column.
    """
    seen: set[str] = set()
    for method, chunks in files.items():
        for file in chunks:
            rows = _read(file, "runs")
            for column, own in (("experiment", experiment), ("method", method)):
                if others := set(rows[column]) - {own}:
                    raise table_files.describe_misplaced(
                        file, f"of {column} {min(others)}, not {own}"
                    )
            if not seen.isdisjoint(rows["id"]) or rows["id"].duplicated().any():
                raise table_files.describe_misplaced(file, "the runs of another chunk")
            seen.update(rows["id"])
            beside = str(PurePath(file).with_suffix(".times.parquet"))
            times = _read(beside, "times")
            if sorted(times["id"]) != sorted(rows["id"]):
                raise table_files.describe_misplaced(
                    beside, f"not the times of {PurePath(file).name}"
                )
            yield rows.merge(times, on="id", validate="one_to_one")


_DRIVEN = {"runs": "arrival", "times": "replan_mean_s", "bounds": "least_arrival"}
"""Kind of file -> the column by which drives are recognised."""


def _read(file: str, kind: str) -> pd.DataFrame:
    """Read the rows of a file. Raises ValueError, naming the file, if its runs or bounds were
    edited, or if it lacks a declared column or has it in another type.
    """
    table, declared = table_files.read(file), TABLES[kind]
    drives = [declared.drives] if _DRIVEN[kind] in table.column_names else []
    if fault := table_files.find_fault(table.schema, *declared.every, *drives):
        raise table_files.describe_misplaced(file, fault)
    # Times are written without a digest.
    if kind != "times" and table_files.read_digest(table) != table_files.compute_digest(table):
        raise table_files.describe_misplaced(file, "its rows are not those that were written")
    return table.to_pandas()


def join_bounds(runs: pd.DataFrame, problems: dict[str, Problem], bounds: pd.DataFrame) -> Results:
    """Join runs with the bounds of their problems, as from `problems.compute_bounds`. Raises
    ValueError as `read` does.
    """
    bounds = bounds.set_index("problem")
    runs = _repeat_fixed_runs(runs)
    # The allowance is for the check below alone.
    runs = runs.join(bounds.drop(columns="least_length"), on="problem")
    least = runs["problem"].map(bounds["least_length"])
    # Runs without a path have no length: nan is not below the bound.
    _refuse(runs, runs["length"] < least, "length", "bound")
    # Drives alone have arrivals.
    if "least_arrival" in runs and "arrival" in runs:
        # The allowance of the length, at the pace of the world.
        _refuse(
            runs,
            runs["arrival"] < runs["least_arrival"] * (least / runs["bound"]),
            "arrival",
            "least_arrival",
        )
    return Results(runs, problems, bounds)


def _repeat_fixed_runs(runs: pd.DataFrame) -> pd.DataFrame:
    """Repeat runs that drew no random numbers, and whose answers are all equal, once for each
    repeat that there is under their condition, with their own id.
    """
    if runs["drew"].all():
        return runs
    still = runs[~runs["drew"]]
    answers = still[ANSWER].map(tuple).apply(tuple, axis=1)
    differ = answers.groupby([still["condition"], still["method"]]).transform("nunique") > 1
    # A copy of the generator has its numbers too.
    runs.loc[differ.index[differ], "drew"] = True
    repeats = runs[["condition", "repeat"]].drop_duplicates()
    # The order of the rows, which the merge would lose.
    runs = runs.assign(place=np.arange(len(runs)))
    once = runs[~runs["drew"]].drop_duplicates(["condition", "method"]).drop(columns="repeat")
    every = pd.concat([runs[runs["drew"]], once.merge(repeats, on="condition")])
    return every.sort_values(["place", "repeat"], ignore_index=True).drop(columns="place")


def _refuse(runs: pd.DataFrame, below: pd.Series, column: str, bound: str) -> None:
    """Refuse a feasible run that lies below a bound: raise ValueError, naming the run."""
    impossible = runs["feasible"] & below
    if impossible.any():
        run = runs[impossible].iloc[0]
        values = f"its {column} {run[column]:.12g} lies below the bound {run[bound]:.12g}"
        raise ValueError(f"run {run['id']} is said to be feasible, but {values}")


def read_all(files: Mapping[str, Files], repeats: Mapping[str, int]) -> dict[str, Results]:
    """Read the results of experiments, each up to its number of repeats."""
    return {
        experiment: read(files[experiment], number, experiment)
        for experiment, number in repeats.items()
    }


def read_published_table(file: str) -> pd.DataFrame:
    """Read a file of published numbers. Only an empty cell is a missing value: `none` and `NA` may
    be names.
    """
    return pd.read_csv(file, keep_default_na=False, na_values=[""])


def read_printed_numbers(file: str) -> pd.DataFrame:
    """Read a file of published numbers, and add a column `as_printed`: the text of their values,
    which keeps trailing zeros.
    """
    table = read_published_table(file)
    if "value" in table:
        table["as_printed"] = pd.read_csv(file, dtype=str)["value"]
    return table


def list_key_columns(numbers: pd.DataFrame) -> list[str]:
    """List the columns that tell rows of published numbers apart: those left of `metric`."""
    return numbers.columns[: numbers.columns.get_loc("metric")].to_list()


def read_published_tables(files: Iterable[str]) -> dict[str, pd.DataFrame]:
    """Read several files of published numbers, by table; files that are not in a folder of that
    name are left out.
    """
    named = group_by_table(file for file in files if PurePath(file).parent.name == "published")
    return {name: read_published_table(file) for name, file in named.items()}


def join_numbers(published: Mapping[str, pd.DataFrame]) -> pd.DataFrame | None:
    """Join the published numbers of several tables, with the name of each in the column `table`.

    Tables in another format are left out. None if none remains.
    """
    tables = [table.assign(table=name) for name, table in published.items()]
    tidy = [table for table in tables if {"metric", "statistic", "value"} <= set(table)]
    return pd.concat(tidy, ignore_index=True) if tidy else None


def build_path(run: Mapping[str, Any] | pd.Series) -> Path | None:
    """Build the path of a run; None if it has none."""
    return answer.restore_path(run["path_curve"], run["path_points"])


def select(runs: pd.DataFrame, where: dict) -> pd.DataFrame:
    """Select the runs whose columns equal the given values, or one of the values in a list."""
    chosen = [runs[column].isin(convert_to_list(wanted)) for column, wanted in where.items()]
    return runs[np.logical_and.reduce(chosen)] if chosen else runs


def is_repeated(runs: pd.DataFrame) -> np.ndarray:
    """Return which rows (n,) only show a run once more, in another repeat."""
    return (~runs["drew"] & runs.duplicated(["condition", "method"])).to_numpy()


def group_rows(table: pd.DataFrame, columns: list[str]) -> list[pd.DataFrame]:
    """Group the rows of a table with equal values in some columns, in their order; all of them
    without columns.
    """
    if not columns:
        return [table]
    return [rows for _, rows in table.groupby(columns, dropna=False, sort=False)]


def pick(runs: pd.DataFrame, which: dict) -> pd.Series | None:
    """Pick one of the given runs: `{lowest: column}` or `{median: column}` of the feasible ones, or
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
