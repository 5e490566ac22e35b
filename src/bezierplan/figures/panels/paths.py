"""A path with its control points: that of a picked run, in its workspace next to the exact shortest
path, or a given one.

Or several paths in one workspace, a picked run for each value of a column.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis import metrics
from bezierplan.figures import style
from bezierplan.figures.panels import (
    PICK,
    MayPrint,
    Note,
    Pick,
    RunsPanel,
    Sources,
    View,
    exactly_one,
    only,
)
from bezierplan.figures.panels import workspace as workspaces
from bezierplan.figures.panels.lines import axis_label, counts, published
from bezierplan.geometry import curves
from bezierplan.schema.checked import closest
from bezierplan.schema.model import (
    Column,
    Experiment,
    Flag,
    Label,
    Line,
    Metric,
    Model,
    Names,
    Number,
    Positive,
    PrintedTable,
    at_most,
    wrong,
)
from bezierplan.schema.words import amount
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.kinds import of_length
from bezierplan.workspaces.limits import LARGEST
from bezierplan.workspaces.problem import Path, Problem, Workspace

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Approximate number of straight steps drawn for a curve; they always include the ends of its
# pieces.
_STEPS = 600

# Widths of the first and of the last of several paths.
_WIDEST, _NARROWEST = 2.0, 1.0

# Width of a path below another one.
_WIDE_PATH = 3.4

# Where a letter may stand next to a place, towards the panel's centre, in points; and as a share of
# the panel's width, how near lines count as being there.
_LETTER_OFFSETS = [(13, 5), (5, 13), (11, 11)]
_NEAR_END = 0.25

# Scale factor of marks in a narrow panel.
NARROW_MARK = 0.6

_CONTROL_POINT = style.mark("o", 4.5, style.BLUE, markerfacecolor=style.FREE, zorder=5)

# In the order of the legend.
_LOOK = {
    "path": {**style.RUN_SHOWN, "label": "path", "zorder": 3},
    "control": {
        **_CONTROL_POINT,
        "linewidth": 0.7,
        "linestyle": (0, (4, 2)),
        "label": "control points and polygon",
    },
    "points": {**_CONTROL_POINT, "label": "control points"},
    "nodes": {**_CONTROL_POINT, "label": "nodes"},
    "occupied": style.mark("D", 7, style.BLUE, markerfacecolor=style.AMBER, zorder=5.5)
    | {"label": "control point in an occupied cell"},
    "hull": {"color": style.BLUE, "linewidth": 0.7, "label": "convex hull", "zorder": 2},
    "bound": {**style.BOUND, "label": "exact shortest path", "zorder": 4},
    "optimum": {
        "color": style.LOOKS["sky"][0],
        "linestyle": (0, (4, 2)),
        "linewidth": 1.4,
        "label": "shortest between cell centres",
        "zorder": 3.5,
    },
    "collision": style.mark("X", 8, style.BLACK, label="first collision", zorder=6),
    "start": workspaces.START,
    "target": workspaces.TARGET,
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
        "linestyle": (0, (2, 1)),
        "hatch": "....",
        "label": "free since the change",
    },
}


def picked(results: Results, pick: Pick) -> tuple[pd.Series | None, dict[str, Any]]:
    """The run that a panel shows, or None if there is none to pick, and its description in the
    columns of the panel's csv file.

    Columns: problem, method, runs and feasible_runs (counts), run (its id; empty without a run),
    curve, length (in units), feasible. Raises ValueError unless all the panel's runs are of one
    problem and one method.
    """
    from bezierplan.analysis.results import pick as pick_run

    runs = results.runs
    names = {column: only(runs, column) for column in ("problem", "method")} | counts(runs)
    if pick.having is not None:
        runs = runs[metrics.values(runs, pick.having, results.problems) > 0]
    run = pick_run(runs, pick.plain("having"))
    if run is None:
        return None, names | {"run": None, "curve": None, "length": np.nan, "feasible": False}
    return run, names | {
        "run": run["id"],
        "curve": run["path_curve"],
        "length": run["length"],
        "feasible": bool(run["feasible"]),
    }


def run_note(frame: pd.DataFrame, *more: str) -> str:
    """Which run a panel shows, from the columns that `picked` names, and more lines about it; or
    just that there is none.
    """
    import pandas as pd

    row = frame.iloc[0]
    if pd.isna(row["run"]):
        return f"no {'such' if row['feasible_runs'] else 'feasible'} run among {row['runs']:g}"
    return "; ".join([f"run {row['run']}" + ("" if row["feasible"] else " (not feasible)"), *more])


def feasible_note(frame: pd.DataFrame) -> str:
    """How many of a panel's runs are feasible, from the columns that `picked` names."""
    row = frame.iloc[0]
    return f"{row['feasible_runs']:g} of {row['runs']:g} runs are feasible"


