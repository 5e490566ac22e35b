"""Are the results of a scale what their own points say? Every stored path is judged again, every
bound computed again.

Nothing here calls a planner: a path is read from its row, and judged on the workspace of the file
of problems, in a process that no planner was in. What no path determines, such as a planner's
objective, is covered by the digest of each file (`rows`).

Of drives, rows keep the path travelled without its times, and traces keep places at whole steps, in
single precision. So their lengths and the agreement of their columns are checked, and that no place
at a whole step lies in an obstacle of a drive that is said to be free.
"""

import hashlib
import json
import math
import multiprocessing
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from pathlib import Path as File
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from bezierplan.geometry import curves
from bezierplan.geometry.region import Region, walled
from bezierplan.machine.digest import COMPUTING, library_version
from bezierplan.running import columns, problems, rides, rows, worlds
from bezierplan.running.chunk import chunk_files
from bezierplan.running.jobs.watchdog import end_with_parent
from bezierplan.running.judge import answer
from bezierplan.schema.words import plain
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import MovingCircles, World

# Numbers of another platform or version may differ in the last bits, and places of a first
# collision a little more.
_SAME = 1e-9
_SAME_PLACE = 1e-6
# Places of traces are in single precision; of a field of 100 units they are this exact.
_TRACE = 1e-3


class Fault(NamedTuple):
    """A stored value that the points contradict. run: its id, a problem's name, or `all rows`."""

    file: str
    run: str
    column: str
    stored: Any
    recomputed: Any

    def __str__(self) -> str:
        return plain(
            " ".join(
                f"{self.file}: {self.run}: {self.column}: stored {self.stored}, recomputed "
                f"{self.recomputed}".split()
            )
        )


class Task(NamedTuple):
    """Runs of an experiment to be judged; or, with a file of bounds, that file."""

    problems: str
    bounds: str
    runs: tuple[str, ...]


class Verdict(NamedTuple):
    """faults: in order of files. files, runs: how many files of runs, and rows in them. paths:
    different paths among these. bounds: how many were computed again. undigested: files without a
    digest of their own. digests: a line for each file of runs.
    """

    faults: list[Fault]
    files: int
    runs: int
    paths: int
    bounds: int
    undigested: int
    digests: tuple[str, ...]

    @property
    def digest(self) -> str:
        """One for all files of runs."""
        return hashlib.sha256("\n".join(sorted(self.digests)).encode()).hexdigest()[:16]


def tasks(folder: File) -> list[Task]:
    """What to check below a scale's folder. Raises FileNotFoundError without runs or problems."""
    experiments: dict[File, list[str]] = {}
    for file in chunk_files(folder):
        experiments.setdefault(file.parents[1], []).append(str(file))
    if not experiments:
        raise FileNotFoundError(
            f"{folder}: no runs here; expected a folder of results, such as results/full"
        )
    listed = [
        Task(str(_problems_of(experiment, folder)), "", tuple(files))
        for experiment, files in experiments.items()
    ]
    for bounds in sorted(folder.glob("*/problems/*.bounds.parquet")):
        experiment = bounds.name.removesuffix(".bounds.parquet")
        listed.append(Task(str(bounds.with_name(f"{experiment}.parquet")), str(bounds), ()))
    return listed


def _problems_of(experiment: File, folder: File) -> File:
    """The file of the problems of an experiment's runs; at `extended` it may be that of `full`."""
    study = experiment.relative_to(folder).parts[0]
    places = [
        scale / study / "problems" / f"{experiment.name}.parquet"
        for scale in (folder, folder.parent / "full")
    ]
    there = next((place for place in places if place.is_file()), None)
    if there is None:
        raise FileNotFoundError(f"{places[0]}: missing; expected the problems of {experiment}")
    return there


def verify(
    tasks: list[Task], processes: int, told: Callable[[str], None] = lambda line: None
) -> Verdict:
    """The verdict on tasks, in several processes. told: gets a line of progress now and then."""
    # The largest first, so that no process ends long after the others: bounds take longest.
    largest = sorted(tasks, key=lambda task: (not task.bounds, -len(task.runs)))
    done = []
    for n, each in enumerate(_mapped(judged, largest, processes), start=1):
        done.append(each)
        if n % 10 == 0 or n == len(tasks):
            faults = sum(len(verdict.faults) for verdict in done)
            told(f"{n} of {len(tasks)} tables checked, {faults} faults")
    return merged(done)


