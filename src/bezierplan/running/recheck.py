"""Are the results of a scale what their own points say? Every stored path is judged again, every bound computed again.

Nothing here calls a planner: a path is read from its row, and judged on the workspace of the file of problems, in a process that no planner
was in. What no path determines, such as a planner's objective, is covered by the digest of each file (`rows`).

Of drives, rows keep the way driven without its times, and traces keep places at whole steps, in single precision. So their lengths and
the agreement of their columns are checked, and that no place at a whole step lies in an obstacle of a drive that is said to be free.
"""

import hashlib
import json
import math
import multiprocessing
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path as File
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet

from bezierplan.geometry import checker, curves
from bezierplan.geometry.region import Region, blocks, region
from bezierplan.running import answer, problems, rides, rows, worlds
from bezierplan.running.digest import COMPUTING, library_version
from bezierplan.running.log import end_with_parent
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import MovingCircles, World

# Numbers of another platform or version may differ in the last bits, and places of a first collision a little more.
_SAME = 1e-9
_SAME_PLACE = 1e-6
# Places of traces are in single precision; of a field of 100 units they are this exact.
_TRACE = 1e-3


class Fault(NamedTuple):
    """A stored value that differs from what follows from the points. run: its id, or the name of a problem, or `all rows`."""

    file: str
    run: str
    column: str
    stored: Any
    recomputed: Any

    def __str__(self) -> str:
        return " ".join(f"{self.file}: {self.run}: {self.column}: stored {self.stored}, recomputed {self.recomputed}".split())


class Task(NamedTuple):
    """The files of one method in one experiment, or the bounds of an experiment without runs."""

    problems: str
    bounds: str
    runs: tuple[str, ...]


class Verdict(NamedTuple):
    """faults: in order of files. files, runs: how many files of runs, and rows in them. paths: different paths among these. bounds: how
    many were computed again. undigested: files without a digest of their own. digest: of all files of runs.
    """

    faults: list[Fault]
    files: int
    runs: int
    paths: int
    bounds: int
    undigested: int
    digest: str


def tasks(folder: File) -> list[Task]:
    """What there is to check below the folder of a scale. Raises FileNotFoundError if there is no table of runs or of problems."""
    found = []
    for bounds in sorted(folder.glob("*/problems/*.bounds.parquet")):
        found.append(Task(str(bounds).removesuffix(".bounds.parquet") + ".parquet", str(bounds), ()))
    methods: dict[File, list[str]] = {}
    for file in sorted(folder.rglob("runs/*/*/*.parquet")):
        if file.stem.isdecimal():  # not the times and traces next to it
            methods.setdefault(file.parent, []).append(str(file))
    if not methods:
        raise FileNotFoundError(f"{folder}: no runs here; expected a folder of results, such as results/full")
    for method, files in methods.items():
        found.append(Task(str(_problems_of(method, folder)), "", tuple(files)))
    return found


def _problems_of(method: File, folder: File) -> File:
    """The file of the problems of a method's runs; at `extended` an experiment may be that of `full`."""
    study, experiment = method.relative_to(folder).parts[0], method.parent.name
    places = [scale / study / "problems" / f"{experiment}.parquet" for scale in (folder, folder.parent / "full")]
    there = next((place for place in places if place.is_file()), None)
    if there is None:
        raise FileNotFoundError(f"{places[0]}: missing; expected the problems of {method}")
    return there


def verify(given: list[Task], processes: int, told: Callable[[str], None] = lambda line: None) -> Verdict:
    """The verdict on some tasks, in several processes. told: gets a line of progress now and then."""
    # The largest first, so that no process ends long after the others.
    largest = sorted(given, key=lambda task: -sum(os.path.getsize(file) for file in task.runs or (task.problems,)))
    done = []
    for n, each in enumerate(_mapped(judged, largest, processes), start=1):
        done.append(each)
        if n % 20 == 0 or n == len(given):
            told(f"{n} of {len(given)} tables checked, {sum(len(verdict.faults) for verdict in done)} faults")
    return merged(done)


