"""Pictures of maps, problems and paths, in the style of the studies' figures."""

from __future__ import annotations

import base64
import io
from typing import TYPE_CHECKING, Any

import numpy as np

from bezierplan.figures import style

# What draws takes long to import, so functions import it.
if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path as File

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from bezierplan.workspaces.problem import Path, Problem, Workspace

_MOST = 12
"""Problems in a picture."""
_NOTEBOOK = {"dpi": 140, "format": "webp"}
"""How pictures are written into a notebook, which keeps them all: as a seventh of an SVG."""


def draw(
    home: Problem | Workspace,
    axes: Axes | None = None,
    path: Path | None = None,
    shortest: np.ndarray | None = None,
    collision: tuple[float, float] | None = None,
    *,
    map: bool = True,
    **look: Any,
) -> Axes:
    """Draw a map, or a problem with a path, and return the axes.

    axes: new ones if left out. shortest: points (n, 2) of the exact shortest path. collision: the
    path's first one. map: if False, the map, the ends and the exact shortest path are left out.
    look: properties of matplotlib for the path.
    """
    from bezierplan.figures.panels import paths, workspace

    if axes is None:
        import matplotlib.pyplot as plt

        axes = plt.figure(layout="constrained").add_subplot()
    parts: dict[str, Any] = {"path": paths.sample_path(path) if path else np.empty((0, 2))}
    if map:
        workspace.draw_workspace(axes, getattr(home, "workspace", home))
        ends = {name: [getattr(home, name)] for name in workspace.ENDS if hasattr(home, name)}
        parts |= ends if shortest is None else ends | {"bound": shortest}
    if collision:
        parts["collision"] = [collision]
    looks = paths.LOOK | {"path": paths.LOOK["path"] | look}
    style.draw_parts(axes, workspace.list_points(parts), looks)
    return axes


def add_legend(figure: Figure) -> None:
    """Add one legend below all panels, in which each label stands once."""
    named: dict[str, Any] = {}
    for axes in figure.axes:
        handles, labels = axes.get_legend_handles_labels()
        named |= dict(zip(labels, handles))
    columns = 2 if len(figure.axes) == 1 else 4
    figure.legend(named.values(), named, loc="outside lower center", ncols=columns)


def build_html(text: str, *draws: Callable[..., object]) -> str:
    """Return HTML that shows a picture, one axes for each function that draws, above a text."""
    drawn = io.BytesIO()
    save(drawn, *draws, **_NOTEBOOK)
    data = base64.b64encode(drawn.getvalue()).decode()
    return f'<img alt="map" src="data:image/webp;base64,{data}">{text}'


def save(file: File | io.BytesIO, *draws: Callable[..., object], **how: Any) -> None:
    """Let the first `_MOST` functions draw, each on axes of its own, and save the picture with one
    legend.

    file: its suffix names the kind of picture. draws: functions that draw on given axes. how:
    options of matplotlib's `savefig`.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    draws = draws[:_MOST]
    columns = min(len(draws), 3)
    width = style.WIDTHS["two" if columns > 1 else "one"]
    rows = -(-len(draws) // columns)
    with mpl.rc_context(style.SETTINGS):
        figure = Figure(figsize=(width, width * rows / columns), layout="constrained")
        for number, each in enumerate(draws, 1):
            each(axes=figure.add_subplot(rows, columns, number))
        add_legend(figure)
        figure.savefig(file, bbox_inches="tight", **{"dpi": 300} | how)
