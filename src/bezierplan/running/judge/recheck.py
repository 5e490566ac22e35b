"""Are the results of a scale what their own points say? Every stored path is judged again, every
bound computed again, and some runs are made again.

To judge, nothing here calls a planner: a path is read from its row, and judged on the workspace of
the file of problems, in a process that no planner was in. What no path determines, such as a
planner's objective, is covered by the digest of each file (`rows`), and by the runs that are made
again (`made_again`): of drives, so is their motion.
"""

import hashlib
import json
import math
import multiprocessing
import sys
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path as File
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from bezierplan.geometry import curves
from bezierplan.geometry.region import Region, region
from bezierplan.machine.digest import COMPUTING, library_version
from bezierplan.planners import is_file
from bezierplan.running import execution, problems, rows, worlds
from bezierplan.running.chunk import Chunk, Condition
from bezierplan.running.columns import Bound, DriveBound, DriveOutcome, Outcome, Planned
from bezierplan.running.guard import interface
from bezierplan.running.jobs.watchdog import end_with_parent
from bezierplan.running.judge import answer
from bezierplan.schema.words import plain
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import World

# Numbers of another platform or version may differ in the last bits, and places of a first
# collision a little more.
_SAME = 1e-9
_SAME_PLACE = 1e-6

MADE_AGAIN = 100
"""Of so many runs one is made again."""

# So many repeats of each condition, all alike, from a planner that draws random numbers, are no
# chance.
_ALIKE = 5


class Fault(NamedTuple):
    """A stored value that is not what follows. run: its id, a problem's name, or `all rows`."""

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
    """Files of runs of an experiment, each with the chunk that it is to hold; or, with a file of
    bounds, that file.
    """

    problems: str
    runs: dict[str, Chunk]
    bounds: str = ""


class Verdict(NamedTuple):
    """faults: in order of files. files, runs: how many files of runs, and rows in them. paths:
    different paths among these. bounds: how many were computed again. digests: a line for each file
    of runs.
    """

    faults: tuple[Fault, ...] = ()
    files: int = 0
    runs: int = 0
    paths: int = 0
    bounds: int = 0
    digests: tuple[str, ...] = ()

    @property
    def digest(self) -> str:
        """One for all files of runs."""
        return hashlib.sha256("\n".join(sorted(self.digests)).encode()).hexdigest()[:16]


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


def _mapped(function: Callable[[Any], Any], items: list[Any], processes: int) -> Iterator[Any]:
    """`map`, in processes beside this one if there are to be several, on Linux: elsewhere they
    would begin with a job's script anew.
    """
    if processes == 1 or sys.platform != "linux":
        yield from map(function, items)
        return
    with ProcessPoolExecutor(
        processes, multiprocessing.get_context("fork"), end_with_parent
    ) as pool:
        yield from pool.map(function, items)


def merged(verdicts: Iterable[Verdict]) -> Verdict:
    """Several verdicts as one."""
    whole = Verdict(*(sum(parts[1:], parts[0]) for parts in zip(Verdict(), *verdicts)))
    return whole._replace(faults=tuple(sorted(whole.faults, key=lambda fault: fault[:3])))


def sound(verdict: Verdict) -> dict[str, Any]:
    """What a verdict says, as plain values by name. Raises ValueError with a fault."""
    if verdict.faults:
        raise ValueError(
            f"{verdict.faults[0]} (one of {len(verdict.faults)} values that differ; delete the "
            "file and start again)"
        )
    return {name: value for name, value in verdict._asdict().items() if name != "faults"}


def write(content: dict[str, Any], file: str) -> None:
    """Write plain values as JSON."""
    File(file).write_text(json.dumps(content, indent=1) + "\n")


def sha256(file: File) -> str:
    """The digest of a file; empty if it is not there."""
    return hashlib.sha256(file.read_bytes()).hexdigest() if file.is_file() else ""


def versions() -> dict[str, str]:
    """The libraries that compute, with their versions."""
    return {name: library_version(name) for name in COMPUTING}


def _problems(file: str) -> tuple[dict[str, Problem], dict[str, World]]:
    try:
        return problems.read(file), worlds.read(file)
    except (OSError, pa.ArrowException, KeyError, TypeError, ValueError):
        raise rows.misplaced(file, "not a whole file of problems") from None


