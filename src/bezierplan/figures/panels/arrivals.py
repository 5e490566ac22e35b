"""When robots arrive, against a numeric factor, beside the earliest arrival found with the future known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from bezierplan.figures import style
from bezierplan.figures.panels import RunsPanel
from bezierplan.figures.panels.lines import axis_label, interval_band, runs_note, summary
from bezierplan.study.model import Column

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


class Options(RunsPanel):
    """Keys of a panel."""

    x: Column = Field(description="a column of numbers of the runs table")
    hue: Column = Field(description="a column of the runs table: a line for each of its values")


def data(results: Results, *, x: str, hue: str) -> pd.DataFrame:
    """One row per point; columns: those of `lines.summary` for the mean arrival of the runs that arrive without a collision, and part:
    arrival, or bound, the mean over all problems of the earliest arrival found with the future known.
    """
    import pandas as pd

    frame = summary(results, [hue, x], "arrival", "mean").assign(part="arrival")
    problems = results._replace(runs=results.runs.drop_duplicates("problem"))
    return pd.concat([frame, summary(problems, [x], "clairvoyant_arrival", "mean").assign(part="bound")], ignore_index=True)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, panel: dict) -> str:
    """Draw the rows of `data`; returns the note below the panel's title."""
    x, hue = panel["x"], panel["hue"]
    arrivals, bound = frame[frame["part"] == "arrival"], frame[frame["part"] == "bound"]
    groups = style.in_order(arrivals[hue], panel)
    for group, look in zip(groups, style.lines(groups)):
        own = arrivals[arrivals[hue] == group]
        interval_band(axes, own[x], own["low95"], own["high95"], look["color"], "95 % interval")
        axes.plot(own[x], own["value"], zorder=3, **look | {"label": style.printed(group, hue, scene.labels)})
    axes.plot(bound[x], bound["value"], zorder=4, label="earliest arrival, future known", **style.BOUND)
    axes.set_xticks(sorted(frame[x].unique()))
    axes.set_xlabel(axis_label(x, scene))
    axes.set_ylabel(axis_label("arrival", scene, "mean"))
    axes.grid(visible=True)
    return runs_note(arrivals, "mean", "point")
