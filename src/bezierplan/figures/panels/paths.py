"""A path with its control points, either of a chosen run, in its workspace next to the exact
shortest path, or a given one.

Or several paths in one workspace, a run chosen for each value of a column.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis import measures, metrics
from bezierplan.analysis.naming import format_amount
from bezierplan.figures import style
from bezierplan.figures.groups import count_runs, describe_axis, find_published
from bezierplan.figures.panels import Note, Pick, Picked, RunsPanel, Sources, find_only, require_one
from bezierplan.figures.panels import workspace as workspaces
from bezierplan.geometry import curves
from bezierplan.running.columns import Row
from bezierplan.schema.model import (
    Column,
    ExperimentName,
    Line,
    Metric,
    Model,
    PrintedTable,
    build_error,
    build_name_type,
)
from bezierplan.workspaces.kinds import build_numbers_type
from bezierplan.workspaces.problem import Path

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Approximate number of straight steps drawn for a curve; they always include the ends of its
# pieces.
_STEPS = 600

# Widths of the first and of the last of several paths.
_WIDEST, _NARROWEST = 2.0, 1.0

# Curves without points that bend them: the corners of one lie on it, the other has tangents.
_UNCONTROLLED = ("polyline", "ferguson")

_CONTROL_POINTS = style.build_mark_style(
    "o", 4.5, style.BLUE, markerfacecolor=style.FREE, label="control points", zorder=5
)

# In the order of the legend.
LOOK = {
    "path": {**style.RUN_SHOWN, "label": "path", "zorder": 3},
    "control": _CONTROL_POINTS,
    "points": _CONTROL_POINTS,
    "hull": {"color": style.BLUE, "linewidth": 0.7, "label": "convex hull", "zorder": 2},
    "bound": {**style.BOUND, "label": "exact shortest path", "zorder": 4},
    "collision": style.build_mark_style("X", 8, style.BLACK, label="first collision", zorder=6),
    **workspaces.ENDS,
}


# Cells that differ from those of another problem.
_CHANGED = {
    "appeared": {
        "edgecolor": style.AMBER,
        "hatch": "////",
        "label": "occupied since the change",
    },
    "vanished": {
        "edgecolor": style.BLUE,
        "linestyle": style.DOTTED,
        "hatch": "....",
        "label": "free since the change",
    },
}


def choose_run(results: Results, pick: Pick) -> tuple[pd.Series | None, Row]:
    """Choose the run that a panel shows, and describe it in the columns of the panel's csv file.

    Returns None in place of a run if there is none to choose. Columns: problem, method, runs and
    feasible_runs (counts), run (its id; empty if there is none), curve, length (in units),
    feasible.

    Raises ValueError unless all the panel's runs are of one problem and one method.
    """
    from bezierplan.analysis.results import pick as pick_run

    runs = results.runs
    names = {column: find_only(runs, column) for column in ("problem", "method")} | count_runs(runs)
    if pick.having is not None:
        runs = runs[metrics.compute_values(runs, pick.having, results.problems) > 0]
    run = pick_run(runs, pick.plain("having", "layout"))
    if run is None:
        return None, names | {"run": None, "curve": None, "length": np.nan, "feasible": False}
    return run, names | {
        "run": run["id"],
        "curve": run["path_curve"],
        "length": run["length"],
        "feasible": bool(run["feasible"]),
    }


def describe_run(frame: pd.DataFrame, *more: str) -> str:
    """Say which run a panel shows, or that there is none.

    frame: with the columns of `choose_run`. more: other clauses about the run.
    """
    import pandas as pd

    row = frame.iloc[0]
    if pd.isna(row["run"]):
        return f"no {'such' if row['feasible_runs'] else 'feasible'} run among {row['runs']:g}"
    return "; ".join([f"run {row['run']}" + ("" if row["feasible"] else " (not feasible)"), *more])


def describe_feasible_runs(frame: pd.DataFrame) -> str:
    """Say how many of a panel's runs are feasible, from the columns of `choose_run`."""
    row = frame.iloc[0]
    return f"{row['feasible_runs']:g} of {row['runs']:g} runs are feasible"


class Explicit(Model):
    """A path given by its points, not by a run."""

    curve: Literal[tuple(curves.CURVES)] = Field(description="the kind of a curve")
    points: list[build_numbers_type(2, "[x, y]")] = Field(
        description="a list of at least two [x, y]", min_length=2
    )


