"""A panel that a function of a study's `panels.py` draws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from bezierplan.figures import style
from bezierplan.figures.panels import Note, RunsPanel
from bezierplan.schema.model import Metric, build_list_type, build_name_type

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


class Options(RunsPanel):
    function: build_name_type("drawing") = Field(
        description="the name of a function of the study's `panels.py`, called with axes of "
        "matplotlib, a table of the runs (method, problem, condition, repeat and metrics), and by "
        "method keywords of `axes.plot`: its colour, marker and label in all figures"
    )
    metrics: build_list_type(Metric) = Field(description="a list of metrics, columns of that table")


def data(results: Results, options: Options) -> pd.DataFrame:
    """Return the table of the runs, one row each: method, problem, condition, repeat and the
    metrics.
    """
    from bezierplan.analysis import metrics

    runs = results.runs.sort_values("id")
    values = {
        name: metrics.compute_values(runs, name, results.problems) for name in options.metrics
    }
    return (
        runs[["method", "problem", "condition", "repeat"]].assign(**values).reset_index(drop=True)
    )


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Let the study's function draw, and put the text that it may return into the notes."""
    looks = {name: look for name, _, look in style.list_groups(frame, "method", options, scene)}
    return Note("", scene.functions[options.function](axes, frame, looks) or "")
