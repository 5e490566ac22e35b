"""One path on its map, in the style of the studies' figures."""

from __future__ import annotations

import io
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.figures import style
from bezierplan.figures.panels import paths, workspace
from bezierplan.workspaces.problem import Path, Problem

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path as File

    from matplotlib.axes import Axes


def draw(
    axes: Axes,
    problem: Problem,
    path: Path | None,
    shortest: np.ndarray,
    collision: tuple[float, float] | None,
) -> None:
    """The map, the exact shortest path (n, 2), the path, if any, and the first collision, if
    any.
    """
    workspace.draw_home(axes, problem.workspace)
    parts = {"path": paths.steps(path)} if path else {}
    parts |= {"bound": shortest, "start": [problem.start], "target": [problem.target]}
    if collision:
        parts["collision"] = [collision]
    style.draw_parts(axes, workspace.places(parts), paths.LOOK)


def html(draw: Callable[[Axes], object], lines: dict[str, str]) -> str:
    """What a function draws on axes, and lines by name, as HTML."""
    picture = io.StringIO()
    save(picture, draw)
    rows = "".join(f"<tr><th>{name}<td>{escape(text)}" for name, text in lines.items())
    return picture.getvalue()[picture.getvalue().index("<svg") :] + f"<table>{rows}</table>"


def save(file: File | io.StringIO, draw: Callable[[Axes], object]) -> None:
    """What a function draws on axes as a picture with a legend, of the kind that the file's suffix
    names; into text as SVG.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(style.SETTINGS):
        figure = Figure(figsize=2 * [style.WIDTHS["one"]], layout="constrained")
        axes = figure.add_subplot()
        draw(axes)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3)
        figure.savefig(file, dpi=300, format="svg" if isinstance(file, io.StringIO) else None)