def judged(task: Task) -> Verdict:
    """The verdict on a task. Raises ValueError for a file that is not the table to be there."""
    made, moving = _problems(task.problems)
    if task.bounds:
        return _bounds_judged(task.bounds, made, moving)
    faults, files, lines = [], {}, []
    for file, chunk in task.runs.items():
        if not chunk.problems.keys() <= made.keys():
            raise rows.misplaced(task.problems, "not of the problems that the runs are of")
        table = _table(file, chunk)
        digest = rows.rows_digest(table)
        lines.append(f"{'/'.join(File(file).parts[-5:])} {digest}")
        of_file = [
            Fault(file, "all rows", "digest", kept or "none: another program wrote it", digest)
            for kept in [rows.kept_digest(table)]
            if kept != digest
        ] or [*_identity_faults(file, table, chunk)]
        faults += of_file
        files |= {} if of_file else {file: table}
    known: dict[tuple[str, str, bytes], _Judged] = {}
    for file, table in files.items():
        faults += (
            _drive_faults(file, table, made, moving)
            if moving
            else _path_faults(file, table, made, known)
        )
    faults += _alike(files, task.runs)
    runs = sum(map(len, files.values()))
    return Verdict(tuple(faults), len(task.runs), runs, len(known), 0, tuple(lines))


def _table(file: str, chunk: Chunk) -> pa.Table:
    """The runs of a file. Raises ValueError for one without their columns."""
    table = rows.read(file)
    declared = (Planned, Outcome, *([DriveOutcome] if chunk.policy else []))
    if fault := rows.fault(table.schema, *declared):
        raise rows.misplaced(file, fault)
    return table


def _runs(chunk: Chunk) -> list[tuple[Condition, int]]:
    """The condition and repeat of each row of a chunk, in order."""
    return [(each, repeat) for each in chunk.conditions() for repeat in range(*chunk.repeats)]


def _identity_faults(file: str, table: pa.Table, chunk: Chunk) -> Iterator[Fault]:
    """Whether a file has the rows that it is to have, and what is known before their runs."""
    planned = [execution.identity(chunk, *each) for each in _runs(chunk)]
    if len(table) != len(planned):
        yield Fault(file, "all rows", "id", f"{len(table)} rows", f"{len(planned)} rows")
        return
    known = rows.table(planned, Planned).to_pydict()
    # What a run finds out takes the place of a setting of that name.
    for name, values in ((name, known[name]) for name in known.keys() - {*Outcome._fields}):
        stored = table[name].to_pylist() if name in table.column_names else [None] * len(table)
        for row, one, other in zip(planned, stored, values):
            if one != other:
                yield Fault(file, row["id"], name, one, other)


def _alike(files: dict[str, pa.Table], chunks: dict[str, Chunk]) -> Iterator[Fault]:
    """A planner of its author's own that is said to draw random numbers, but whose repeats are all
    alike, on every condition.
    """
    first = next(iter(chunks.values()))
    if not files or not is_file(first.planner) or interface.traits(first.planner).deterministic:
        return
    names = ["condition", "repeat", "history", "path_points"]
    every = [row for table in files.values() for row in table.select(names).to_pylist()]
    by_condition: dict[str, list[str]] = {}
    for row in every:
        found = repr([row["history"], row["path_points"]])
        by_condition.setdefault(row["condition"], []).append(found)
    if all(len(each) >= _ALIKE and len(set(each)) == 1 for each in by_condition.values()):
        yield Fault(
            next(iter(files)),
            f"planner {first.planner}",
            "history, path_points",
            f"the same in all {len(every) // len(by_condition)} repeats",
            "another with each rng: a planner draws from the rng that it is given, or says "
            "deterministic = True",
        )


def _numbers(table: pa.Table, name: str) -> np.ndarray:
    return table[name].to_numpy().astype(float)


def _lists(table: pa.Table, name: str) -> list[np.ndarray]:
    column = table[name].combine_chunks()
    return np.split(column.flatten().to_numpy(), np.cumsum(column.value_lengths().to_numpy())[:-1])