def _mapped(function: Callable[[Task], Verdict], given: list[Task], processes: int) -> Iterator[Verdict]:
    """`map`, in processes beside this one if there are to be several, on Linux: elsewhere they would begin with a job's script anew."""
    if processes == 1 or sys.platform != "linux":
        yield from map(function, given)
        return
    with ProcessPoolExecutor(processes, multiprocessing.get_context("fork"), end_with_parent) as pool:
        yield from pool.map(function, given)


def merged(verdicts: Iterable[Verdict]) -> Verdict:
    """Several verdicts as one."""
    all_of = list(verdicts)
    digest = hashlib.sha256("\n".join(sorted(each.digest for each in all_of)).encode()).hexdigest()[:16]
    counts = (sum(getattr(each, name) for each in all_of) for name in Verdict._fields[1:-1])
    return Verdict(sorted(fault for each in all_of for fault in each.faults), *counts, digest)


def write(verdict: Verdict, file: str) -> None:
    """Write what was checked, and with which versions, as JSON. Raises ValueError with the first fault if there is any."""
    if verdict.faults:
        raise ValueError(f"{verdict.faults[0]} (one of {len(verdict.faults)} values that differ; delete the file and start again)")
    counts = {name: getattr(verdict, name) for name in ("files", "runs", "paths", "digest")}
    File(file).write_text(json.dumps(counts | {"versions": versions()}, indent=1) + "\n")


def versions() -> dict[str, str]:
    """The libraries that compute, with their versions."""
    return {name: library_version(name) for name in COMPUTING}


def judged(task: Task) -> Verdict:
    """The verdict on one task. Raises ValueError for a file that is no table."""
    if task.bounds:
        return _bounds_judged(task)
    made, moving = problems.read(task.problems), worlds.read(task.problems)
    known: dict[str, tuple[Problem, Region]] = {}
    verdicts: dict[tuple, tuple[float, checker.Check]] = {}
    faults, count, undigested, digests, ids = [], 0, 0, [], set()
    for file in task.runs:
        table = _read(file)
        digest, kept = rows.rows_digest(table), rows.kept_digest(table)
        digests.append(f"{'/'.join(File(file).parts[-5:])} {digest}")
        undigested += kept is None
        if kept not in (None, digest):
            faults.append(Fault(file, "all rows", "digest", kept, digest))
        traces = _traces(file) if moving else {}
        for row in _rows(table):
            count += 1
            faults += _identity_faults(file, row, ids)
            if row["problem"] not in made:
                faults.append(Fault(file, row["id"], "problem", row["problem"], f"one of {task.problems}"))
            elif moving:
                faults += _drive_faults(file, row, made[row["problem"]], moving[row["problem"]], traces.get(row["id"]))
            else:
                faults += _path_faults(file, row, made[row["problem"]], known, verdicts)
    return Verdict(faults, len(task.runs), count, len(verdicts), 0, undigested, "\n".join(digests))


def _read(file: str) -> pa.Table:
    try:
        return parquet.read_table(file)
    except (OSError, pa.ArrowException):
        raise ValueError(f"{file}: not a whole Parquet file; delete it and start again: the workflow reproduces it") from None


# Columns of a row that are looked at; the others are covered by digests.
_SEEN = (
    *("id", "study", "experiment", "condition", "problem", "method", "repeat", "length", "claimed_feasible", "feasible", "collision_at"),
    *("collision_depth", "clearance", "clearance_error", "generations", "objective", "path_curve"),
    *("arrival", "travelled", "clearance_least"),
)