def _mapped(
    function: Callable[[Task], Verdict], tasks: list[Task], processes: int
) -> Iterator[Verdict]:
    """`map`, in processes beside this one if there are to be several, on Linux: elsewhere they
    would begin with a job's script anew.
    """
    if processes == 1 or sys.platform != "linux":
        yield from map(function, tasks)
        return
    with ProcessPoolExecutor(
        processes, multiprocessing.get_context("fork"), end_with_parent
    ) as pool:
        yield from pool.map(function, tasks)


def merged(verdicts: Iterable[Verdict]) -> Verdict:
    """Several verdicts as one."""
    whole = Verdict(*(sum(parts[1:], parts[0]) for parts in zip(*verdicts)))
    return whole._replace(faults=sorted(whole.faults, key=lambda fault: fault[:3]))


def write(verdict: Verdict, file: str) -> None:
    """Write what was checked, and with which versions, as JSON. Raises ValueError with a fault."""
    if verdict.faults:
        raise ValueError(
            f"{verdict.faults[0]} (one of {len(verdict.faults)} values that differ; delete the "
            "file and start again)"
        )
    counts = {
        name: getattr(verdict, name) for name in ("files", "runs", "paths", "bounds", "digest")
    }
    File(file).write_text(json.dumps(counts | {"versions": versions()}, indent=1) + "\n")


def versions() -> dict[str, str]:
    """The libraries that compute, with their versions."""
    return {name: library_version(name) for name in COMPUTING}


def judged(task: Task) -> Verdict:
    """The verdict on a task. Raises ValueError for a file that is not the table to be there."""
    try:
        made, moving = problems.read(task.problems), worlds.read(task.problems)
    except (OSError, pa.ArrowException, KeyError, TypeError, ValueError):
        raise rows.misplaced(task.problems, "not a whole file of problems") from None
    if task.bounds:
        return _bounds_judged(task, made, moving)
    chunks = [_chunk(file, _DRIVE_COLUMNS if moving else _RUN_COLUMNS) for file in task.runs]
    faults = [fault for chunk in chunks for fault in _identity_faults(chunk, made, task.problems)]
    names = [name for chunk in chunks for name in chunk["id"]]
    twice = {name for name, times in Counter(names).items() if times > 1}
    faults += [
        Fault(chunk.file, name, "id", "twice", "once")
        for chunk in chunks
        for name in chunk["id"]
        if name in twice
    ]
    known: dict[tuple[str, str, bytes], _Judged] = {}
    faults += _drive_faults(chunks, made, moving) if moving else _path_faults(chunks, made, known)
    return Verdict(
        faults,
        len(chunks),
        len(names),
        len(known),
        0,
        sum(chunk.kept is None for chunk in chunks),
        tuple(f"{'/'.join(File(chunk.file).parts[-5:])} {chunk.digest}" for chunk in chunks),
    )


# --------------------------------------------------------------------------------------------------
# Files


class _Chunk(NamedTuple):
    """A file of runs: its columns that are looked at, by name: words as lists, numbers as arrays,
    lists as lists of arrays; others are covered by digests. digest: of all rows; kept: that of the
    file itself, if it has one.
    """

    file: str
    columns: dict[str, Any]
    digest: str
    kept: str | None

    def __getitem__(self, name: str) -> Any:
        return self.columns[name]


_IDENTITY = ("id", "study", "experiment", "condition", "problem", "method", "repeat")
_RUN_COLUMNS = (
    *_IDENTITY,
    *("length", "feasible", "collision_at", "collision_depth", "clearance", "clearance_error"),
    *("generations", "history", "path_curve", "path_points"),
)
_DRIVE_COLUMNS = (
    *_IDENTITY,
    *("objective", "length", "claimed_feasible", "feasible", "collision_at", "clearance"),
    *("path_points", "arrival", "travelled", "clearance_least"),
)
_TYPES: dict[str, tuple[str, Callable[[pa.DataType], bool]]] = {
    # What wrote a file chooses between the two types of text.
    "word": ("text", lambda kind: pa.types.is_string(kind) or pa.types.is_large_string(kind)),
    "flag": ("truths", pa.types.is_boolean),
    "number": ("numbers", lambda kind: pa.types.is_floating(kind) or pa.types.is_integer(kind)),
    "list": ("lists of numbers", pa.types.is_list),
}


