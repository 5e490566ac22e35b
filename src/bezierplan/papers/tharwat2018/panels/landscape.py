"""The objective over two coordinates, as contour lines, with its local minima."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field

from bezierplan.figures import style
from bezierplan.figures.groups import describe_axis
from bezierplan.figures.panels import Note, RunsPanel, Sources, find_only
from bezierplan.figures.panels import workspace as workspaces
from bezierplan.schema.model import Function

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable

    from bezierplan.analysis.results import Results


# Steps from the lowest to the highest value, equal on a logarithmic scale.
_STEPS = 16

_LOOK = {
    "minimum": style.HOLLOW | {"label": "local minimum"},
    "lowest": style.build_mark_style(
        "X", 7, style.RED, markeredgecolor=style.FREE, label="lowest value"
    ),
    "fixed": style.build_mark_style(
        "o", 4.5, style.BLUE, markerfacecolor=style.FREE, label="fixed control point"
    ),
    **workspaces.ENDS,
}


class Options(RunsPanel):
    """Keys of the panel."""

    one = ("problem",)

    data: Function = Field(
        description="the name of a function of the study's module "
        "that returns a table, called with the runs"
    )

    def source(self, sources: Sources) -> tuple[Results, pd.DataFrame]:
        """Return results, with the function's table of them."""
        results = super().source(sources)
        return results, sources.functions[self.data](results)


def data(source: tuple[Results, pd.DataFrame], options: Options) -> pd.DataFrame:
    """Make the table that is drawn, one row per place.

    Columns: problem, part, x, y (in the workspace's unit), objective (of nodes, in units). Parts:
        node (of a grid, y changing fastest), minimum (the lowest node of a valley), lowest (the
        lowest node), fixed (control points that do not move), start, target.

    source: runs of one problem, and a function's table with the columns part, x, y and objective.

    Raises ValueError for runs of several problems.
    """
    import pandas as pd

    results, table = source
    problem = results.problems[find_only(results.runs, "problem")]
    drawn = pd.concat([table, workspaces.list_ends(problem)], ignore_index=True)
    return drawn.assign(problem=problem.name)[["problem", "part", "x", "y", "objective"]]


def list_nodes(frame: pd.DataFrame) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return coordinates x (n,) and y (m,) of a grid of nodes, and the objective there (m, n)."""
    grid = frame[frame["part"] == "node"].pivot(index="y", columns="x", values="objective")
    return grid.columns.to_numpy(), grid.index.to_numpy(), grid.to_numpy()


def build_scale(values: np.ndarray) -> ScalarMappable:
    """Build a colour scale of values, the higher the lighter, on a logarithmic scale."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm

    return ScalarMappable(LogNorm(values.min(), values.max()), style.SCALE)


def choose_round_numbers(values: np.ndarray) -> np.ndarray:
    """Return the numbers 1, 2, 5, 10, ... between the lowest and the highest of positive values.

    >>> choose_round_numbers(np.array([7.6, 310.0])).tolist()
    [10.0, 20.0, 50.0, 100.0, 200.0]
    """
    powers = np.arange(np.floor(np.log10(values.min())), np.log10(values.max()))
    numbers = np.outer(10.0**powers, [1, 2, 5]).ravel()
    return numbers[(numbers >= values.min()) & (numbers <= values.max())]


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw contour lines of the objective, with its minima and the workspace's outlines."""
    x, y, values = list_nodes(frame)
    colours = build_scale(values)
    # In equal steps nearly all lines would lie on the peaks of the penalty.
    levels = np.geomspace(values.min(), values.max(), _STEPS)
    axes.contourf(x, y, values, levels=levels, norm=colours.norm, cmap=colours.cmap)
    axes.contour(x, y, values, levels=levels, colors="#FFFFFF", linewidths=0.3)
    workspaces.draw_workspace(axes, options.find_workspace(frame, scene), outlines=True)
    style.draw_parts(axes, frame, _LOOK, clip_on=False, zorder=4)
    bar = axes.figure.colorbar(colours, cax=axes.inset_axes([1.04, 0, 0.05, 1]))
    numbers = choose_round_numbers(values)
    bar.set_ticks(numbers, labels=[f"{number:g}" for number in numbers])
    bar.minorticks_off()
    bar.set_label(describe_axis("objective", scene))
    return describe_minima(frame, scene.unit)


def describe_minima(frame: pd.DataFrame, unit: str) -> Note:
    """Describe the range of the objective, and its number of local minima."""
    values = frame.loc[frame["part"] == "node", "objective"]
    return Note(
        "",
        f"{values.min():.2f} to {values.max():.0f} {unit}; local minima: "
        f"{(frame['part'] == 'minimum').sum()}, nodes: {len(values)}",
    )