class Options(RunsPanel):
    """Keys of a panel of chosen runs or of an explicit path.

    With hue, `one` is meant for each of its values.
    """

    one = ("problem", "method")

    experiment: ExperimentName = Field(None, description="the name of an experiment")
    pick: Picked = None
    explicit: Explicit = Field(
        None, description="instead of experiment and pick, {curve, points}: a path without a run"
    )
    hue: Column = Field(
        None, description="a column of the runs table: a run is picked for each of its values"
    )
    control: Literal["all", "points", "none"] = Field(
        "all",
        description="whether control points, which polylines have none of, are drawn with their "
        "hull (all; left out: this), alone (points), or not (none)",
    )
    measure: Metric = Field(
        "length",
        description="with hue, the metric whose value is written for each path; left out: length",
    )
    letters: workspaces.Letters = None
    changed_from: build_name_type("problem of runs", Line) = Field(
        None,
        description="the name of another problem of the experiment, on cells as many: those that "
        "differ from it are marked",
    )
    printed: PrintedTable = Field(
        None,
        description="the name of a published table whose shortest length is given next to the "
        "run's",
    )
    view: build_numbers_type(4, "[lowest x, highest x, lowest y, highest y]") = Field(
        None, description="what is seen: [lowest x, highest x, lowest y, highest y]"
    )

    def source(self, sources: Sources) -> Results | None:
        """Return the runs, of one layout if one is chosen, or None for an explicit path."""
        from bezierplan.analysis.results import select

        if self.experiment is None:
            return None
        shown = super().source(sources)
        if self.pick.layout is None:
            return shown
        values = sources.results[self.experiment].runs.groupby("layout")[self.pick.layout]
        layout = (values.max() - values.min()).idxmax()
        return shown._replace(runs=select(shown.runs, {"layout": layout}))

    @model_validator(mode="after")
    def _check_source(self) -> Options:
        """Refuse a panel that is of a run and of an explicit path, or of neither."""
        require_one(self, "pick", "explicit")
        require_one(self, "experiment", "explicit")
        if "measure" in self.model_fields_set and self.hue is None:
            raise build_error("measure: needs hue")
        return self


def data(results: Results | None, options: Options) -> pd.DataFrame:
    """Return one row per point of a path, in the order in which points are joined.

    Rows of a run have the columns of `choose_run`. All have part (start, target, bound: the exact
    shortest path, hull, control or points, path, collision: a path's first one, if any, and
    appeared and vanished: centres of changed cells), x, y (in the workspace's unit). If there is no
    run to show, only the problem's own rows. Only curves within their hull have one, and polylines
    and curves with tangents no control points.

    With `hue`, paths are drawn without control points, and the column `measure` has each run's
    value of that metric. With `printed`, the column of this name has the shortest length of that
    published table for the runs. The rows include everything, also beyond the `view`.

    Raises ValueError unless all runs, of one value of hue, are of one problem and one method, and
    if a curve cannot have such points.
    """
    import pandas as pd

    from bezierplan.analysis.results import build_path

    if options.explicit is not None:
        path = Path(options.explicit.curve, np.array(options.explicit.points, dtype=float))
        start, target = path.points[curves.ends(path.curve)]
        ends = {"start": [start], "target": [target]}
        return workspaces.list_points(ends | _list_points_by_part(path, options.control))
    if options.hue is not None:
        # Each value is a panel of one run.
        alone = options.but(hue=None, control="none")
        groups = results.runs.groupby(options.hue)
        frames = [
            data(results._replace(runs=runs), alone).assign(**{options.hue: value})
            for value, runs in groups
        ]
        numbers = metrics.compute_values(results.runs, options.measure, results.problems)
        frame = pd.concat(frames, ignore_index=True)
        return frame.assign(measure=frame["run"].map(dict(zip(results.runs["id"], numbers))))
    run, names = choose_run(results, options.pick)
    problem = results.problems[names["problem"]]
    places = {"start": [problem.start], "target": [problem.target]}
    if options.changed_from is not None:
        before = results.problems[options.changed_from].workspace
        for part, cells, others in (
            ("appeared", problem.workspace, before),
            ("vanished", before, problem.workspace),
        ):
            row, column = np.nonzero(cells.occupied & ~others.occupied)
            places[part] = cells.in_units(np.column_stack([column, row]) + 0.5)
    if options.printed is not None and results.published is not None:
        printed = find_published(results, "length", options.printed, "min")
        names["printed"] = next(iter(printed), np.nan)
    path = None if run is None else build_path(run)
    if path is not None:
        if options.context:
            places["bound"] = np.reshape(results.bounds.loc[problem.name, "bound_path"], (-1, 2))
        places |= _list_points_by_part(path, options.control)
        if not run["feasible"]:
            places["collision"] = [curves.point_at(path, run["collision_at"])]
    return workspaces.list_points(places).assign(**names)[[*names, "part", "x", "y"]]