def _differing(
    file: str, table: pa.Table, again: dict[str, tuple[np.ndarray, Any]]
) -> Iterator[Fault]:
    """Values of a file that differ from those computed again, by column, with its tolerance."""
    for name, (values, tolerance) in again.items():
        stored = _numbers(table, name)
        for row in np.flatnonzero(~same(stored, values, tolerance)):
            before, after = table[name][row].as_py(), float(values[row])
            yield Fault(
                file,
                table["id"][row].as_py(),
                name,
                before,
                bool(after) if isinstance(before, bool) else after,
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
# Paths and drives


class _Judged(NamedTuple):
    """What the points of a path say. verdict: length, feasible, collision_at, depth, clearance,
    tolerance. faults: column, stored value, and what would be right.
    """

    verdict: tuple[float, ...]
    faults: tuple[tuple[str, Any, Any], ...]


def _path_faults(
    file: str,
    table: pa.Table,
    made: dict[str, Problem],
    known: dict[tuple[str, str, bytes], _Judged],
) -> Iterator[Fault]:
    """What of runs differs from what their points say. known: what different paths say."""
    verdicts = np.full((len(table), 6), math.nan)
    words = (table[name].to_pylist() for name in ("id", "problem", "path_curve"))
    for row, (run, name, curve, points) in enumerate(zip(*words, _lists(table, "path_points"))):
        key = name, curve, points.tobytes()
        if key not in known:
            known[key] = _path_judged(curve, points, made[name], region(made[name].workspace))
        verdicts[row], faults = known[key]
        yield from (Fault(file, run, *fault) for fault in faults)
    length, feasible, collision_at, depth, clearance, tolerance = verdicts.T
    slack = 2 * np.nan_to_num(tolerance) + _SAME
    again = {
        "length": (length, _SAME),
        "feasible": (feasible, 0.0),
        "collision_at": (collision_at, _SAME_PLACE),
        "collision_depth": (depth, slack),
        "clearance": (clearance, slack),
        "clearance_error": (tolerance, slack),
        "generations": (np.array([len(each) - 1.0 for each in _lists(table, "history")]), 0.0),
    }
    yield from _differing(file, table, again)


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


def _drive_faults(
    file: str, table: pa.Table, made: dict[str, Problem], moving: dict[str, World]
) -> Iterator[Fault]:
    """What of drives differs from what their ways say."""
    measured = np.full((len(table), 3), math.nan)
    for row, (name, flat) in enumerate(
        zip(table["problem"].to_pylist(), _lists(table, "path_points"))
    ):
        points, ends = flat.reshape(-1, 2), (made[name].start, made[name].target)
        measured[row] = (
            np.hypot(*np.diff(points, axis=0).T).sum(),
            (tuple(points[0].tolist()), tuple(points[-1].tolist())) == ends,
            moving[name].pace,
        )
    length, joins, pace = measured.T
    arrival, least = _numbers(table, "arrival"), _numbers(table, "clearance_least")
    arrived, free = ~np.isnan(arrival), np.isnan(_numbers(table, "collision_at"))
    again = {
        "length": (length, _SAME),
        "travelled": (length, _SAME),
        "claimed_feasible": (arrived, 0.0),
        "feasible": (arrived & (joins == 1.0) & free, 0.0),
        "objective": (np.where(arrived, arrival * pace, math.inf), _SAME),
        "clearance": (np.maximum(least, 0.0), _SAME),
    }
    yield from _differing(file, table, again)


# --------------------------------------------------------------------------------------------------
# Bounds


def _bounds_judged(file: str, made: dict[str, Problem], moving: dict[str, World]) -> Verdict:
    kept = rows.read(file)
    if fault := rows.fault(kept.schema, Bound, *([DriveBound] if moving else [])):
        raise rows.misplaced(file, fault)
    again = worlds.bounds_of(made, moving)
    stored = {row["problem"]: row for row in kept.to_pylist()}
    faults = []
    for row in again.to_pylist():
        name, own = row["problem"], stored.pop(row["problem"], {})
        for column, value in row.items():
            if column != "problem" and not _alike_numbers(own.get(column), value):
                faults.append(Fault(file, name, column, own.get(column), value))
    faults += [Fault(file, name, "problem", name, "no problem of that name") for name in stored]
    return Verdict(tuple(faults), bounds=len(again))


def _alike_numbers(one: Any, other: Any) -> bool:
    """Whether two numbers, or two lists of them, are the same up to a tolerance."""
    stored, again = (np.atleast_1d(np.array(each, dtype=float)) for each in (one, other))
    return len(stored) == len(again) and bool(same(stored, again, _SAME).all())


# --------------------------------------------------------------------------------------------------
# Runs made again


def made_again(
    tasks: list[Task], processes: int, digest: str, every: bool
) -> tuple[int, list[Fault]]:
    """How many runs were made again, and what of them differs from their rows in any bit: one in
    `MADE_AGAIN`, which a digest chooses, or all.
    """
    share = 1 if every else MADE_AGAIN
    chunks = [
        (task.problems, file, chunk, digest, share)
        for task in tasks
        for file, chunk in task.runs.items()
    ]
    found = [*_mapped(_again, chunks, processes)]
    return sum(number for number, _ in found), [fault for _, faults in found for fault in faults]


def _again(chosen: tuple[str, str, Chunk, str, int]) -> tuple[int, list[Fault]]:
    """`made_again` of a file."""
    problem_file, file, chunk, digest, share = chosen
    numbers = [
        n
        for n, run in enumerate(_runs(chunk))
        if int(hashlib.sha256(f"{digest} {execution.run_id(chunk, *run)}".encode()).hexdigest(), 16)
        % share
        == 0
    ]
    if not numbers:
        return 0, []
    made, moving = _problems(problem_file)
    remade = execution.rows_again(chunk, [_runs(chunk)[n] for n in numbers], made, moving)
    faults = []
    for row, stored in zip(remade, rows.read(file).take(numbers).to_pylist()):
        for name, value in rows.table([row], Planned, Outcome).to_pylist()[0].items():
            # The text of a number tells all its bits, and unlike it a NaN is equal to itself.
            if repr(value) != repr(stored.get(name)):
                faults.append(Fault(file, row["id"], name, stored.get(name), value))
    return len(numbers), faults