def _chunk(file: str, names: Iterable[str]) -> _Chunk:
    """A file of runs. Raises ValueError for one without these columns."""
    table = rows.read(file)
    kinds = columns.PLANNED | columns.RESULTS | columns.DRIVE_RESULTS
    found = {name: _column(file, table, name, kinds[name]) for name in names}
    return _Chunk(file, found, rows.rows_digest(table), rows.kept_digest(table))


def _column(file: str, table: pa.Table, name: str, kind: str) -> Any:
    """A column, with a value in each row. Raises ValueError for one that is not there or holds
    other things.
    """
    kind = "word" if kind == "name" else kind
    expected, fits = _TYPES[kind]
    if name not in table.column_names:
        raise rows.misplaced(file, f"no column {name}")
    column = table[name].combine_chunks()
    if not fits(column.type) or column.null_count:
        raise rows.misplaced(file, f"column {name}: expected {expected} in every row")
    if kind == "word":
        return column.to_pylist()
    if kind == "list":
        flat = column.flatten().cast(pa.float64()).to_numpy(zero_copy_only=False)
        return np.split(flat, np.cumsum(column.value_lengths().to_numpy())[:-1])
    return column.to_numpy(zero_copy_only=False).astype(float)


def _identity_faults(chunk: _Chunk, made: dict[str, Problem], file: str) -> Iterator[Fault]:
    """Whether rows stand in their file, their ids say what their columns say, and the file's digest
    is that of its rows. file: of the problems.
    """
    if chunk.kept not in (None, chunk.digest):
        yield Fault(chunk.file, "all rows", "digest", chunk.kept, chunk.digest)
    *_, experiment, method, _ = File(chunk.file).parts
    parts = ("study", "experiment", "condition", "method", "repeat")
    for name, problem, *values in zip(*(chunk[part] for part in ("id", "problem", *parts))):
        row = dict(zip(parts, values), id=name, problem=problem)
        expected = {
            "id": "/".join([*values[:-1], f"{values[-1]:.0f}"]),
            "experiment": experiment,
            "method": method,
            # A condition's name begins with its problem's.
            "problem": row["condition"].partition(",")[0],
        }
        for column, value in expected.items():
            if row[column] != value:
                yield Fault(chunk.file, name, column, row[column], value)
        if problem not in made:
            yield Fault(chunk.file, name, "problem", problem, f"one of {file}")


def _differing(chunk: _Chunk, again: dict[str, tuple[np.ndarray, Any]]) -> Iterator[Fault]:
    """A chunk's values that differ from those computed again, by column, with its tolerance."""
    for name, (values, tolerance) in again.items():
        plain = bool if name in ("feasible", "claimed_feasible") else float
        for row in np.flatnonzero(~same(chunk[name], values, tolerance)):
            yield Fault(
                chunk.file, chunk["id"][row], name, plain(chunk[name][row]), plain(values[row])
            )


def same(stored: np.ndarray, again: np.ndarray, tolerance: Any) -> np.ndarray:
    """Whether numbers (n,) equal those computed again, up to a tolerance, relative and absolute;
    not a number equals itself.
    """
    with np.errstate(invalid="ignore"):
        size = np.maximum(1.0, np.maximum(np.abs(stored), np.abs(again)))
        close = (np.abs(stored - again) <= tolerance * size) & np.isfinite(size)
    return (stored == again) | close | (np.isnan(stored) & np.isnan(again))


# --------------------------------------------------------------------------------------------------
# Paths


class _Judged(NamedTuple):
    """What the points of a path say. verdict: length, feasible, collision_at, depth, clearance,
    tolerance. faults: column, stored value, and what would be right.
    """

    verdict: tuple[float, ...]
    faults: tuple[tuple[str, Any, Any], ...]


