"""A drawing made of marks: the steps of a procedure, drawn by a function of the study, over a
workspace if the panel names one.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

from pydantic import Field

from bezierplan.figures import style
from bezierplan.figures.panels import Note, TablePanel
from bezierplan.figures.panels import workspace as workspaces
from bezierplan.schema.model import Line

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


COLUMNS = ["mark", "group", "role", "x", "y", "width", "height", "radius", "text", "label"]
# Colours of fills and lines, and marks of single points, by role. Neighbours differ in lightness or
# in shape.
_FILL = {
    "obstacle": {"facecolor": style.OCCUPIED, "edgecolor": "0.4"},
    "muted": {"facecolor": style.SURPLUS, "edgecolor": style.CELL_LINE},
    "accent": {"facecolor": style.LIGHT_BLUE, "edgecolor": style.BLUE},
}
_NO_FILL = {"facecolor": style.FREE, "edgecolor": "0.4"}
_LINE = {
    "first": style.OURS,
    "second": {"color": style.RED, "linestyle": style.DASHED, "linewidth": 1.3},
    "third": {"color": style.BLACK, "linestyle": style.DOTTED, "linewidth": 1.1},
    "accent": style.RUN_SHOWN,
    "muted": {"color": "0.6", "linestyle": (0, (4, 2)), "linewidth": 0.8},
    "note": {"color": style.BLACK, "linestyle": "-", "linewidth": 0.7},
}
_DOTS = {
    "start": style.build_mark_style("s", 6, style.BLACK),
    "target": style.build_mark_style("*", 10, style.BLACK),
    "first": style.build_mark_style("o", 4.5, style.BLUE),
    "second": style.build_mark_style("^", 5, style.RED),
    "third": style.build_mark_style("D", 4, style.BLACK),
    "accent": style.build_mark_style("X", 6.5, style.RED),
    "muted": style.build_mark_style("o", 3.5, "0.6"),
}


class Options(TablePanel):
    x_label: Line = Field(None, description="what the panel runs along, with its unit")
    y_label: Line = Field(None, description="what the panel's height shows, with its unit")


def data(marks: pd.DataFrame, options: Options) -> pd.DataFrame:
    """Return one row per mark, or per point of a line or arrow, in drawing order.

    Columns: `COLUMNS` and the function's own extra columns. mark: cell (a box about x, y of a width
    and a height), circle (about x, y, of a radius), line and arrow (through the points of a group),
    dots (marks at x, y), text (at x, y). role: the style: obstacle, start, target, first, second,
    third, accent, muted or note. label: its entry in the legend; empty for none.
    """
    return marks.reindex(columns=[*COLUMNS, *marks.columns.difference(COLUMNS, sort=False)])


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data` to scale, over their workspace if the panel has one."""
    axes.set_aspect("equal")
    alone = options.workspace is None
    if not alone:
        workspaces.draw_workspace(axes, scene.workspaces[options.workspace])
    # Groups of neighbouring rows, so that later rows of the table lie on top.
    roles, groups = (frame[name].astype("string").fillna("") for name in ("role", "group"))
    names = frame["mark"] + " " + roles + " " + groups
    changed = (names != names.shift()).cumsum()
    for level, (_, own) in enumerate(frame.groupby(changed, sort=True)):
        _draw_marks(axes, own, 3 + level / 1000)
    if alone:
        _fit(axes, frame)
    labels = {"x": options.x_label, "y": options.y_label}
    for name, label in labels.items():
        if label is not None:
            axes.set(**{f"{name}label": label})
        elif alone:
            axes.set(**{f"{name}ticks": []})
    axes.set_frame_on(not alone or any(labels.values()))
    return Note()


def _draw_marks(axes: Axes, rows: pd.DataFrame, zorder: float) -> None:
    """Draw neighbouring rows that share mark, group and role."""
    import pandas as pd
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Circle, Rectangle

    mark, role, label = rows[["mark", "role", "label"]].iloc[0]
    more = {"zorder": zorder} | ({} if pd.isna(label) else {"label": label})
    points, line = rows[["x", "y"]].to_numpy(), _LINE.get(role, _LINE["note"])
    if mark in ("cell", "circle"):
        shapes = [
            Circle((row.x, row.y), row.radius)
            if mark == "circle"
            else Rectangle((row.x - row.width / 2, row.y - row.height / 2), row.width, row.height)
            for row in rows.itertuples()
        ]
        look = _FILL.get(role, _NO_FILL) | more
        axes.add_collection(PatchCollection(shapes, linewidth=0.5, **look))
    elif mark == "line":
        axes.plot(*points.T, **line, **more)
    elif mark == "arrow":
        shape = {"arrowstyle": "-|>", "shrinkA": 0, "shrinkB": 0, "mutation_scale": 7, **line}
        for tail, head in itertools.pairwise(points):
            axes.annotate("", xy=head, xytext=tail, arrowprops=shape, zorder=zorder)
    elif mark == "dots":
        axes.plot(*points.T, **_DOTS.get(role, _DOTS["third"]), **more)
    else:
        look = {"ha": "center", "va": "center_baseline", "zorder": zorder + 1, "in_layout": False}
        for at, words in zip(points, rows["text"]):
            # A csv file reads back a column of digits as numbers, not as words.
            axes.text(*at, words if isinstance(words, str) else f"{words:g}", **look)


def _fit(axes: Axes, frame: pd.DataFrame) -> None:
    """Set the limits of the axes to everything drawn and a small margin."""
    reach = frame["radius"].fillna(0).to_numpy()[:, None]
    half = frame[["width", "height"]].fillna(0).to_numpy() / 2 + reach
    places = frame[["x", "y"]].to_numpy()
    low, high = (places - half).min(axis=0), (places + half).max(axis=0)
    room = 0.04 * max(high - low)
    axes.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room))
