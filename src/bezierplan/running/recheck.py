"""Check that stored runs are what their own points say: judge every stored path again, and repeat
some runs.

Judging calls no planner: a path is read from its row, and judged on the workspace in the file of
problems, in a process where no planner has run. What no path determines, such as a planner's
objective, is covered by the digest of each file (`table_files`), and by the runs that are repeated
(`run_again`). The motion of repeated drives is checked too.
"""

import hashlib
import json
import math
import multiprocessing
import platform
import sys
from collections.abc import Callable, Collection, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path as File
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from bezierplan.geometry.region import build_region
from bezierplan.machine.digest import COMPUTING, find_library_version, hash_text
from bezierplan.running import answer, drives, execution, problems, table_files
from bezierplan.running.chunk import Chunk, Condition
from bezierplan.running.columns import DriveOutcome, Outcome, Planned, Row
from bezierplan.running.jobs.watchdog import PlannerFailure, end_with_parent
from bezierplan.schema.safe_text import escape
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import World

# Another platform or library can change the last bits of a number, and the place of a first
# collision a little more.
_SAME = 1e-9
_SAME_PLACE = 1e-6

MADE_AGAIN = 100
"""One run of so many is made again."""


class Difference(NamedTuple):
    """A file that does not follow from runs and studies, and how it differs."""

    file: str
    what: str

    def __str__(self) -> str:
        return escape(" ".join(f"{self.file}: {self.what}".split()))


def _describe_difference(file: str, run: str, column: str, old: Any, new: Any) -> Difference:
    """Describe how a stored value of a run differs from the recomputed one."""
    return Difference(file, f"{run}: {column}: stored {old}, recomputed {new}")


def describe_error(file: str, error: Exception) -> Difference:
    """Describe an exception about a file as a difference."""
    return Difference(file, str(error).removeprefix(f"{file}: "))


class StoredRuns(NamedTuple):
    """Files of runs of an experiment, each with the chunk that it should hold.

    other_settings: the file that defines the experiment, if it has changed since the runs were
    made.
    """

    problems: str
    runs: dict[str, Chunk]
    other_settings: str = ""


class RunsVerdict(NamedTuple):
    """The verdict on stored runs.

    faults: in order of files. files, runs: how many files of runs, and rows in them. paths: number
    of different paths in these. digests: a line for each file.
    """

    faults: tuple[Difference, ...] = ()
    files: int = 0
    runs: int = 0
    paths: int = 0
    digests: tuple[str, ...] = ()

    @property
    def digest(self) -> str:
        """Return one digest for all files of runs."""
        return hash_text("\n".join(sorted(self.digests)))


def verify(tasks: list[StoredRuns], processes: int, say: Callable[[str], None]) -> RunsVerdict:
    """Judge all runs of tasks in several processes, and return one verdict.

    say: gets a line of progress now and then.
    """
    done = []
    for each in _map(judge, tasks, processes):
        done.append(each)
        if len(done) % 10 == 0:
            say(f"{len(done)} of {len(tasks)} tables checked")
    return merge_verdicts(done)


def _map(function: Callable[[Any], Any], items: list[Any], processes: int) -> Iterator[Any]:
    """Apply a function to items in several processes. Other systems than Linux use one, because
    there each process would start the job's script anew.
    """
    if processes == 1 or sys.platform != "linux":
        yield from map(function, items)
        return
    with ProcessPoolExecutor(
        # A forked process has all modules, and a killed parent leaves none behind.
        processes,
        multiprocessing.get_context("fork"),
        end_with_parent,
    ) as pool:
        yield from pool.map(function, items)


def merge_verdicts(verdicts: Iterable[RunsVerdict]) -> RunsVerdict:
    """Add several verdicts up: their counts, and their faults and digests in order."""
    return RunsVerdict(*(sum(parts[1:], parts[0]) for parts in zip(RunsVerdict(), *verdicts)))


def check_sound(verdict: RunsVerdict) -> dict[str, Any]:
    """Return the content of a verdict as plain values. Raises ValueError with its first fault."""
    if verdict.faults:
        raise ValueError(
            f"{verdict.faults[0]} (one of {len(verdict.faults)} values that differ; delete the "
            "file and start again)"
        )
    return {name: value for name, value in verdict._asdict().items() if name != "faults"}


def write(content: dict[str, Any], file: str) -> None:
    """Write plain values as JSON."""
    File(file).write_text(json.dumps(content, indent=1) + "\n")


