"""Methods by two measures that both should be small, such as length and CPU time: which of them
does no other beat in both?
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field

from bezierplan.analysis import naming, statistics
from bezierplan.figures import style
from bezierplan.figures.groups import axis_label, grouped, measured, values
from bezierplan.figures.panels import Note, RunsPanel
from bezierplan.schema.model import Metric
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    from collections.abc import Iterable

    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results

# Room beside a mark for the share of free paths, in points.
_BESIDE = 5


class Options(RunsPanel):
    x: Metric = Field("cpu_s", description="the name of a metric; left out: cpu_s")
    y: Metric = Field("gap", description="the name of a metric; left out: gap")


def data(results: Results, options: Options) -> pd.DataFrame:
    """One row a method; columns: those of `groups.grouped`; x, y (medians of its runs that have the
    metric); x_low, x_high, y_low, y_high (their 95 % bootstrap intervals); free (share of paths
    that the certified checker accepts); front (whether no other method is as good in both, and
    better in one).
    """

    def rows(group: Results) -> Iterable[dict[str, Any]]:
        row: dict[str, Any] = {"free": group.runs["feasible"].mean()}
        for axis in ("x", "y"):
            metric = getattr(options, axis)
            numbers = values(measured(group, metric))
            rng = generator(f"front/{metric}/{group.runs['method'].iloc[0]}")
            row[axis] = statistics.statistic("median", numbers)
            row[f"{axis}_low"], row[f"{axis}_high"] = statistics.interval("median", numbers, rng)
        yield row

    frame = grouped(results, ["method"], rows)
    return frame.assign(front=on_front(frame[["x", "y"]].to_numpy()))


def on_front(points: np.ndarray) -> np.ndarray:
    """Which points (n, 2) no other one dominates: none is at most as large in both coordinates and
    smaller in one. A point that is not finite is on no front.
    """
    finite = np.isfinite(points).all(axis=1)
    at_most = (points[:, None] <= points[None]).all(axis=2)
    smaller = (points[:, None] < points[None]).any(axis=2)
    return finite & ~(at_most & smaller & finite[:, None]).any(axis=0)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    for _, own, look in style.groups(frame, "method", options.where, scene):
        row = own.iloc[0]
        if not np.isfinite([row["x"], row["y"]]).all():
            continue
        errors = {
            f"{axis}err": [[row[axis] - row[f"{axis}_low"]], [row[f"{axis}_high"] - row[axis]]]
            for axis in ("x", "y")
        }
        axes.errorbar(row["x"], row["y"], **errors, **look | {"linestyle": "none"})
        axes.annotate(
            f"{100 * row['free']:.0f} %",
            (row["x"], row["y"]),
            (_BESIDE, _BESIDE),
            textcoords="offset points",
            fontsize="x-small",
        )
    style.measure(axes.xaxis, "log")
    style.measure(axes.yaxis, "log")
    axes.set_xlabel(axis_label(options.x, scene))
    axes.set_ylabel(axis_label(options.y, scene))
    axes.grid(visible=True)
    best = [
        naming.printed(name, "method", scene.labels) for name in frame["method"][frame["front"]]
    ]
    return Note(
        "",
        "median and 95 % interval; beside each mark the share of paths that are free",
        f"on the front: {', '.join(best)}" if best else "",
    )