def _rows(table: pa.Table) -> Iterator[dict[str, Any]]:
    """The rows, with points as an array (n, 2), and the number of values of the history."""
    seen = table.select([name for name in _SEEN if name in table.column_names]).to_pylist()
    points = table["path_points"].combine_chunks()
    flat, lengths = points.flatten().to_numpy(), points.value_lengths().to_numpy()
    values = table["history"].combine_chunks().value_lengths().to_numpy()
    ends = np.cumsum(lengths)
    for row, begin, end, number in zip(seen, ends - lengths, ends, values, strict=True):
        yield row | {"path_points": flat[begin:end], "history": int(number)}


def _identity_faults(file: str, row: dict[str, Any], ids: set[str]) -> list[Fault]:
    """Whether a row stands in its file, and its id says what its columns say, once."""
    *_, experiment, method, _ = File(file).parts
    name = "/".join(str(row[part]) for part in ("study", "experiment", "condition", "method", "repeat"))
    found = []
    if row["id"] != name:
        found.append(Fault(file, row["id"], "id", row["id"], name))
    for column, place in (("experiment", experiment), ("method", method)):
        if row[column] != place:
            found.append(Fault(file, row["id"], column, row[column], place))
    if row["id"] in ids:
        found.append(Fault(file, row["id"], "id", "twice", "once"))
    ids.add(row["id"])
    return found


def _path_faults(
    file: str,
    row: dict[str, Any],
    problem: Problem,
    known: dict[str, tuple[Problem, Region]],
    verdicts: dict[tuple, tuple[float, checker.Check]],
) -> list[Fault]:
    """What of a run differs from what its points say."""
    if row["problem"] not in known:
        known[row["problem"]] = problem, region(problem.workspace)
    key = row["problem"], row["path_curve"], row["path_points"].tobytes()
    try:
        path = answer.restored(row["path_curve"], row["path_points"])
        if key not in verdicts:
            verdicts[key] = answer.verdict(path, known[row["problem"]][1])
    except ValueError as error:
        return [Fault(file, row["id"], "path_points", "a path", error)]
    length, check = verdicts[key]
    slack = 2 * check.tolerance + _SAME
    recomputed = {
        "length": (length, _SAME),
        "feasible": (check.feasible, 0.0),
        "collision_at": (check.collision_at, _SAME_PLACE),
        "collision_depth": (check.depth, slack),
        "clearance": (check.clearance, slack),
        "clearance_error": (check.tolerance, slack),
        "generations": (row["history"] - 1, 0.0),
    }
    found = [
        Fault(file, row["id"], name, row[name], value) for name, (value, least) in recomputed.items() if not same(row[name], value, least)
    ]
    if path is not None:
        found += _ends_faults(file, row, [path.points[place] for place in curves.ends(path.curve)], problem)
    return found


def _differing(file: str, row: dict[str, Any], recomputed: dict[str, tuple[Any, float]]) -> list[Fault]:
    """The columns of a row that differ from values that were computed again, given with their tolerance."""
    pairs = recomputed.items()
    return [Fault(file, row["id"], name, row[name], value) for name, (value, least) in pairs if not same(row[name], value, least)]


def _ends_faults(file: str, row: dict[str, Any], ends: Iterable[np.ndarray], problem: Problem) -> list[Fault]:
    pairs = zip(("start", "target"), ends, (problem.start, problem.target))
    return [Fault(file, row["id"], f"path_points ({end})", tuple(at.tolist()), to) for end, at, to in pairs if tuple(at.tolist()) != to]


def same(stored: Any, recomputed: Any, tolerance: float) -> bool:
    """Whether a stored value equals one that was computed again, up to a tolerance, relative and absolute; not a number equals itself."""
    if isinstance(recomputed, bool | np.bool_) or isinstance(stored, bool | str) or stored is None:
        return stored == recomputed and isinstance(stored, bool) == isinstance(recomputed, bool | np.bool_)
    if math.isnan(stored) or math.isnan(recomputed):
        return math.isnan(stored) and math.isnan(recomputed)
    return math.isclose(stored, recomputed, rel_tol=tolerance, abs_tol=tolerance)


# ---------------------------------------------------------------------------------------------------------------------
# Drives