def compute_sha256(file: File) -> str:
    """Return the digest of a file; empty if it is not there."""
    return hashlib.sha256(file.read_bytes()).hexdigest() if file.is_file() else ""


def read_versions() -> dict[str, str]:
    """Return the versions of Python and of the libraries that compute."""
    names = sorted({name for names in COMPUTING.values() for name in names})
    return {"python": platform.python_version()} | {
        name: find_library_version(name) for name in names
    }


def _read_problems(file: str) -> tuple[problems.Problems, problems.Worlds]:
    """Read a file of problems. Raises ValueError if it is not one."""
    try:
        return problems.read(file)
    except (OSError, pa.ArrowException, KeyError, TypeError, ValueError):
        raise table_files.describe_misplaced(file, "not a whole file of problems") from None


def judge(task: StoredRuns) -> RunsVerdict:
    """Judge the runs of a task again."""
    try:
        by_name, moving = _read_problems(task.problems)
    except ValueError as error:
        return RunsVerdict((describe_error(task.problems, error),), len(task.runs))
    faults, lines, runs = [], [], 0
    # By method, so that what is counted does not depend on which methods are judged together.
    by_method: dict[str, dict[tuple, dict[str, tuple[Any, float]]]] = {}
    for file, chunk in task.runs.items():
        try:
            table = table_files.read(file)
        except ValueError as error:
            faults.append(describe_error(file, error))
            continue
        declared = (Planned, Outcome, *([DriveOutcome] if chunk.policy else []))
        kept, digest = table_files.read_digest(table), table_files.compute_digest(table)
        # From the study's name on: the digest is the same wherever the results lie.
        lines.append(f"{'/'.join(File(file).parts[-5:])} {digest}")
        # Rows that were changed are not judged: they could hold anything.
        if kept != digest:
            faults.append(Difference(file, "other rows than were written"))
        elif fault := table_files.find_fault(table.schema, *declared):
            faults.append(describe_error(file, table_files.describe_misplaced(file, fault)))
        else:
            stored = table.to_pylist()
            of_file = [*_find_identity_faults(file, stored, chunk)]
            # A changed experiment explains all differences, so only its file is named.
            if of_file and task.other_settings:
                what = f"experiment {chunk.experiment} is another one than that of these runs"
                of_file = [Difference(task.other_settings, f"{what}: {File(file).parents[1]}")]
            elif not of_file and not {row["problem"] for row in stored} <= by_name.keys():
                of_file = [Difference(task.problems, "not of the problems that the runs are of")]
            faults += of_file
            for row in [] if of_file else stored:
                cache = by_method.setdefault(chunk.method, {})
                faults += _find_row_faults(file, row, by_name[row["problem"]], moving, cache)
                runs += 1
    return RunsVerdict(
        tuple(dict.fromkeys(faults)),
        len(task.runs),
        runs,
        sum(map(len, by_method.values())),
        tuple(lines),
    )


def _list_runs(chunk: Chunk) -> list[tuple[Condition, int]]:
    """Return the condition and the repeat of each row of a chunk, in order."""
    return [(each, repeat) for each in chunk.conditions() for repeat in range(*chunk.repeats)]


def _find_identity_faults(file: str, entries: list[Row], chunk: Chunk) -> Iterator[Difference]:
    """Yield the differences between the rows of a file and what is known of them before
    their runs.
    """
    planned = [execution.identify_run(chunk, *each) for each in _list_runs(chunk)]
    # With other rows than planned, row by row nothing matches.
    if len(entries) != len(planned):
        yield Difference(file, f"{len(entries)} rows; expected {len(planned)}")
        return
    for row, known in zip(entries, planned):
        for name, value in known.items():
            # What a run finds out takes the place of a setting of that name. No NaN equals itself.
            again = row.get(name)
            equal = again == value or (value != value and again != again)
            if name not in Outcome._fields and not equal:
                yield _describe_difference(file, known["id"], name, again, value)


def _find_row_faults(
    file: str,
    row: Row,
    problem: Problem,
    moving: dict[str, World],
    cache: dict[tuple, dict[str, tuple[Any, float]]],
) -> Iterator[Difference]:
    """Yield the differences between a row and what its points say.

    cache: what paths say, so that equal ones are judged once.
    """
    points = row["path_points"]
    try:
        if moving:
            again = _judge_way(row, np.reshape(points, (-1, 2)), problem, moving[problem.name])
        else:
            key = problem.name, row["path_curve"], tuple(points)
            if key not in cache:
                cache[key] = _judge_path(row["path_curve"], points, problem)
            again = cache[key] | {"generations": (len(row["history"]) - 1, 0.0)}
    except (ValueError, IndexError) as error:
        again = {}
        yield _describe_difference(file, row["id"], "path_points", "a path", error)
    for name, (value, tolerance) in again.items():
        if row[name] is None or not is_same(row[name], value, tolerance):
            yield _describe_difference(file, row["id"], name, row[name], value)


