"""The runs that the viewer shows: some feasible and some failed runs of each method, on each
problem and in an experiment as a whole. The page's script reads them as JSON.

Runs are ranked by their length over the exact bound of their problem, so that those on different
problems compare.
"""

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.compute as compute
import pyarrow.parquet as parquet

from bezierplan.analysis import results
from bezierplan.figures.page.page_job import ExperimentView
from bezierplan.geometry import curves
from bezierplan.running import problems as problem_files
from bezierplan.running.columns import Row
from bezierplan.running.inputs import Files
from bezierplan.workspaces import files, worlds
from bezierplan.workspaces.limits import Bounds
from bezierplan.workspaces.problem import Problem

# An experiment with more problems than this is shown as a whole only; and so many failed runs of a
# method are shown.
MOST_PROBLEMS, MOST_FAILED = 8, 2
# Points along a path are left out where the path stays within this share of the workspace's longer
# side. At most so many steps of history.
_FLAT, _MOST_STEPS = 7e-4, 80


_RANKED = ["id", "problem", "method", "repeat", "feasible", "length"]
_DRAWN = [
    *("claimed_feasible", "collision_at", "collision_depth", "clearance"),
    *("evaluations", "stop", "history", "path_curve", "path_points"),
]


def choose_runs(
    study: str, experiment: str, content: ExperimentView, inputs: Files
) -> tuple[list[Row], Row]:
    """Choose the runs of an experiment that the viewer shows.

    Returns which runs these are, by method and problem; and `runs` and `problems` by name. All
    other runs give only their lengths.
    """
    bounds = parquet.read_table(inputs.bounds).to_pandas().set_index("problem")
    columns = [*_RANKED, *_DRAWN, *(["steps"] if content.moves else [])]
    table = pa.concat_tables(parquet.read_table(file, columns=columns) for file in inputs.chunks)
    ranking = table.select(_RANKED).to_pandas()
    ranking = ranking[
        (ranking["repeat"] < content.repeats) & ranking["method"].isin(content.methods)
    ]
    ranking["gap"] = ranking["length"] / ranking["problem"].map(bounds["bound"]) - 1
    groups = [("", ranking)]
    if len(bounds) <= MOST_PROBLEMS:
        groups = [*ranking.groupby("problem", sort=False), *(groups if len(bounds) > 1 else [])]
    choice = []
    for problem, runs in groups:
        by_method = dict(iter(runs.groupby("method", sort=False)))
        choice += [
            _choose_runs_of_method(experiment, problem, method, by_method[method])
            for method in content.methods
            if method in by_method
        ]
    # Histories and points are taken from the table for these runs alone.
    ids = [
        name
        for each in choice
        for name in (each["best"], each["median"], each["worst"], *each["failed"])
        if name
    ]
    rows = table.filter(compute.is_in(table["id"], pa.array(ids, pa.string()))).to_pandas()
    made, moving = problem_files.read(inputs.problems)
    by_name = {row["id"]: row for row in rows.to_dict("records")}
    traces = _read_traces(inputs.chunks if content.moves else [], list(by_name))
    prefix = f"{study}/{experiment}/"
    runs = {
        name: _describe_run(row, made[row["problem"]].workspace.bounds, prefix + row["problem"])
        for name, row in by_name.items()
    }
    for name, trace in traces.items():
        row = by_name[name]
        runs[name] |= _describe_drive(runs[name]["path"], trace, row, moving[row["problem"]].pace)
    problems = {
        prefix + name: _describe_problem(made[name], moving.get(name), bounds.loc[name])
        for name in rows["problem"].unique()
    }
    return choice, {"runs": runs, "problems": problems}


def _read_traces(chunks: list[str], ids: list[str]) -> dict[str, np.ndarray]:
    """Read the places (steps + 1, 2) of some drives at step 0, 1, ... and at their end."""
    files = [Path(chunk).with_suffix(".traces.parquet") for chunk in chunks]
    tables = [
        parquet.read_table(file, columns=["id", "x", "y"], filters=[("id", "in", ids)])
        for file in files
    ]
    return {
        row["id"]: np.column_stack([row["x"], row["y"]])
        for table in tables
        for row in table.to_pylist()
    }


