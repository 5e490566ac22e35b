"""Performance profiles: the share of problems on which a method's path is at most so many times
longer than the shortest of all methods (Dolan and More 2002).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from bezierplan.figures import glance, style
from bezierplan.figures.groups import by_problem, measured
from bezierplan.figures.panels import Note, RunsPanel

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results

# Room beyond the largest ratio, as a factor of the axis, so that the level that a line ends at can
# be seen, and the distance of marks there.
_ROOM, _MARK = 1.15, 0.03

# A larger range of ratios is shown on a logarithmic axis.
_WIDE = 3


class Options(RunsPanel):
    pass


def data(results: Results, options: Options) -> pd.DataFrame:
    """One row per step of a method's profile; columns: method, ratio, share, problems, reached,
    solved.

    share: of the problems on which the length of the method's median run is at most ratio times the
    shortest of all methods. A problem is a condition; the length of a path that is not certified is
    infinite. problems: all of them; reached: those on which the method's length is finite; solved:
    those with a finite length of any method. The others count for no method.

    Raises ValueError if a method lacks runs on a problem.
    """
    import pandas as pd

    lengths = ratios(by_problem(measured(results, "certified_length")))
    problems, solved = len(lengths), int(np.isfinite(lengths).any(axis=1).sum())
    rows = []
    for method, own in lengths.items():
        steps, times = np.unique(own[np.isfinite(own)], return_counts=True)
        if not len(steps):
            steps, times = np.ones(1), np.zeros(1)
        for ratio, reached in zip(steps, np.cumsum(times)):
            rows.append((method, ratio, reached / problems, problems, int(times.sum()), solved))
    columns = ["method", "ratio", "share", "problems", "reached", "solved"]
    return pd.DataFrame(rows, columns=columns)


def ratios(lengths: pd.DataFrame) -> pd.DataFrame:
    """Each length over the shortest of its row (Dolan and More 2002, performance ratio); infinite
    where a method or all of them fail.
    """
    return lengths.div(lengths.min(axis=1), axis=0).fillna(np.inf)


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
    axes.set_xlabel("length / shortest length of all methods")
    axes.set_ylabel("share of problems")
    axes.grid(visible=True)
    row = frame.iloc[0]
    name = "share of problems on which it is the best"
    best = frame.assign(share=frame["share"].where(frame["ratio"] == 1, 0.0))
    best = best.groupby("method", as_index=False)["share"].max()
    return Note(
        "",
        f"{row['problems']:g} problems; solved by the median run of any method: {row['solved']:g}",
        glance.extremes(name, best, "method", "share", scene.labels),
    )