def is_same(value: float, again: float, tolerance: float) -> bool:
    """Return whether two numbers are equal up to a tolerance, relative and absolute. A nan equals a
    nan.
    """
    return math.isclose(value, again, rel_tol=tolerance, abs_tol=tolerance) or (
        math.isnan(value) and math.isnan(again)
    )


def _judge_path(curve: str, points: list[float], problem: Problem) -> dict[str, tuple[Any, float]]:
    """Return what the points of a path say: value and tolerance by column.

    Raises ValueError for points that are no path of the problem.
    """
    path = answer.restore_path(curve, points)
    if path is None and points:
        raise ValueError("none without a curve")
    answer.check_ends(path, problem)
    again = answer.judge_path(path, build_region(problem.workspace))
    # Both the stored and the recomputed distance may be off by the checker's tolerance.
    slack = 2 * (again["clearance_error"] if path else 0.0) + _SAME
    tolerances = {"length": _SAME, "feasible": 0.0, "collision_at": _SAME_PLACE}
    return {name: (value, tolerances.get(name, slack)) for name, value in again.items()}


def _judge_way(
    row: Row, points: np.ndarray, problem: Problem, world: World
) -> dict[str, tuple[Any, float]]:
    """Return what the way of a drive says: value and tolerance by column."""
    length = float(np.hypot(*np.diff(points, axis=0).T).sum())
    arrived = not math.isnan(row["arrival"])
    free = drives.joins_ends(points, problem) and math.isnan(row["collision_at"])
    return {
        "length": (length, _SAME),
        "travelled": (length, _SAME),
        "claimed_feasible": (arrived, 0.0),
        "feasible": (arrived and free, 0.0),
        "objective": (row["arrival"] * world.pace if arrived else math.inf, _SAME),
        "clearance": (max(row["clearance_least"], 0.0), _SAME),
    }


# --------------------------------------------------------------------------------------------------
# Runs made again


def run_again(
    tasks: list[StoredRuns], wrong: Collection[str], processes: int, digest: str, every: bool
) -> RunsVerdict:
    """Repeat runs, and return how many differ from their rows in any bit, as a verdict.

    These are the first run of each file and one in `MADE_AGAIN`, chosen by a digest, or all. wrong:
    files with faults, whose runs are not repeated.
    """
    # The digest is that of all runs: which ones are repeated is known only once all are there.
    again = partial(_run_file_again, digest=digest, share=1 if every else MADE_AGAIN)
    files = [
        (task.problems, file, chunk)
        for task in tasks
        for file, chunk in task.runs.items()
        if not {task.problems, task.other_settings, file} & {*wrong}
    ]
    return merge_verdicts(_map(again, files, processes))


def _run_file_again(of: tuple[str, str, Chunk], digest: str, share: int) -> RunsVerdict:
    """Repeat runs of one file (problems, runs, chunk), as `run_again` says."""
    problem_file, file, chunk = of
    runs = _list_runs(chunk)
    numbers = [
        n
        for n, run in enumerate(runs)
        if n == 0
        or int(hashlib.sha256(f"{digest} {execution.run_id(chunk, *run)}".encode()).hexdigest(), 16)
        % share
        == 0
    ]
    made, moving = _read_problems(problem_file)
    try:
        remade = execution.make_rows_again(chunk, [runs[n] for n in numbers], made, moving)
    except (PlannerFailure, ValueError) as error:
        return RunsVerdict((Difference(file, f"cannot be made again: {error}"),))
    faults = []
    for row, stored in zip(remade, table_files.read(file).take(numbers).to_pylist()):
        for name, value in table_files.build_table([row], Planned, Outcome).to_pylist()[0].items():
            # The text of a number has all its bits; and a NaN, unlike itself as a number, has equal
            # text.
            if repr(value) != repr(stored.get(name)):
                faults.append(_describe_difference(file, row["id"], name, stored.get(name), value))
    return RunsVerdict(tuple(faults), runs=len(numbers))
