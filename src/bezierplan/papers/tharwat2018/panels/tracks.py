"""How runs arrived at their paths: the track of one control point of the best path over the
iterations.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from bezierplan.analysis import metrics
from bezierplan.figures import style
from bezierplan.figures.panels import Note, RunsPanel, find_only
from bezierplan.figures.panels import workspace as workspaces
from bezierplan.schema.model import Metric, Whole

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Side of the square that is seen, as a share of the extent of what is drawn.
_CLOSE = 1.2

# The two runs as the paper has them.
_LINES = {
    name: {"color": colour, "linestyle": dashes}
    for name, colour, (_, dashes, _) in zip(
        ("first run", "second run"), (style.BLACK, style.RED), style.LOOKS.values()
    )
}
_FIRST = style.build_mark_style(
    "o", 7, style.BLUE, markerfacecolor="none", markeredgewidth=1.3, label="first position"
)


class Options(RunsPanel):
    """Keys of the panel."""

    rerun = True
    one = ("problem", "method")

    by: Metric = Field(
        description="the name of a metric: of the feasible runs the best one of each of its "
        "two commonest values is drawn"
    )
    point: Whole = Field(
        description="the number of the control point whose way is drawn, at least 0"
    )


def data(results: Results, options: Options) -> pd.DataFrame:
    """Repeat the runs that are shown, and make the table that is drawn, one row per place.

    Columns: problem, method, candidates (feasible runs), groups (values of the metric among them),
        part, run (its id), length (of the run's path, in units), iteration, x, y (in the
        workspace's unit). Parts: start, target; way, a control point of the best path after
        iteration 0, 1, ...

    The runs are reproduced, because no table keeps their intermediate states.

    results: runs with their jobs, of one problem and one method whose planner has `track`.

    Raises ValueError for runs of several problems or methods, for a point that the curve does not
    have, and if a reproduced run ends in a different path.
    """
    import pandas as pd

    from bezierplan.analysis.results import pick
    from bezierplan.running import execution

    problem = results.problems[find_only(results.runs, "problem")]
    method = find_only(results.runs, "method")
    feasible = results.runs[results.runs["feasible"]]
    groups = metrics.compute_values(feasible, options.by, results.problems)
    parts = [workspaces.list_ends(problem)]
    # The commonest first, ties by size.
    ranked = groups.value_counts().sort_index().sort_values(ascending=False, kind="stable")
    for group in ranked.index[: len(_LINES)]:
        run = pick(feasible[groups == group], {"lowest": "objective"})
        paths = execution.track_again(results.jobs[method], run, problem)
        if options.point >= len(paths[0]):
            raise ValueError(f"point: {options.point}; expected less than {len(paths[0])}")
        way = pd.DataFrame([path[options.point] for path in paths], columns=["x", "y"])
        named = {"part": "way", "iteration": range(len(paths))}
        parts.append(way.assign(run=run["id"], length=run["length"], **named))
    columns = ["part", "run", "length", "iteration", "x", "y"]
    drawn = pd.concat(parts, ignore_index=True).reindex(columns=columns)
    names = {
        "problem": problem.name,
        "method": method,
        "candidates": len(feasible),
        "groups": groups.nunique(),
    }
    return drawn.assign(**names)[[*names, *columns]]


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the tracks with both ends of each, and return their lengths as a note."""
    home = options.find_workspace(frame, scene)
    workspaces.draw_workspace(axes, home)
    style.draw_parts(axes, frame, workspaces.ENDS)
    notes = []
    for (run, way), (name, look) in zip(frame.groupby("run", sort=False), _LINES.items()):
        axes.plot(way["x"], way["y"], linewidth=1.1, marker=".", markersize=4, label=name, **look)
        cross = style.build_mark_style(
            "X", 7, look["color"], markeredgecolor=style.FREE, label="last position"
        )
        for end, mark in ((way[:1], _FIRST), (way[-1:], cross)):
            axes.plot(end["x"], end["y"], zorder=6, **mark)
        repeat, length = run.rpartition("/")[2], way["length"].iloc[0]
        notes.append(f"{name}: repeat {repeat}, length {length:.2f} {home.unit}")
    ends = frame[["x", "y"]].agg(["min", "max"])
    half = _CLOSE * (ends.loc["max"] - ends.loc["min"]).max() / 2
    for name, middle in ends.mean().items():
        axes.set(**{f"{name}lim": (middle - half, middle + half)})
    row = frame.iloc[0]
    notes.append(f"{row['groups']:g} classes among {row['candidates']:g} feasible runs")
    return Note("", "; ".join(notes))