MOST_POINTS = 100
"""Control points of a path without a run."""


class Explicit(Model):
    """A path without a run."""

    curve: Line = Field(description="the kind of a curve")
    points: Annotated[
        list[Annotated[list[Number], of_length(2, "[x, y]")]], at_most(MOST_POINTS)
    ] = Field(
        description="a list of two to 100 [x, y], at most 1e5 in absolute value", min_length=2
    )


class Options(MayPrint, RunsPanel):
    """Keys of a panel: of picked runs, or of an explicit path."""

    to_scale: ClassVar[bool] = True

    experiment: Experiment = Field(None, description="the name of an experiment")
    pick: Pick = Field(None, description=PICK)
    explicit: Explicit = Field(
        None, description="in place of experiment and pick, {curve, points}: a path without a run"
    )
    hue: Column = Field(
        None, description="a column of the runs table: a run is picked for each of its values"
    )
    control: Literal["all", "points", "none"] = Field(
        "all",
        description="whether control points are drawn with their polygon and hull (all; left out: "
        "this), alone (points), or not (none)",
    )
    measure: Metric = Field(
        "length",
        description="with hue, the metric whose value is written for each path; left out: length",
    )
    bare: Flag = Field(
        False,
        description="whether only the workspace with start and target is drawn, true or false",
    )
    letters: list[Label] = Field(
        None,
        description="what is written next to start and target: a list of two",
        min_length=2,
        max_length=2,
    )
    changed_from: Annotated[Line, Names("problem of runs")] = Field(
        None,
        description="the name of another problem of the experiment, on cells as many: those that "
        "differ from it are marked",
    )
    cell_optimum: Flag = Field(
        False,
        description="whether the least path from cell centre "
        "to cell centre is drawn, true or false",
    )
    band: Positive = Field(
        None,
        description="a distance from the occupied cells of a grid: the band around them is "
        "shaded, and the path's clearance is written",
    )
    printed: PrintedTable = Field(
        None,
        description="the name of a published table whose shortest length is given next to the "
        "run's",
    )
    view: View = Field(
        None,
        description="what is seen: [lowest x, highest x, lowest y, highest y]",
        min_length=4,
        max_length=4,
    )

    def source(self, sources: Sources) -> Results | None:
        """Runs; nothing for an explicit path."""
        return None if self.experiment is None else super().source(sources)

    @property
    def one(self) -> tuple[str, ...]:
        """Columns of which the runs have one value: one for each of hue."""
        return ("problem", "method")

    @model_validator(mode="after")
    def _check_source(self) -> Options:
        exactly_one(self, "pick", "explicit")
        exactly_one(self, "experiment", "explicit")
        if self.explicit and self.hue:
            raise wrong("hue: needs experiment")
        if "measure" in self.model_fields_set and self.hue is None:
            raise wrong("measure: needs hue")
        if self.bare and (self.explicit or self.hue):
            raise wrong(f"bare: not together with {'explicit' if self.explicit else 'hue'}")
        if self.explicit and any(
            abs(each) > LARGEST for point in self.explicit.points for each in point
        ):
            raise wrong(
                f"explicit: points: expected coordinates of at most {LARGEST:g} in absolute value"
            )
        if self.explicit and self.explicit.curve not in curves.CURVES:
            raise wrong(
                f"explicit: curve: {self.explicit.curve}: "
                f"unknown{closest(self.explicit.curve, curves.CURVES)}"
            )
        return self