def _path_faults(
    chunks: list[_Chunk],
    made: dict[str, Problem],
    known: dict[tuple[str, str, bytes], _Judged],
) -> Iterator[Fault]:
    """What of runs differs from what their points say. known: what different paths say."""
    regions = problems.remembered()
    for chunk in chunks:
        verdicts = np.full((len(chunk["id"]), 6), math.nan)
        for row, (name, curve, points) in enumerate(
            zip(chunk["problem"], chunk["path_curve"], chunk["path_points"])
        ):
            if name not in made:
                continue
            key = name, curve, points.tobytes()
            if key not in known:
                blocked = regions(made[name].workspace)
                known[key] = _path_judged(curve, points, made[name], blocked)
            verdicts[row], faults = known[key]
            yield from (Fault(chunk.file, chunk["id"][row], *fault) for fault in faults)
        length, feasible, collision_at, depth, clearance, tolerance = verdicts.T
        slack = 2 * np.nan_to_num(tolerance) + _SAME
        again = {
            "length": (length, _SAME),
            "feasible": (feasible, 0.0),
            "collision_at": (collision_at, _SAME_PLACE),
            "collision_depth": (depth, slack),
            "clearance": (clearance, slack),
            "clearance_error": (tolerance, slack),
            "generations": (np.array([len(each) - 1.0 for each in chunk["history"]]), 0.0),
        }
        yield from _differing(chunk, again)


def _path_judged(curve: str, points: np.ndarray, problem: Problem, blocked: Region) -> _Judged:
    """What the points of a path say. Points that are none, or of no path, are a fault."""
    try:
        path = answer.restored(curve, points)
        length, check = answer.verdict(path, blocked)
    except ValueError as error:
        return _Judged((math.nan,) * 6, (("path_points", "a path", error),))
    faults = []
    if path is None and len(points):
        faults.append(("path_points", f"{len(points)} numbers", "none without a curve"))
    for end, place in zip(("start", "target"), curves.ends(curve) if path else ()):
        point = tuple(path.points[place].tolist())
        if point != getattr(problem, end):
            faults.append((f"path_points ({end})", point, getattr(problem, end)))
    return _Judged((length, *check[:5]), tuple(faults))


# --------------------------------------------------------------------------------------------------
# Drives


class _Trace(NamedTuple):
    """points: (steps + 1, 2) the places at step 0, 1, ... and at the end. clearance: (steps,)."""

    points: np.ndarray
    clearance: np.ndarray


def _traces(file: str) -> dict[str, _Trace]:
    beside = str(File(file).with_suffix(".traces.parquet"))
    table = rows.read(beside)
    x, y, clearance = (_column(beside, table, name, "list") for name in ("x", "y", "clearance"))
    if not all(
        len(one) == len(other) > len(least) > 0 for one, other, least in zip(x, y, clearance)
    ):
        raise rows.misplaced(
            beside,
            "columns x, y and clearance: expected as many x as y, and one number less of clearance",
        )
    return {
        name: _Trace(np.column_stack(points), least)
        for name, *points, least in zip(_column(beside, table, "id", "word"), x, y, clearance)
    }


def _drive_faults(
    chunks: list[_Chunk], made: dict[str, Problem], moving: dict[str, World]
) -> Iterator[Fault]:
    """What of drives differs from what their ways and their traces say. Obstacles at whole steps
    are placed once for each problem.
    """
    traces = [_traces(chunk.file) for chunk in chunks]
    steps = max((len(each.clearance) for of in traces for each in of.values()), default=0)
    distances = cache(lambda name: _distances(moving[name], steps))
    for chunk, drives in zip(chunks, traces):
        measured = np.full((len(chunk["id"]), 5), math.nan)
        for row, (run, name, flat) in enumerate(
            zip(chunk["id"], chunk["problem"], chunk["path_points"])
        ):
            if run not in drives:
                yield Fault(chunk.file, run, "id", "a drive", "no trace of that id")
            elif name in made:
                points, ends = flat.reshape(-1, 2), (made[name].start, made[name].target)
                measured[row] = (
                    np.hypot(*np.diff(points, axis=0).T).sum(),
                    (tuple(points[0].tolist()), tuple(points[-1].tolist())) == ends,
                    drives[run].clearance.min(),
                    distances(name)(drives[run].points),
                    moving[name].pace,
                )
        length, joins, least, deepest, pace = measured.T
        arrival, clearance_least = chunk["arrival"], chunk["clearance_least"]
        arrived, low = ~np.isnan(arrival), np.minimum(clearance_least, 0.0) - _TRACE
        free = np.isnan(chunk["collision_at"]) & (deepest >= low)
        again = {
            "length": (length, _SAME),
            "travelled": (length, _SAME),
            "claimed_feasible": (arrived, 0.0),
            # What collides between two whole steps shows in `collision_at` alone.
            "feasible": (arrived & (joins == 1.0) & free, 0.0),
            "objective": (np.where(arrived, arrival * pace, math.inf), _SAME),
            "clearance": (np.maximum(clearance_least, 0.0), _SAME),
            "clearance_least": (least, _TRACE),
        }
        yield from _differing(chunk, again)


