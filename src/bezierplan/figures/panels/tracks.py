"""How runs arrived at their paths: the track of one control point of the best path over the
iterations, or the first and the last path.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from bezierplan.analysis import metrics
from bezierplan.figures import style
from bezierplan.figures.panels import Note, RunsPanel, Sources, landscape, only
from bezierplan.figures.panels import workspace as workspaces
from bezierplan.figures.panels.paths import steps
from bezierplan.schema.model import Function, Metric, Whole, value
from bezierplan.workspaces.problem import Path, Problem

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results
    from bezierplan.running.chunk import Chunk


# Contour lines below a track, from the lowest to the highest.
_LEVELS = 14

# Room beyond what leaves the workspace, as a share of its side.
_MARGIN = 0.03

# Side of the square that shows paths, as a share of their extent.
_CLOSE = 1.2

_NAMES = ("first run", "second run", "third run", "fourth run", "fifth run")
_FIRST = style.mark("o", 7, style.BLUE, markerfacecolor="none", markeredgewidth=1.3)


class Options(RunsPanel):
    to_scale: ClassVar[bool] = True
    rerun: ClassVar[bool] = True
    tracks: ClassVar[bool] = True
    one: ClassVar[tuple[str, ...]] = ("problem", "method")

    data: Function = Field(
        None,
        description="the name of a function of the study's module that returns a landscape, "
        "called with the runs",
    )
    by: Metric = Field(
        description="the name of a metric: of the feasible runs the best one of each of its "
        "commonest values is drawn"
    )
    runs: Annotated[int, value(lambda given: type(given) is int and 1 <= given <= 5, "")] = Field(
        description="of how many of these values, a whole number from 1 to 5"
    )
    point: Whole = Field(
        None,
        description="the number of the control point whose way is drawn, at least 0; left out: "
        "first and last path",
    )

    def source(self, sources: Sources) -> Results | tuple[Results, pd.DataFrame]:
        """Results, if a landscape is asked for with the function's table of them."""
        results = super().source(sources)
        return results if self.data is None else (results, sources.functions[self.data](results))


def data(source: Results | tuple[Results, pd.DataFrame], options: Options) -> pd.DataFrame:
    """What is drawn, one row per place; columns: problem, method, candidates (feasible runs),
    groups (values of the metric among them), part, run (its id), length (of the run's path, in
    units), iteration, x, y (in the workspace's unit), objective (of nodes, in units).

    Parts: start, target; way, a control point of the best path after iteration 0, 1, ...; without a
    point: path, points along the best path after iteration 0 and after the last one; node, of the
    landscape below a track.

    The runs are reproduced, because no table keeps their intermediate states. source: runs with
    their jobs, of one problem and one method whose planner has `track`; optionally with the table
    of a landscape, as in `landscape.data`. Raises ValueError for runs of several problems or
    methods, for a point that the curve does not have, and if a reproduced run ends in a different
    path.
    """
    import pandas as pd

    from bezierplan.analysis.results import Results, pick

    results, table = (source, None) if isinstance(source, Results) else source
    problem = results.problems[only(results.runs, "problem")]
    method = only(results.runs, "method")
    feasible = results.runs[results.runs["feasible"]]
    groups = metrics.values(feasible, options.by, results.problems)
    parts = [workspaces.ends(problem)]
    for group in _commonest(groups)[: options.runs]:
        run = pick(feasible[groups == group], {"lowest": "objective"})
        parts.append(_part(run, _tracked(run, results.jobs[method], problem), options.point))
    if table is not None:
        parts.append(table[table["part"] == "node"])
    names = {
        "problem": problem.name,
        "method": method,
        "candidates": len(feasible),
        "groups": groups.nunique(),
    }
    columns = ["part", "run", "length", "iteration", "x", "y", "objective"]
    return (
        pd.concat(parts, ignore_index=True)
        .reindex(columns=columns)
        .assign(**names)[[*names, *columns]]
    )


def _commonest(groups: pd.Series) -> list[float]:
    """The distinct values, the commonest first, ties by size."""
    counts = groups.value_counts().rename_axis("group").reset_index(name="count")
    return counts.sort_values(["count", "group"], ascending=[False, True])["group"].to_list()


def _tracked(run: pd.Series, chunk: Chunk, problem: Problem) -> list[Path]:
    """The best path after each iteration of a run, reproduced from its chunk."""
    from bezierplan.running import execution

    condition = next(each for each in chunk.conditions() if each.name == run["condition"])
    repeat = int(run["repeat"])
    track = execution.track(chunk, condition, repeat, problem)
    execution.refuse_other_path(run, track[-1])
    return [Path(run["path_curve"], points) for points in track]


