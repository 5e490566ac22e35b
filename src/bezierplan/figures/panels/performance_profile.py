"""Performance profiles: the share of problems on which a method is at most so many times worse than
the best one (Dolan and More 2002).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis import running_time
from bezierplan.figures import seen, style
from bezierplan.figures.panels import Note, RunsPanel
from bezierplan.schema.model import Positive, wrong

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results

# Room beyond the largest ratio, as a factor of the axis, so that the level that a line ends at can
# be seen.
_ROOM = 1.15

# Distance of marks at the end of lines, as a share of the axis.
_MARK = 0.03

# Ratios that the axis may name.
_RATIOS = (1.01, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 3.0, 5.0, *(10.0**power for power in range(1, 13)))

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
        if (self.cost == "length") == ("within" in self.model_fields_set):
            alone = self.cost == "length"
            why = "is for evaluations and cpu_s alone" if alone else f"cost {self.cost} needs it"
            raise wrong(f"within: {why}")
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
    table = running_time.by_problem(runs, values)
    ratios, rows = running_time.ratios(table), []
    solved = int(np.isfinite(ratios).any(axis=1).sum())
    for method in ratios:
        steps = np.sort(ratios[method][np.isfinite(ratios[method])].to_numpy())
        counts = {"problems": len(ratios), "reached": len(steps), "solved": solved}
        level = np.searchsorted(steps, np.unique(steps), side="right") / len(ratios)
        rows += [
            {"method": method, "ratio": ratio, "share": share, **counts}
            for ratio, share in zip(np.unique(steps), level)
        ]
        if not len(steps):
            rows.append({"method": method, "ratio": 1.0, "share": 0.0, **counts})
    return pd.DataFrame(rows)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    end = max(frame["ratio"].max(), 1.01) ** _ROOM
    methods = style.in_order(frame["method"], options.where)
    for number, (method, look) in enumerate(zip(methods, style.lines(methods, scene.looks))):
        own = frame[frame["method"] == method]
        places = np.concatenate([[1.0], own["ratio"], [end]])
        heights = np.concatenate([[0.0], own["share"], own["share"].iloc[-1:]])
        # One mark each, at the end, side by side: lines may end at one height, and marks on the way
        # would look like data; not before the last step, where the line is lower.
        axes.plot(places, heights, drawstyle="steps-post", clip_on=False, **look | {"marker": ""})
        aside = max(end ** (1 - _MARK * (number + 0.5)), places[-2])
        axes.plot(aside, heights[-1], clip_on=False, **look | {"linestyle": ""})
        axes.plot([], [], label=scene.labels.get(method, method), **look)
    axes.set_xscale("log")
    axes.set_xlim(1, end)
    _name_ratios(axes, end)
    axes.set_ylim(-0.04, 1.04)  # a line along an edge stays visible
    axes.set_xlabel(_AXES[options.cost])
    axes.set_ylabel("share of problems")
    axes.grid(visible=True)
    counts = frame.iloc[0]
    words = f"{counts['problems']:g} problem{'s' if counts['problems'] != 1 else ''}"
    names = [scene.labels.get(method, method) for method in methods]
    best = [
        frame.loc[(frame["method"] == method) & (frame["ratio"] == 1), "share"].max()
        for method in methods
    ]
    of_best = dict(zip(names, np.nan_to_num(best)))
    at_one = seen.extremes("share of problems on which it is the best", of_best)
    told = (
        f"{words}; solved by the median run of any method"
        if options.cost == "length"
        else f"to within {100 * options.within:g} % of the exact shortest path; {words}, solved by "
        "any method"
    )
    return Note("", f"{told}: {counts['solved']:g}", at_one)


def _name_ratios(axes: Axes, end: float) -> None:
    """A few ratios as plain numbers, with room for their digits."""
    from matplotlib.ticker import FixedLocator, NullLocator

    named = [1.0]
    for value in _RATIOS:
        # A quarter of the axis holds the longest of them.
        if value <= end and math.log(value / named[-1]) >= 0.24 * math.log(end):
            named.append(value)
    axes.xaxis.set_major_locator(FixedLocator(named))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xticks(named, [f"{value:,.10g}" for value in named])