def data(results: Results | None, options: Options) -> pd.DataFrame:
    """What is drawn of a path: one row per point, in the order in which points are joined.

    Columns: those of `picked`, for a run; part (start, target, bound, hull, control or points,
    occupied: those of them in occupied cells, path, collision: a path's first one, if any, optimum,
    and appeared and vanished: centres of changed cells), x, y (in the workspace's unit). Without a
    run to show, only what belongs to the problem. Only curves within their hull have one, and
    control points are left out if some are tangents.

    With `hue`, paths are drawn without control points, and the column `measure` has each run's
    value of that metric. With `band`, the column obstacle_clearance has the path's distance to
    occupied cells. With `printed`, the column of this name has the shortest length of that
    published table for the runs. Whatever the `view`, the rows include everything.

    Raises ValueError unless all runs, of one value of hue, are of one problem and one method, and
    if a curve cannot have such points.
    """
    import pandas as pd

    from bezierplan.analysis.results import path_of

    if options.explicit is not None:
        path = Path(options.explicit.curve, np.array(options.explicit.points, dtype=float))
        start, target = path.points[list(curves.ends(path.curve))]
        return table({"start": [start], "target": [target]} | _drawn(path, options.control))
    if options.hue is not None:
        groups = results.runs.groupby(options.hue)
        alone = Options(
            kind=options.kind,
            experiment=options.experiment,
            pick=options.pick.plain(),
            control="none",
        )
        frame = pd.concat(
            [
                data(results._replace(runs=runs), alone).assign(**{options.hue: value})
                for value, runs in groups
            ],
            ignore_index=True,
        )
        numbers = metrics.values(results.runs, options.measure, results.problems)
        by_run = numbers.groupby(results.runs["id"]).first()
        return frame.assign(measure=frame["run"].map(by_run))
    run, names = picked(results, options.pick)
    problem = results.problems[names["problem"]]
    drawn = {"start": [problem.start], "target": [problem.target]}
    if options.changed_from is not None:
        drawn |= _changed_cells(problem.workspace, _other(results, options.changed_from).workspace)
    if options.bare:
        return table(drawn).assign(problem=problem.name)
    if options.printed is not None and results.published is not None:
        printed = published(results, results.runs, "length", "min", options.printed)
        names["printed"] = next(iter(printed), np.nan)
    if options.band is not None:
        if not isinstance(problem.workspace, Grid):
            raise ValueError(f"band: {problem.name}: not a grid, and has no occupied cells")
        names["obstacle_clearance"] = _clearance(results, run)
    if options.cell_optimum:
        drawn["optimum"] = _cell_optimum(problem, results.runs.iloc[0])
    path = None if run is None else path_of(run)
    if path is not None:
        drawn["bound"] = np.reshape(results.bounds.loc[problem.name, "bound_path"], (-1, 2))
        drawn |= _drawn(path, options.control)
        if options.control != "none" and isinstance(problem.workspace, Grid):
            drawn["occupied"] = _in_occupied_cells(path.points, problem.workspace)
        if not run["feasible"]:
            drawn["collision"] = [curves.point_at(path, run["collision_at"])]
    frame = table(drawn).assign(**names)
    return frame[[*names, "part", "x", "y"]]


def _drawn(path: Path, control: str) -> dict[str, np.ndarray]:
    """Points (n, 2) of a path by the part that they form."""
    import shapely

    drawn = {}
    if path.curve in curves.B_SPLINES and control == "all":
        drawn["hull"] = shapely.get_coordinates(shapely.MultiPoint(path.points).convex_hull)
    if path.curve != "ferguson" and control != "none":
        alone = "nodes" if path.curve == "polyline" else "points"
        drawn["control" if control == "all" else alone] = path.points
    return drawn | {"path": steps(path)}


def _other(results: Results, name: str) -> Problem:
    """Another problem of an experiment. Raises ValueError if it has none of this name."""
    if name not in results.problems:
        raise ValueError(
            f"changed_from: {name}: not a problem of the experiment, which has "
            f"{', '.join(results.problems)}"
        )
    return results.problems[name]


def _changed_cells(grid: Grid, before: Grid) -> dict[str, np.ndarray]:
    """Centres (n, 2), in units, of cells that are occupied only now (appeared) or only before
    (vanished).
    """
    changes = {
        "appeared": grid.occupied & ~before.occupied,
        "vanished": before.occupied & ~grid.occupied,
    }
    return {
        part: np.reshape([grid.centre(int(number)) for number in np.flatnonzero(cells)], (-1, 2))
        for part, cells in changes.items()
    }


def _cell_optimum(problem: Problem, run: pd.Series) -> np.ndarray:
    """Points (n, 2) of the shortest path from cell centre to cell centre, under the rules of a run
    of meledje's planner.
    """
    from scipy.sparse import csgraph

    from bezierplan.workspaces.ground import ground_of

    grid = problem.workspace
    ground = ground_of(grid, float(run.get("friction", 1.0)), run.get("corners") == "closed")
    edges = np.where(ground.met == 0, ground.energy, np.inf)
    start, cell = (
        int(np.ravel_multi_index(grid.cell_of(*end), grid.occupied.shape))
        for end in (problem.start, problem.target)
    )
    before = csgraph.dijkstra(edges, indices=start, return_predecessors=True)[1]
    way = [cell]
    while way[-1] != start:
        way.append(int(before[way[-1]]))
    return np.array([grid.centre(number) for number in way[::-1]])