class _Trace(NamedTuple):
    """points: (steps + 1, 2) the places at step 0, 1, ... and at the end. clearance: (steps,)."""

    points: np.ndarray
    clearance: np.ndarray


def _traces(file: str) -> dict[str, _Trace]:
    table = _read(str(File(file).with_suffix(".traces.parquet"))).select(["id", "x", "y", "clearance"]).to_pydict()
    columns = zip(table["id"], table["x"], table["y"], table["clearance"], strict=True)
    return {name: _Trace(np.column_stack([x, y]), np.array(clearance)) for name, x, y, clearance in columns}


def _drive_faults(file: str, row: dict[str, Any], problem: Problem, world: World, trace: _Trace | None) -> list[Fault]:
    """What of a drive differs from what its way and its trace say."""
    if trace is None:
        return [Fault(file, row["id"], "id", "a drive", "no trace of that id")]
    points = row["path_points"].reshape(-1, 2)
    length = float(np.hypot(*np.diff(points, axis=0).T).sum())
    joins = (tuple(points[0].tolist()), tuple(points[-1].tolist())) == (problem.start, problem.target)
    arrived, least = not math.isnan(row["arrival"]), float(trace.clearance.min())
    deepest = _least_distance(trace.points, world) if row["feasible"] else math.inf
    recomputed = {
        "length": (length, _SAME),
        "travelled": (length, _SAME),
        "claimed_feasible": (arrived, 0.0),
        "feasible": (arrived and joins and math.isnan(row["collision_at"]) and deepest >= min(row["clearance_least"], 0.0) - _TRACE, 0.0),
        "objective": (row["arrival"] * world.pace if arrived else math.inf, _SAME),
        "clearance": (max(row["clearance_least"], 0.0), _SAME),
        "clearance_least": (least, _TRACE),
    }
    return [
        Fault(file, row["id"], name, row[name], value) for name, (value, least) in recomputed.items() if not same(row[name], value, least)
    ]


def _least_distance(points: np.ndarray, world: World) -> float:
    """The least distance of a robot to an obstacle at whole steps, in units, negative inside one; of cells -inf inside one, or inf."""
    steps = range(len(points) - 1)
    if isinstance(world, MovingCircles):
        away = (np.hypot(*(world.at(step) - points[step]).T) - world.radii for step in steps)
        return float(min((each.min(initial=math.inf) for each in away), default=math.inf))
    seen = {world.index(step): region(world.workspace(step)) for step in steps}
    inside = any(blocks(seen[world.index(step)], tuple(points[step].tolist()), _TRACE) for step in steps)
    return -math.inf if inside else math.inf


# ---------------------------------------------------------------------------------------------------------------------
# Bounds


def _bounds_judged(task: Task) -> Verdict:
    made, moving = problems.read(task.problems), worlds.read(task.problems)
    again = (rides.bounds_of(made, moving) if moving else problems.bounds_of(made)).to_pylist()
    stored = {row["problem"]: row for row in _read(task.bounds).to_pylist()}
    faults = [Fault(task.bounds, name, "problem", name, "no problem of that name") for name in stored.keys() - made.keys()]
    for row in again:
        faults += _bound_faults(task.bounds, stored.get(row["problem"]), row)
    return Verdict(faults, 0, 0, 0, len(again), 0, "")


def _bound_faults(file: str, stored: dict[str, Any] | None, row: dict[str, Any]) -> list[Fault]:
    if stored is None:
        return [Fault(file, row["problem"], "problem", "nothing", row["problem"])]
    found = []
    for name, value in row.items():
        pairs = zip(stored[name], value) if isinstance(value, list) else [(stored[name], value)]
        alike = not isinstance(value, list) or len(stored[name]) == len(value)
        if not alike or not all(same(one, other, _SAME) if name != "problem" else one == other for one, other in pairs):
            found.append(Fault(file, row["problem"], name, stored[name], value))
    return found
