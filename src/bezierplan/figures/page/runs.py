"""The runs that the viewer shows: of each method on each problem, and on all of an experiment, some of the feasible and the failed.

Runs are ranked by their length over the exact bound of their problem, so that those on different problems compare.
"""

import json
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import pyarrow.parquet as parquet

from bezierplan.analysis import results
from bezierplan.figures.page import content
from bezierplan.geometry import curves
from bezierplan.running import problems as problem_files
from bezierplan.workspaces import files
from bezierplan.workspaces.problem import Path, Problem

# An experiment with more problems than this is shown as a whole only. Failed runs shown of a method.
MOST_PROBLEMS, MOST_FAILED = 8, 2
# Points along a path are left out where the path stays within this share of the workspace's longer side. At most so many steps of history.
_FLAT, _MOST_STEPS = 5e-4, 80


_RANKED = ["id", "problem", "method", "repeat", "feasible", "length"]
_DRAWN = ["claimed_feasible", "collision_at", "collision_depth", "clearance", "evaluations", "stop", "history", "path_curve", "path_points"]


class Chosen(NamedTuple):
    """What the viewer shows of an experiment."""

    shown: list[content.Shown]
    runs: dict[str, content.Run]
    problems: dict[str, content.Problem]


def chosen(study: str, experiment: str, described: dict[str, Any]) -> Chosen:
    """The runs of an experiment that the viewer shows.

    described: `methods`, those that are shown; `repeats`; and the files `runs`, `problems` and `bounds`. Of the runs that are not shown
    only the lengths are kept.
    """
    bounds = parquet.read_table(described["bounds"]).to_pandas().set_index("problem")
    tables = {file: parquet.read_table(file, columns=[*_RANKED, *_DRAWN]) for file in described["runs"]}
    ranked = pd.concat([table.select(_RANKED).to_pandas().assign(file=file) for file, table in tables.items()])
    ranked = ranked[(ranked["repeat"] < described["repeats"]) & ranked["method"].isin(described["methods"])]
    ranked["gap"] = ranked["length"] / ranked["problem"].map(bounds["bound"]) - 1
    groups = [("", ranked)]
    if len(bounds) <= MOST_PROBLEMS:
        groups = [*ranked.groupby("problem", sort=False), *(groups if len(bounds) > 1 else [])]
    shown = [
        _shown(experiment, problem, method, of_method)
        for problem, runs in groups
        for method in described["methods"]
        if not (of_method := runs[runs["method"] == method]).empty
    ]
    named = {name for each in shown for name in (each.best, each.median, each.worst, *each.failed) if name}
    kept = [_drawn(tables[file], rows.index) for file, rows in ranked[ranked["id"].isin(named)].groupby("file", sort=False)]
    rows = pd.concat(kept) if kept else ranked
    made = problem_files.read(described["problems"])
    prefix = f"{study}/{experiment}/"
    runs = {row["id"]: _run(row, made[row["problem"]].workspace.bounds, prefix + row["problem"]) for _, row in rows.iterrows()}
    problems = {prefix + name: _problem(made[name], bounds.loc[name]) for name in rows["problem"].unique()}
    return Chosen(shown, runs, problems)


def _drawn(table: Any, rows: pd.Index) -> pd.DataFrame:
    """Some rows of a table of runs, whole."""
    return table.take(rows.to_list()).to_pandas()


def _shown(experiment: str, problem: str, method: str, runs: pd.DataFrame) -> content.Shown:
    ordered = runs[runs["feasible"]].sort_values(["gap", "id"], kind="stable")["id"].tolist()
    failed = runs.loc[~runs["feasible"], "id"].tolist()[:MOST_FAILED]
    best, median, worst = (ordered[0], ordered[(len(ordered) - 1) // 2], ordered[-1]) if ordered else (None, None, None)
    number = {"count": len(runs), "feasible": len(ordered)}
    return content.Shown(
        experiment=experiment, problem=problem, method=method, **number, best=best, median=median, worst=worst, failed=failed
    )


def _problem(problem: Problem, bound: pd.Series) -> content.Problem:
    size = _size(problem.workspace.bounds)
    path = np.asarray(bound["bound_path"], dtype=float)
    shapes = json.loads(files.to_json(problem.workspace), parse_float=lambda text: float(f"{float(text):.7g}"))
    return content.Problem(
        workspace=shapes | {"bounds": list(problem.workspace.bounds)},
        start=problem.start,
        target=problem.target,
        bound=float(bound["bound"]) if np.isfinite(bound["bound"]) else None,
        bound_path=_rounded(path.reshape(-1, 2), size),
    )


def _run(row: pd.Series, bounds: tuple[float, float, float, float], problem: str) -> content.Run:
    path, size = results.path_of(row), _size(bounds)
    collision = None
    if path is not None and not row["feasible"] and np.isfinite(row["collision_at"]):
        collision = tuple(float(value) for value in curves.point_at(path, row["collision_at"]))
    return content.Run(
        problem=problem,
        feasible=bool(row["feasible"]),
        claimed=bool(row["claimed_feasible"]),
        length=_finite(row["length"]),
        clearance=_finite(row["clearance"]),
        collision=collision,
        depth=_finite(row["collision_depth"]),
        evaluations=int(row["evaluations"]),
        stop=str(row["stop"]),
        curve=row["path_curve"] or "",
        path=[] if path is None else _rounded(_flattened(path, _FLAT * size), size),
        control=[] if path is None or path.curve == "ferguson" else _rounded(path.points, size),
        history=_history(row["history"]),
    )


def _size(bounds: tuple[float, float, float, float]) -> float:
    return max(bounds[1] - bounds[0], bounds[3] - bounds[2])


def _finite(value: float) -> float | None:
    return float(f"{value:.7g}") if value is not None and np.isfinite(value) else None


def _rounded(points: np.ndarray, size: float) -> list[float]:
    """Points (n, 2) as x0, y0, ..., to about a ten-thousandth of the workspace."""
    decimals = max(0, 4 - int(np.floor(np.log10(size))))
    return np.round(points, decimals).ravel().tolist()


def _flattened(path: Path, tolerance: float) -> np.ndarray:
    """Points (n, 2) along a path, as few as keep within a tolerance of it."""
    import shapely

    from bezierplan.figures.panels.paths import steps

    points = steps(path)
    return shapely.get_coordinates(shapely.simplify(shapely.LineString(points), tolerance)) if len(points) > 1 else points


def _history(history: np.ndarray) -> list[tuple[int, float]]:
    """Generation and objective where the best objective changes, and at the end; thinned out if there are many."""
    values = np.asarray(history, dtype=float)
    known = np.flatnonzero(np.isfinite(values))
    if not len(known):
        return []
    turns = known[np.flatnonzero(np.diff(values[known], prepend=np.nan) != 0)]
    if len(turns) > _MOST_STEPS:
        turns = turns[np.unique(np.linspace(0, len(turns) - 1, _MOST_STEPS).astype(int))]
    return [(int(at), float(f"{values[at]:.6g}")) for at in dict.fromkeys([*turns.tolist(), int(known[-1])])]
