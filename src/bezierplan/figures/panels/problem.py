"""A problem: its workspace with start and target, and no path."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from bezierplan.figures import style
from bezierplan.figures.panels import Note, Panel, Sources
from bezierplan.figures.panels import workspace as workspaces
from bezierplan.schema.model import Line, build_name_type
from bezierplan.workspaces.problem import Problem

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


class Options(Panel):
    problem: build_name_type("drawn problem", Line) = Field(
        description="the name of a problem, followed by the number of a layout and that of its "
        "obstacles if it has layouts, such as `case1_0_20`"
    )
    letters: workspaces.Letters = None

    def source(self, sources: Sources) -> Problem:
        """Return the problem that the panel names."""
        return sources.problems[self.problem]


def data(problem: Problem, options: Options) -> pd.DataFrame:
    """Return the rows of start and target: part, x, y, problem (its name)."""
    return workspaces.list_ends(problem).assign(problem=problem.name)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data` in their workspace."""
    workspaces.draw_workspace(axes, scene.places[options.problem].workspace)
    style.draw_parts(axes, frame, workspaces.ENDS, clip_on=False)
    workspaces.draw_letters(axes, frame, options.letters)
    return Note()