def _clearance(results: Results, run: pd.Series | None) -> float:
    """The least distance of a run's path to occupied cells; NaN if it has none or collides."""
    if run is None:
        return np.nan
    return float(
        metrics.values(results.runs.loc[[run.name]], "obstacle_clearance", results.problems).iloc[0]
    )


def _in_occupied_cells(points: np.ndarray, grid: Grid) -> np.ndarray:
    """Those of points (n, 2), in units, that lie in occupied cells: (k, 2)."""
    cells = [grid.cell_of(*point) for point in points]
    inside = [cell is not None and bool(grid.occupied[cell]) for cell in cells]
    return np.reshape(points[inside], (-1, 2))


def table(drawn: dict[str, Sequence]) -> pd.DataFrame:
    """Points (n, 2) by part as rows."""
    import pandas as pd

    points = [
        pd.DataFrame(np.asarray(xy, dtype=float), columns=["x", "y"]).assign(part=part)
        for part, xy in drawn.items()
    ]
    return pd.concat(points, ignore_index=True)[["part", "x", "y"]]


def steps(path: Path) -> np.ndarray:
    """Points (n, 2) along a path, close enough to look smooth."""
    pieces = len(curves.bezier_pieces(path))
    steps = pieces * max(1, _STEPS // pieces)
    return curves.sample_matrix(path.curve, len(path.points), steps + 1) @ path.points


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`, in their workspace if they have one."""
    if options.explicit is not None:
        workspaces.scale(axes, scene.unit)
        axes.set_aspect("equal")
        axes.margins(0.06)
    else:
        workspace = scene.problems[options.experiment][frame["problem"].iloc[0]].workspace
        workspaces.shade(axes, workspaces.parts(workspace))
        workspaces.scale(axes, workspace.unit)
        _draw_changes(axes, frame, workspace)
        if options.band is not None:
            _draw_band(axes, workspace, options.band)
    if options.hue is not None:
        note = _draw_side_by_side(axes, frame, scene, options)
    else:
        of_run = options.explicit is None and not options.bare
        note = _note(frame, workspace.unit) if of_run else Note()
        draw_parts(axes, frame, narrow=scene.narrow, clip=options.view is not None)
    lines = frame.loc[frame["part"].isin(["path", "bound", "optimum"]), ["x", "y"]]
    for part, letter in zip(("start", "target"), options.letters or ()):
        end = frame.loc[frame["part"] == part, ["x", "y"]].iloc[0].to_numpy(dtype=float)
        _write_letter(axes, end, letter, lines.to_numpy(dtype=float))
    if options.view is not None:
        axes.axis(options.view)
    if scene.narrow:
        axes.locator_params(nbins=4, integer=True)
    return note


def _draw_band(axes: Axes, grid: Grid, width: float) -> None:
    """Shade what is nearer to occupied cells than a width."""
    import shapely
    from shapely.plotting import patch_from_polygon

    rows, columns = np.nonzero(grid.occupied)
    x, y = grid.origin[0] + grid.cell * columns, grid.origin[1] + grid.cell * rows
    cells = shapely.union_all(shapely.box(x, y, x + grid.cell, y + grid.cell))
    look = {"facecolor": style.LIGHT_BLUE, "edgecolor": "none", "zorder": 0.6}
    for part in shapely.get_parts(shapely.difference(shapely.buffer(cells, width), cells)):
        axes.add_patch(patch_from_polygon(part, **look))


def _draw_changes(axes: Axes, frame: pd.DataFrame, workspace: Workspace) -> None:
    """Mark cells that differ from those of another problem."""
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Rectangle

    for part, look in _CHANGED.items():
        centres = frame.loc[frame["part"] == part, ["x", "y"]].to_numpy(dtype=float)
        cells = [
            Rectangle(centre - workspace.cell / 2, workspace.cell, workspace.cell)
            for centre in centres
        ]
        if cells:
            shapes = PatchCollection(cells, facecolor="none", zorder=1, linewidth=0.9, **look)
            axes.add_collection(shapes, autolim=False)


def _write_letter(axes: Axes, point: np.ndarray, letter: str, lines: np.ndarray) -> None:
    """Write a letter next to a place where lines through points (n, 2) end, on the side towards the
    panel's centre, as far as possible from their direction.
    """
    inwards = np.where(point <= [np.mean(axes.get_xlim()), np.mean(axes.get_ylim())], 1, -1)
    steps = (lines - point) * inwards
    distances = np.hypot(*steps.T)
    near = (distances > 0) & (distances < _NEAR_END * np.ptp(axes.get_xlim()))
    directions = steps[near] / distances[near, None]
    clear = [
        max(directions @ offset / np.hypot(*offset), default=0.0)
        for offset in np.array(_LETTER_OFFSETS, dtype=float)
    ]
    beside = {
        "xytext": np.array(_LETTER_OFFSETS[int(np.argmin(clear))]) * inwards,
        "textcoords": "offset points",
        "ha": "center",
        "va": "center",
    }
    # Without a halo, which would look like a gap in a path.
    axes.annotate(letter, point, weight="bold", zorder=7, **beside)


def _draw_side_by_side(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the paths of all values of hue, each in its own style, and what belongs to their problem
    once; returns their measures.
    """
    hue = options.hue
    values = style.in_order(frame[hue], options.where)
    clauses = []
    # The first path is the widest, so that paths on top do not hide it.
    widths = np.linspace(_WIDEST, _NARROWEST, len(values))
    for value, look, width in zip(values, style.lines(values, scene.looks), widths):
        rows = frame[frame[hue] == value]
        collision, path = (rows[rows["part"] == part] for part in ("collision", "path"))
        draw_parts(axes, collision, narrow=scene.narrow, clip=options.view is not None)
        name = style.printed(value, hue, scene.labels)
        line = look | {"marker": "", "label": name, "linewidth": width}
        axes.plot(path["x"], path["y"], zorder=3, **line)
        clauses.append(
            f"{name} {_decimal(rows['measure'].iloc[0])}" if len(path) else f"{name} no path"
        )
    once = frame[frame["part"].isin(["start", "target", "bound"])].drop_duplicates(
        ["part", "x", "y"]
    )
    draw_parts(axes, once, narrow=scene.narrow, clip=options.view is not None)
    found = frame.loc[frame["part"] == "path", hue].nunique()
    return Note(
        "" if found == len(values) else f"{found} of {len(values)} have a path",
        f"{axis_label(options.measure, scene)}: {', '.join(clauses)}",
    )


def draw_parts(axes: Axes, frame: pd.DataFrame, *, narrow: bool, clip: bool) -> None:
    """Draw the points of each part; anything beyond the panel only if they are not clipped.

    A path is drawn so wide that it is seen on both sides of a shortest one between cell centres,
    which it often is.
    """
    parts = set(frame["part"])
    for part, look in _LOOK.items():
        if part == "path" and "optimum" in parts:
            look = look | {"linewidth": _WIDE_PATH}
        points = frame.loc[frame["part"] == part, ["x", "y"]]
        if narrow and "markersize" in look:
            look = look | {"markersize": NARROW_MARK * look["markersize"]}
        if not points.empty:
            axes.plot(points["x"], points["y"], clip_on=clip, **look)


def _note(frame: pd.DataFrame, unit: str) -> Note:
    """The length of the path; for the caption its run, and what else is known of it."""
    row = frame.iloc[0]
    if not (frame["part"] == "path").any():
        return Note("no path", run_note(frame, "no path"))
    control = frame.loc[frame["part"].isin(["control", "points"]), ["x", "y"]]
    clauses = (
        []
        if control.empty
        else [f"{len(control.drop_duplicates())} of {len(control)} control points distinct"]
    )
    clauses += [*_clear(row), feasible_note(frame)]
    if "printed" in frame and np.isfinite(row["printed"]):
        printed = f"{row['printed']:.2f}"
        clauses.append(f"shortest printed {amount(printed, unit)}")
    if (frame["part"] == "optimum").any():
        cells, bound = (_joined(frame[frame["part"] == part]) for part in ("optimum", "bound"))
        clauses.append(f"shortest between cell centres {cells:.2f}, at any angle {bound:.2f}")
    length = f"{row['length']:.2f}"
    return Note(f"length {amount(length, unit)}", run_note(frame, *clauses))


def _clear(row: pd.Series) -> list[str]:
    """The clearance of the path, if the band is drawn."""
    clearance = row.get("obstacle_clearance", np.nan)
    return [f"clearance {clearance:.3f}"] if np.isfinite(clearance) else []


def _joined(points: pd.DataFrame) -> float:
    """Length of straight edges through points."""
    return float(np.hypot(points["x"].diff(), points["y"].diff()).sum())


def _decimal(number: float) -> str:
    """A number to two decimals, without trailing zeros."""
    return f"{number:.2f}".rstrip("0").rstrip(".")
