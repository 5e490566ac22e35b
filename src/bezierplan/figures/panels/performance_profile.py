"""Performance profiles: the share of problems on which a method is at most so many times worse than
the best one (Dolan and More 2002).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis import running_time
from bezierplan.figures import glance, style
from bezierplan.figures.panels import Note, RunsPanel
from bezierplan.schema.model import Positive, wrong

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results

# Room beyond the largest ratio, as a factor of the axis, so that the level that a line ends at can
# be seen, and the distance of marks there.
_ROOM, _MARK = 1.15, 0.03

# A larger range of ratios is shown on a logarithmic axis.
_WIDE = 3

_AXES = {
    "length": "length / shortest length of all methods",
    "evaluations": "expected evaluations / fewest of all methods",
    "cpu_s": "expected CPU time / least of all methods",
}


class Options(RunsPanel):
    cost: Literal["length", "evaluations", "cpu_s"] = Field(
        description="what is compared: length (of the median run), or the expected evaluations or "
        "cpu_s to a path within a share of the exact bound"
    )
    within: Positive = Field(
        None, description="with evaluations and cpu_s, that share, a number above 0, such as 0.05"
    )

    @model_validator(mode="after")
    def _check_within(self) -> Options:
        if (self.cost == "length") == (self.within is not None):
            raise wrong(f"within: expected it for evaluations and cpu_s alone, not for {self.cost}")
        return self


def data(results: Results, options: Options) -> pd.DataFrame:
    """One row per step of a method's profile; columns: method, ratio, share, problems, reached,
    solved.

    share: of the problems on which the method's cost is at most ratio times the best one. A problem
    is a condition. The length is that of the median run, infinite if it is not certified; the other
    costs are expected running times (`analysis.running_time`), infinite if no run is within the
    share. problems: all of them; reached: those on which the method's cost is finite; solved: those
    with a finite cost of any method. The others count for no method.

    Raises ValueError if a method lacks runs on a problem.
    """
    import pandas as pd

    runs = results.runs
    values = (
        running_time.certified_length(runs, results.problems)
        if options.within is None
        else running_time.work_to(options.cost, options.within, runs, results.problems)
    )
    ratios, rows = running_time.ratios(running_time.by_problem(runs, values)), []
    problems, solved = len(ratios), int(np.isfinite(ratios).any(axis=1).sum())
    for method, own in ratios.items():
        steps, times = np.unique(own[np.isfinite(own)], return_counts=True)
        if not len(steps):
            steps, times = np.ones(1), np.zeros(1)
        for ratio, reached in zip(steps, np.cumsum(times)):
            rows.append((method, ratio, reached / problems, problems, int(times.sum()), solved))
    columns = ["method", "ratio", "share", "problems", "reached", "solved"]
    return pd.DataFrame(rows, columns=columns)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    end = max(frame["ratio"].max(), 1.01) ** _ROOM
    groups = style.groups(frame, "method", options.where, scene)
    for number, (_, own, look) in enumerate(groups):
        places = [1.0, *own["ratio"], end]
        heights = [0.0, *own["share"], own["share"].iloc[-1]]
        # One mark each, at the end, side by side: lines may end at one height, and marks on the way
        # would look like data; not before the last step, where the line is lower.
        bare = look | {"marker": "", "label": None}
        axes.plot(places, heights, drawstyle="steps-post", clip_on=False, **bare)
        aside = max(end ** (1 - _MARK * (number + 0.5)), places[-2])
        axes.plot(aside, heights[-1], clip_on=False, **look)
    style.measure(axes.xaxis, "log" if end > _WIDE else "linear")
    axes.set_xlim(1, end)
    axes.set_ylim(-0.04, 1.04)  # a line along an edge stays visible
    axes.set_xlabel(_AXES[options.cost])
    axes.set_ylabel("share of problems")
    axes.grid(visible=True)
    row = frame.iloc[0]
    solved = (
        "solved by the median run of any method"
        if options.within is None
        else f"solved to within {100 * options.within:g} % of the exact shortest path by any method"
    )
    name = "share of problems on which it is the best"
    best = frame.assign(share=frame["share"].where(frame["ratio"] == 1, 0.0))
    best = best.groupby("method", as_index=False)["share"].max()
    return Note(
        "",
        f"{row['problems']:g} problems; {solved}: {row['solved']:g}",
        glance.extremes(name, best, "method", "share", scene.labels),
    )
