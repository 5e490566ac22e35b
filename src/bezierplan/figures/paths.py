"""The path of one picked run in its workspace, with its control points and the shortest path that there is."""

from typing import Any

import numpy as np
import pandas as pd
import shapely
from matplotlib.axes import Axes

from bezierplan import curves, style
from bezierplan.analysis.results import Results, path_of
from bezierplan.analysis.results import pick as pick_run
from bezierplan.figures import workspace as workspaces
from bezierplan.problem import Path

# About as many straight steps are drawn for a curve; the ends of its pieces are always among them.
_STEPS = 600

# In the order of the legend.
_LOOK = {
    "path": {**style.RUN_SHOWN, "label": "path", "zorder": 3},
    "control": {
        "color": style.BLUE,
        "linewidth": 0.7,
        "linestyle": (0, (4, 2)),
        "marker": "o",
        "markersize": 4.5,
        "markerfacecolor": style.FREE,
        "label": "control points and polygon",
        "zorder": 5,
    },
    "hull": {"color": style.BLUE, "linewidth": 0.7, "label": "convex hull of the control points", "zorder": 2},
    "bound": {**style.BOUND, "label": "shortest path possible", "zorder": 4},
    "collision": {"color": style.BLACK, "linestyle": "", "marker": "X", "markersize": 8, "label": "first collision", "zorder": 6},
    "start": {"color": style.BLACK, "linestyle": "", "marker": "s", "markersize": 7, "label": "start", "zorder": 4.5},
    "target": {"color": style.BLACK, "linestyle": "", "marker": "*", "markersize": 12, "label": "target", "zorder": 4.5},
}


def picked(results: Results, pick: dict[str, Any]) -> tuple[pd.Series | None, dict[str, Any]]:
    """The run that a panel shows, or None if no run is to be picked, and what names it in the columns of the panel's csv.

    Columns: problem, method, runs and feasible_runs (counts), run (its id; empty without a run), curve, length (in units), feasible.
    Raises ValueError unless all the panel's runs are of one problem and one method.
    """
    runs = results.runs
    for column in ("problem", "method"):
        found = list(runs[column].unique())
        if len(found) != 1:
            raise ValueError(f"a panel that shows one run needs runs of exactly one {column}, not of {len(found)} {found}; see its `where`")
    run = pick_run(runs, pick)
    names = {"problem": runs["problem"].iloc[0], "method": runs["method"].iloc[0]}
    names |= {"runs": len(runs), "feasible_runs": int(runs["feasible"].sum())}
    if run is None:
        return None, names | {"run": None, "curve": None, "length": np.nan, "feasible": False}
    return run, names | {"run": run["id"], "curve": run["path_curve"], "length": run["length"], "feasible": bool(run["feasible"])}


def run_note(frame: pd.DataFrame, *more: str) -> str:
    """Which run a panel shows, from the columns that `picked` names, and more lines about it; or only that there is none."""
    row = frame.iloc[0]
    if pd.isna(row["run"]):
        return f"no {'such' if row['feasible_runs'] else 'feasible'} run among {row['runs']:g}"
    return "\n".join([f"run {row['run']}" + ("" if row["feasible"] else " (not feasible)"), *more])


def feasible_note(frame: pd.DataFrame) -> str:
    """How many of a panel's runs are feasible, from the columns that `picked` names."""
    row = frame.iloc[0]
    return f"{row['feasible_runs']:g} of {row['runs']:g} runs are feasible"


def data(results: Results, *, pick: dict[str, Any]) -> pd.DataFrame:
    """What is drawn of a run: one row a point, in the order in which points are joined.

    Columns: those of `picked`; part (start, target, bound, hull, control, path, and collision, the first one of a path that has one), x, y
    (in the workspace's unit). Without a run to show, start and target only.

    pick: the run, as in `analysis.results.pick`. Raises ValueError unless all runs are of one problem and one method.
    """
    run, names = picked(results, pick)
    problem = results.problems[names["problem"]]
    drawn = {"start": [problem.start], "target": [problem.target]}
    path = None if run is None else path_of(run)
    if path is not None:
        hull = shapely.MultiPoint(path.points).convex_hull
        drawn["bound"] = np.reshape(results.bounds.loc[problem.name, "bound_path"], (-1, 2))
        drawn |= {"hull": shapely.get_coordinates(hull), "control": path.points, "path": _steps(path)}
        if not run["feasible"]:
            drawn["collision"] = [curves.point_at(path, run["collision_at"])]
    points = [pd.DataFrame(np.asarray(xy, dtype=float), columns=["x", "y"]).assign(part=part) for part, xy in drawn.items()]
    frame = pd.concat(points, ignore_index=True).assign(**names)
    return frame[[*names, "part", "x", "y"]]


def _steps(path: Path) -> np.ndarray:
    """Points (n, 2) along a path, close enough to look smooth."""
    pieces = len(curves.bezier_pieces(path))
    steps = pieces * max(1, _STEPS // pieces)
    return curves.sample_matrix(path.curve, len(path.points), steps + 1) @ path.points


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, panel: dict) -> str:
    """Draw the rows of `data` in their workspace; returns the note below the panel's title."""
    row = frame.iloc[0]
    workspace = scene.problems[panel["experiment"]][row["problem"]].workspace
    workspaces.shade(axes, workspaces.parts(workspace))
    workspaces.scale(axes, workspace.unit)
    drawn = {part: frame.loc[frame["part"] == part, ["x", "y"]] for part in _LOOK}
    for part, points in drawn.items():
        if not points.empty:
            axes.plot(points["x"], points["y"], clip_on=False, **_LOOK[part])
    control = drawn["control"]
    if control.empty:
        return run_note(frame, "no path")
    length = f"length {row['length']:.1f} {workspace.unit}"
    return run_note(frame, f"{length}, {len(control.drop_duplicates())} of {len(control)} control points distinct", feasible_note(frame))