def _list_points_by_part(path: Path, control: str) -> dict[str, np.ndarray]:
    """Return the points (n, 2) to draw of a path, by part: its curve and, as `control` says, its
    control points and hull.
    """
    import shapely

    places = {}
    if path.curve not in _UNCONTROLLED and control != "none":
        places["control" if control == "all" else control] = path.points
        if path.curve in curves.B_SPLINES and control == "all":
            places["hull"] = shapely.get_coordinates(shapely.MultiPoint(path.points).convex_hull)
    return places | {"path": sample_path(path)}


def sample_path(path: Path) -> np.ndarray:
    """Return points (n, 2) along a path, close enough to look smooth."""
    pieces = len(curves.bezier_pieces(path))
    steps = pieces * max(1, _STEPS // pieces)
    return measures.sample_path(path, steps + 1)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`, in their workspace if they have one."""
    note, unit = Note(), scene.unit
    if options.explicit is not None:
        workspaces.label_axes(axes, unit)
        axes.set_aspect("equal")
        axes.margins(0.06)
    else:
        home = options.find_workspace(frame, scene)
        unit = home.unit
        workspaces.draw_workspace(axes, home)
        for part, look in _CHANGED.items():
            cells = frame[frame["part"] == part].assign(size=getattr(home, "cell", None))
            look = look | {"facecolor": "none", "linewidth": 0.9, "zorder": 1}
            workspaces.draw_cells(axes, cells, look)
    if options.hue is not None:
        note = _draw_side_by_side(axes, frame, scene, options)
    else:
        style.draw_parts(axes, frame, LOOK, clip_on=options.view is not None)
        if options.explicit is None:
            note = _write_note(frame, unit)
    workspaces.draw_letters(axes, frame, options.letters)
    if options.view is not None:
        axes.axis(options.view)
    return note


def _draw_side_by_side(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the paths of all values of hue, each in its own style, and their problem once.

    Returns a note with their measures.
    """
    groups = style.list_groups(frame, options.hue, options, scene)
    clauses = []
    # The first path is the widest, so that paths on top do not hide it.
    widths = np.linspace(_WIDEST, _NARROWEST, len(groups))
    for (_, rows, look), width in zip(groups, widths):
        path = rows[rows["part"] == "path"]
        axes.plot(path["x"], path["y"], zorder=3, **look | {"marker": "", "linewidth": width})
        measure = f"{rows['measure'].iloc[0]:.2f}" if len(path) else "no path"
        clauses.append(f"{look['label']} {measure}")
    once = frame[frame["part"].isin(["start", "target", "bound", "collision"])]
    once = once.drop_duplicates(["part", "x", "y"])
    style.draw_parts(axes, once, LOOK, clip_on=options.view is not None)
    there = frame.loc[frame["part"] == "path", options.hue].nunique()
    return Note(
        "" if there == len(groups) else f"{there} of {len(groups)} have a path",
        f"{describe_axis(options.measure, scene)}: {', '.join(clauses)}",
    )


def _write_note(frame: pd.DataFrame, unit: str) -> Note:
    """Return the length of the path as a heading, and clauses on its run for the caption."""
    row, parts = frame.iloc[0], set(frame["part"])
    if "path" not in parts:
        return Note("no path", describe_run(frame, "no path"))
    control = frame.loc[frame["part"].isin(["control", "points"]), ["x", "y"]]
    clauses = []
    if len(control):
        clauses = [f"{len(control.drop_duplicates())} of {len(control)} control points distinct"]
    clauses.append(describe_feasible_runs(frame))
    if np.isfinite(row.get("printed", np.nan)):
        clauses.append(f"shortest printed {format_amount(format(row['printed'], '.2f'), unit)}")
    return Note(
        f"length {format_amount(format(row['length'], '.2f'), unit)}", describe_run(frame, *clauses)
    )
