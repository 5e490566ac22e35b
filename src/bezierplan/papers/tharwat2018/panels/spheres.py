"""A path that the swarm finds among spheres, projected on a plane, or its clearance.

The panel plans by itself: problems, runs and bounds of experiments have two dimensions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from bezierplan.figures import style
from bezierplan.figures.panels import Note, Panel, Sources
from bezierplan.figures.panels import workspace as workspaces
from bezierplan.geometry import curves
from bezierplan.geometry import spheres as exact
from bezierplan.schema.model import Count, Name, Number, Setting
from bezierplan.schema.model import Workspace as Described
from bezierplan.schema.words import amount
from bezierplan.workspaces.kinds import of_length
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.seeds import generator
from bezierplan.workspaces.spheres import Spheres

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

PLANNER = "chaotic_pso"
"""The planner that can plan in three dimensions."""

_STEPS = 200

_LOOK = {
    "line": {**style.REFERENCE, "label": "straight line", "zorder": 4},
    "path": {**style.RUN_SHOWN, "label": "path", "zorder": 5},
    "control": {
        **style.mark("o", 4, style.BLUE, label="control points", zorder=4.2),
        "linewidth": 0.7,
        "linestyle": (0, (4, 2)),
    },
    **workspaces.ENDS,
}

Place = Annotated[list[Number], of_length(3, "[x, y, z]")]


class Options(Panel):
    plans: ClassVar[str] = PLANNER

    workspace: Described = Field(description="the name of a workspace of kind `spheres`")
    start: Place = Field(description="[x, y, z] in units")
    target: Place = Field(description="[x, y, z] in units")
    method: Name = Field(description="the name of a method of planner `chaotic_pso`")
    settings: dict[Name, Setting] = Field(
        {}, description="settings that take the place of the method's own, by name"
    )
    runs: Count = Field(
        description="how many runs are made, a whole number of at least 1; "
        "the shortest free path is drawn"
    )
    plane: Literal["xy", "xz", "yz"] = Field(
        None,
        description="the plane on which it is projected: xy, xz or yz; left out: its distance to "
        "the nearest sphere or wall, which no projection shows",
    )

    def source(self, sources: Sources) -> tuple[Spheres, str]:
        """The workspace, and the name of the study."""
        return sources.workspaces[self.workspace], sources.study

    def check(self, workspace: Spheres) -> None:
        """Raise ValueError unless start and target are free."""
        problem(workspace, self.start, self.target)


def problem(workspace: Spheres, start: list[float], target: list[float]) -> Problem:
    """The problem of a panel. Raises ValueError, naming the key, unless start and target are
    free.
    """
    ends = {"start": tuple(map(float, start)), "target": tuple(map(float, target))}
    for end, point in ends.items():
        if not exact.is_free(np.array([[point, point]]), workspace):
            raise ValueError(
                f"{end}: {list(point)}: in a sphere or outside the box; expected a free place"
            )
    return Problem("", workspace, **ends)


def data(source: tuple[Spheres, str], options: Options) -> pd.DataFrame:
    """What is drawn, and a row for each run; columns: part, x, y, z (in the workspace's unit), size
    and obstacle (a sphere's radius and number), run (its name), length, claimed_feasible (by the
    planner's own test), feasible (by the exact check), along and clearance (of places of the path:
    the length up to there as a share of all, and the distance to the nearest sphere or wall, in
    units), method, straight_line and bound (lengths, in units; `spheres.least_length`).

    Parts: corner (of the bounds), sphere, start, target, line (the straight one), run, and of the
    shortest feasible run path and control. source: the workspace, and the name of the study, from
    which with others the runs take their seeds. options: their settings are all of the planner.
    Raises ValueError for a feasible path below the bound.
    """
    import pandas as pd

    from bezierplan.planners import chaotic_pso

    workspace, study = source
    start, target = options.start, options.target
    task = problem(workspace, start, target)
    bound = exact.least_length(workspace, task.start, task.target)
    rows, paths = [], {}
    for repeat in range(options.runs):
        run = f"{study}/{options.workspace}/{options.method}/{repeat}"
        plan = chaotic_pso.plan(task, generator(run), **options.settings)
        pieces = curves.bezier_pieces(plan.path)
        length, feasible = exact.length(pieces), exact.is_free(pieces, workspace)
        if feasible and length < bound * (1 - 1e-9) - 1e-7:
            raise ValueError(f"run {run}: a free path of length {length}, below the bound {bound}")
        rows.append(("run", run, length, plan.claimed_feasible, feasible))
        paths[run] = plan.path
    of_runs = ["run", "length", "claimed_feasible", "feasible"]
    table = pd.DataFrame(rows, columns=["part", *of_runs])
    places = {
        "corner": np.reshape(workspace.bounds, (3, 2)).T,
        "sphere": workspace.centres,
        "start": [start],
        "target": [target],
        "line": [start, target],
    }
    parts = [_places(part, points) for part, points in places.items()]
    parts[1] = parts[1].assign(size=workspace.radii, obstacle=range(len(workspace.radii)))
    free = table[table["feasible"]]
    if len(free):
        best = free.loc[free["length"].idxmin(), "run"]
        path = paths[best]
        samples = curves.sample_matrix(path.curve, len(path.points), _STEPS + 1) @ path.points
        chords = np.linalg.norm(np.diff(samples, axis=0, prepend=samples[:1]), axis=1).cumsum()
        low, high = places["corner"]
        to_centres = np.linalg.norm(samples[:, None] - workspace.centres, axis=2)
        room = np.hstack([to_centres - workspace.radii, samples - low, high - samples]).min(axis=1)
        own = _places("path", samples).assign(along=chords / chords[-1], clearance=room)
        parts += [table, own.assign(run=best), _places("control", path.points).assign(run=best)]
    else:
        parts.append(table)
    columns = ["part", "x", "y", "z", "size", "obstacle", *of_runs, "along", "clearance"]
    drawn = pd.concat(parts, ignore_index=True).reindex(columns=columns)
    return drawn.assign(
        method=options.method, straight_line=np.linalg.norm(np.subtract(target, start)), bound=bound
    )


def _places(part: str, points: Any) -> pd.DataFrame:
    import pandas as pd

    return pd.DataFrame(points, columns=["x", "y", "z"]).assign(part=part)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    unit = scene.workspaces[options.workspace].unit
    if options.plane is None:
        return _draw_clearance(axes, frame[frame["part"] == "path"], unit)
    across, up = options.plane
    flat = frame.assign(
        part=frame["part"].replace("sphere", "circle"), x=frame[across], y=frame[up]
    )
    workspaces.shade(axes, flat)
    room = flat["size"].max()
    for name, places in flat.loc[flat["part"] != "corner", ["x", "y"]].items():
        axes.set(**{f"{name}lim": (places.min() - room, places.max() + room)})
    axes.set_xlabel(f"{across} ({unit})")
    axes.set_ylabel(f"{up} ({unit})")
    style.draw_parts(axes, flat, _LOOK)
    runs, row = frame[frame["part"] == "run"], frame.iloc[0]
    free, claimed = runs[runs["feasible"].astype(bool)], runs["claimed_feasible"].astype(bool).sum()
    return Note(
        f"shortest free path: {free['length'].min():.3f} {unit}",
        f"{len(free)} of {len(runs)} runs are free, {claimed} by their own test; "
        f"straight line {row['straight_line']:.3f}, lower bound {row['bound']:.3f} {unit}",
    )


def _draw_clearance(axes: Axes, path: pd.DataFrame, unit: str) -> Note:
    axes.plot(path["along"], path["clearance"], **_LOOK["path"])
    axes.axhline(0.0, label="surface of a sphere", **style.BOUND)
    axes.set_xlim(0, 1)
    axes.set_xlabel("share of the path's length")
    axes.set_ylabel(f"clearance ({unit})")
    axes.grid(visible=True)
    return Note(f"least clearance {amount(format(path['clearance'].min(), '.3g'), unit)}")