def _distances(world: World, steps: int) -> Callable[[np.ndarray], float]:
    """A function that gives, of places (n + 1, 2) at step 0, 1, ..., up to some number of steps,
    and at the end, the least distance to an obstacle or the border at whole steps, in units,
    negative inside; of cells -inf inside one, or inf.
    """
    if isinstance(world, MovingCircles):
        centres = np.array([world.at(step) for step in range(steps)]).reshape(steps, -1, 2)
        low, high = np.reshape(world.bounds, (2, 2)).T

        def least(points: np.ndarray) -> float:
            at = points[:-1]
            away = np.hypot(*(centres[: len(at)] - at[:, None]).T).T - world.radii
            return float(min(away.min(initial=math.inf), (at - low).min(), (high - at).min()))

        return least
    maps = [walled(each.occupied) for each in world.maps]
    index = np.searchsorted(world.moments, np.arange(steps), side="right")

    def outside(points: np.ndarray) -> float:
        numbers = index[: len(points) - 1]
        inside = any(
            _inside(maps[n], world.maps[n], points[:-1][numbers == n]) for n in np.unique(numbers)
        )
        return -math.inf if inside else math.inf

    return outside


def _inside(cells: np.ndarray, grid: Grid, points: np.ndarray) -> bool:
    """Whether any of some points (n, 2), in units, lies in occupied cells or outside, by more than
    the tolerance of a trace.

    Such a point lies in no free cell, nor at the edge or corner of one. cells: those of the grid,
    `walled`.
    """
    shifts = np.array([[-_TRACE, -_TRACE], [-_TRACE, _TRACE], [_TRACE, -_TRACE], [_TRACE, _TRACE]])
    near = np.floor(grid.in_cells(points[:, None] + shifts)).astype(int) + 1
    column, row = (np.clip(near[..., axis], 0, cells.shape[1 - axis] - 1) for axis in (0, 1))
    return bool(cells[row, column].all(axis=1).any())


# --------------------------------------------------------------------------------------------------
# Bounds


def _bounds_judged(task: Task, made: dict[str, Problem], moving: dict[str, World]) -> Verdict:
    kept = rows.read(task.bounds)
    again = rides.bounds_of(made, moving) if moving else problems.bounds_of(made)
    for field in again.schema:
        kind = next(kind for kind, (_, fits) in _TYPES.items() if fits(field.type))
        _column(task.bounds, kept, field.name, kind)
    stored = {row["problem"]: row for row in kept.to_pylist()}
    faults = [
        Fault(task.bounds, name, "problem", name, "no problem of that name")
        for name in stored.keys() - made.keys()
    ]
    for row in again.to_pylist():
        faults += _bound_faults(task.bounds, stored.get(row["problem"]), row)
    return Verdict(faults, 0, 0, 0, len(again), 0, ())


def _bound_faults(file: str, stored: dict[str, Any] | None, row: dict[str, Any]) -> Iterator[Fault]:
    if stored is None:
        yield Fault(file, row["problem"], "problem", "nothing", row["problem"])
        return
    for name, value in row.items():
        if name != "problem":
            one, other = (
                np.atleast_1d(np.array(each, dtype=float)) for each in (stored[name], value)
            )
            if len(one) != len(other) or not same(one, other, _SAME).all():
                yield Fault(file, row["problem"], name, stored[name], value)
