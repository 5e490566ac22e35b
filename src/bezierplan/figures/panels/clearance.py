"""The least distance to an obstacle in each step of a drive in a world that moves, as a line for
each method.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field

from bezierplan.figures import style
from bezierplan.figures.panels import Note, RunsPanel, find_only
from bezierplan.schema.model import Repeat

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


class Options(RunsPanel):
    rerun = True
    one = ("problem",)
    drives = True

    repeat: Repeat = Field(
        0, description="which run of each method is shown, a whole number; left out: 0"
    )


def data(results: Results, options: Options) -> pd.DataFrame:
    """Return one row per step of the drives, which run again.

    Columns: problem, method, run (its id), step (its end), clearance (least distance to an obstacle
    in it, in units, negative inside a circle), arrived.

    Raises ValueError for runs of several problems.
    """
    import pandas as pd

    from bezierplan.running import execution

    problem = find_only(results.runs, "problem")
    place = results.problems[problem], results.worlds[problem]
    parts = []
    for _, run in results.runs[results.runs["repeat"] == options.repeat].iterrows():
        ride, verdict = execution.drive_again(results.jobs[run["method"]], run, *place)
        columns = {
            "problem": problem,
            "method": run["method"],
            "run": run["id"],
            "step": np.arange(1, len(verdict.clearance) + 1),
            "clearance": verdict.clearance,
            "arrived": ride.arrived,
        }
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw a line for each method; a hollow mark ends a drive that does not arrive."""
    for _, own, look in style.list_groups(frame, "method", options, scene):
        bare = look | {"marker": "", "linewidth": 1.0, "label": None}
        axes.plot(own["step"], own["clearance"], **bare)
        end, arrived = own[-1:], bool(own["arrived"].iloc[-1])
        hollow = {} if arrived else {"markerfacecolor": style.FREE}
        axes.plot(end["step"], end["clearance"], zorder=4, **look | hollow)
        if not arrived:
            axes.plot([], [], label="hollow: ends without arrival", **style.HOLLOW)
    axes.axhline(0.0, label="surface of an obstacle", **style.BOUND)
    axes.set_xlabel("step")
    axes.set_ylabel(f"least distance to an obstacle ({scene.unit})")
    axes.grid(visible=True)
    return Note("", f"runs {', '.join(frame['run'].unique())}")