def _choose_runs_of_method(experiment: str, problem: str, method: str, runs: pd.DataFrame) -> Row:
    """Choose the best, the median, the worst and some failed runs of a method.

    gap: the median run's; None if no run is feasible.
    """
    feasible = runs[runs["feasible"]]
    # Much faster than pandas, which first numbers the ids.
    ordered = sorted(zip(feasible["gap"].fillna(np.inf), feasible["id"], strict=True))
    # Where no run is feasible, one without a name stands for all three.
    ordered = ordered or [(np.inf, None)]
    gap, median = ordered[(len(ordered) - 1) // 2]
    return {
        "experiment": experiment,
        "problem": problem,
        "method": method,
        "count": len(runs),
        "feasible": len(feasible),
        "gap": _round_finite(gap),
        "best": ordered[0][1],
        "median": median,
        "worst": ordered[-1][1],
        "failed": runs.loc[~runs["feasible"], "id"].tolist()[:MOST_FAILED],
    }


def _round_json(text: str) -> Row:
    """Return the content of JSON with numbers of seven digits."""
    return json.loads(text, parse_float=lambda number: float(f"{float(number):.7g}"))


def _describe_problem(problem: Problem, world: worlds.World | None, bound: pd.Series) -> Row:
    """Return a problem with its workspace as plain values, start, target and the exact shortest
    path (x0, y0, x1, y1, ...).
    """
    size = _measure_side(problem.workspace.bounds)
    path = np.reshape(bound["bound_path"], (-1, 2)).astype(float)
    return {
        "workspace": _round_json(files.write_json(problem.workspace))
        | {"bounds": list(problem.workspace.bounds)},
        "world": None if world is None else _describe_world(world),
        "start": problem.start,
        "target": problem.target,
        "bound": _round_finite(bound["bound"]),
        "bound_path": _round_points(_reduce_points(path, _FLAT * size), size),
    }


def _describe_world(world: worlds.World) -> Row:
    """Return how obstacles move, with time in steps.

    Circles have x, y, velocities and radius, and walls reflect their centres. Cells change at some
    moments; they are counted row by row from the top left one.
    """
    if isinstance(world, worlds.MovingCircles):
        content = _round_json(worlds.to_json(world))
        return {"walls": list(world.walls), "circles": content["circles"]}
    changed = [
        np.flatnonzero(before.occupied[::-1] != after.occupied[::-1]).tolist()
        for before, after in pairwise(world.maps)
    ]
    return {"circles": [], "moments": world.moments.tolist(), "changed": changed}


def _describe_drive(path: list[float], trace: np.ndarray, row: Row, pace: float) -> Row:
    """Return the additions to a run that is a drive, such as the distance along its path at each
    step.

    The place of its first collision is the robot's place at that time.
    """
    size = float(np.ptp(trace, axis=0).max()) or 1.0
    steps, collision = float(row["steps"]), None
    if np.isfinite(row["collision_at"]):
        times = np.append(np.arange(len(trace) - 1), steps)
        collision = [float(np.interp(row["collision_at"], times, along)) for along in trace.T]
    return {
        "control": [],
        "driven": _round_points(_measure_way(np.reshape(path, (-1, 2)), trace, pace), size),
        "steps": steps,
        "collision": collision,
        "collision_step": _round_finite(row["collision_at"]),
    }


def _measure_way(path: np.ndarray, trace: np.ndarray, pace: float) -> np.ndarray:
    """Return the length of the way (n,) along a path (m, 2) at each place (n, 2) of a drive on it.

    pace: the longest way from one place to the next. A way may cross itself, so each place is
    searched for only within a pace of the one before.
    """
    import shapely
    from shapely.ops import substring

    # shapely knows no line of a single point.
    line = shapely.LineString(path if len(path) > 1 else np.repeat(path, 2, axis=0))
    distances = [0.0]
    for place in shapely.points(trace[1:].astype(float)):
        ahead = substring(line, distances[-1], distances[-1] + pace)
        step = shapely.line_locate_point(ahead, place) if ahead.length > 0 else 0.0
        distances.append(distances[-1] + step)
    return np.array(distances)


def _describe_run(row: Row, bounds: Bounds, problem: str) -> Row:
    """Return a run with its points rounded to the resolution of the picture.

    claimed: the planner's own verdict.
    """
    from bezierplan.figures.panels.paths import sample_path

    path, size = results.build_path(row), _measure_side(bounds)
    collides = path is not None and not row["feasible"] and np.isfinite(row["collision_at"])
    return {
        "problem": problem,
        "feasible": bool(row["feasible"]),
        "claimed": bool(row["claimed_feasible"]),
        "length": _round_finite(row["length"]),
        "clearance": _round_finite(row["clearance"]),
        # In a drive `collision_at` is a time: `_describe_drive` finds the place.
        "collision": curves.point_at(path, row["collision_at"]).tolist()
        if collides and "steps" not in row
        else None,
        "depth": _round_finite(row["collision_depth"]),
        "evaluations": int(row["evaluations"]),
        "stop": str(row["stop"]),
        "curve": row["path_curve"] or "",
        "path": []
        if path is None
        else _round_points(_reduce_points(sample_path(path), _FLAT * size), size),
        # Points of this curve are tangents too, and bend it otherwise.
        "control": []
        if path is None or path.curve == "ferguson"
        else _round_points(path.points, size),
        "history": _reduce_history(row["history"]),
        "steps": None,
    }


def _measure_side(bounds: Bounds) -> float:
    """Return the length of the longer side of a workspace."""
    return max(bounds[1] - bounds[0], bounds[3] - bounds[2])


def _round_finite(value: float) -> float | None:
    """Return a number of seven digits, or None for one that is missing or infinite."""
    return float(f"{value:.7g}") if value is not None and np.isfinite(value) else None


def _round_points(points: np.ndarray, size: float) -> list[float]:
    """Return points (n, 2) as x0, y0, ..., rounded to a ten-thousandth of the workspace."""
    decimals = max(0, 4 - int(np.floor(np.log10(size))))
    return np.round(points, decimals).ravel().tolist()


def _reduce_points(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Return as few points of a line (n, 2) as keep within a tolerance of it."""
    import shapely

    return (
        shapely.get_coordinates(shapely.simplify(shapely.LineString(points), tolerance))
        if len(points) > 1
        else points
    )


def _reduce_history(history: np.ndarray) -> list[tuple[int, float]]:
    """Return (generation, objective) at each change of the best objective and at the end, at most
    `_MOST_STEPS`.
    """
    values = np.asarray(history, dtype=float)
    known = np.flatnonzero(np.isfinite(values))
    turns = known[np.diff(values[known], prepend=np.nan) != 0]
    if len(turns) > _MOST_STEPS:
        turns = turns[np.unique(np.linspace(0, len(turns) - 1, _MOST_STEPS).astype(int))]
    return [(int(at), float(f"{values[at]:.6g}")) for at in np.union1d(turns, known[-1:])]