def _part(run: pd.Series, paths: list[Path], point: int | None) -> pd.DataFrame:
    """Rows of one run."""
    import pandas as pd

    if point is None:
        drawn = [
            pd.DataFrame(steps(paths[i]), columns=["x", "y"]).assign(part="path", iteration=i)
            for i in (0, len(paths) - 1)
        ]
    elif 0 <= point < len(paths[0].points):
        way = pd.DataFrame([path.points[point] for path in paths], columns=["x", "y"])
        drawn = [way.assign(part="way", iteration=range(len(paths)))]
    else:
        raise ValueError(
            f"point: {point}; "
            f"expected 0 to {len(paths[0].points) - 1}, a control point of the curve"
        )
    return pd.concat(drawn, ignore_index=True).assign(run=run["id"], length=run["length"])


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    workspace = scene.problems[options.experiment][frame["problem"].iloc[0]].workspace
    if (frame["part"] == "node").any():
        x, y, values = landscape.nodes(frame)
        levels = np.geomspace(values.min(), values.max(), _LEVELS)
        axes.contour(x, y, values, levels=levels, colors="0.72", linewidths=0.5, zorder=0.4)
    workspaces.shade(axes, workspaces.parts(workspace), outlines=options.point is not None)
    workspaces.scale(axes, workspace.unit)
    for end, look in (("start", workspaces.START), ("target", workspaces.TARGET)):
        places = frame[frame["part"] == end]
        axes.plot(places["x"], places["y"], **look)
    runs = frame["run"].dropna().unique()
    looks = [{"color": style.BLACK, "linestyle": "-"}, *style.lines(list(_NAMES))[1:]]
    notes = []
    for run, name, look in zip(runs, _NAMES, looks):
        own = frame[frame["run"] == run]
        look = {"color": look["color"], "linestyle": look["linestyle"]}
        _draw_way(axes, own[own["part"] == "way"], look | {"label": name})
        _draw_paths(axes, own[own["part"] == "path"], look | {"label": name})
        notes.append(
            f"{name}: repeat {run.rpartition('/')[2]}, length {own['length'].iloc[0]:.2f} "
            f"{workspace.unit}"
        )
    if options.point is None:
        _look_closer(axes, frame[frame["part"].isin(["path", "start", "target"])])
    else:
        _show_all(axes, frame[frame["part"] == "way"])
    row = frame.iloc[0]
    if not len(runs):
        return Note("no feasible run")
    notes.append(f"{row['groups']:g} classes among {row['candidates']:g} feasible runs")
    return Note("", "; ".join(notes))


def _look_closer(axes: Axes, drawn: pd.DataFrame) -> None:
    """Show a square about what is drawn."""
    places = drawn[["x", "y"]].to_numpy(dtype=float)
    centre = (places.min(axis=0) + places.max(axis=0)) / 2
    half = _CLOSE * max(np.ptp(places, axis=0).max(), _MARGIN) / 2
    axes.set_xlim(centre[0] - half, centre[0] + half)
    axes.set_ylim(centre[1] - half, centre[1] + half)


def _show_all(axes: Axes, drawn: pd.DataFrame) -> None:
    """Widen the panel, with a small margin, to what leaves the workspace or ends at its edge, where
    a mark would be cut.
    """
    for (low, high), places, show in (
        (axes.get_xlim(), drawn["x"], axes.set_xlim),
        (axes.get_ylim(), drawn["y"], axes.set_ylim),
    ):
        room = _MARGIN * (high - low)
        show(
            places.min() - room if places.min() < low + room else low,
            places.max() + room if places.max() > high - room else high,
        )


def _draw_way(axes: Axes, way: pd.DataFrame, look: dict) -> None:
    """The track of a control point, from a circle with an arrow to a cross."""
    if way.empty:
        return
    axes.plot(way["x"], way["y"], linewidth=1.1, marker=".", markersize=4, zorder=5, **look)
    first, last = way.iloc[0], way.iloc[-1]
    axes.plot(first["x"], first["y"], label="first position", zorder=6, clip_on=False, **_FIRST)
    cross = style.mark("X", 7, look["color"], markeredgecolor=style.FREE)
    axes.plot(last["x"], last["y"], label="last position", zorder=6, clip_on=False, **cross)
    inwards = np.sign(
        [first["x"] - np.mean(axes.get_xlim()), first["y"] - np.mean(axes.get_ylim())]
    )
    arrow = {"arrowstyle": "-|>", "color": style.BLUE, "linewidth": 1.1, "shrinkB": 4}
    axes.annotate(
        "",
        first[["x", "y"]].astype(float),
        xytext=-22 * inwards,
        textcoords="offset points",
        arrowprops=arrow,
        zorder=6,
    )


def _draw_paths(axes: Axes, paths: pd.DataFrame, look: dict) -> None:
    """The first path of a run, thin and dotted, and the last one, thick."""
    for iteration, own in paths.groupby("iteration"):
        last = iteration == paths["iteration"].max()
        thin = {"linewidth": 0.9, "linestyle": (0, (1, 1)), "label": "path after iteration 0"}
        own_look = look | ({"linewidth": 1.7} if last else thin)
        axes.plot(own["x"], own["y"], zorder=5 if last else 4, clip_on=True, **own_look)
