"""A workspace: cells with their numbers, circles or polygons, without any path."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from bezierplan.figures import style
from bezierplan.figures.panels import Note, Panel, Sources
from bezierplan.schema.model import Flag
from bezierplan.schema.model import Workspace as Described
from bezierplan.schema.words import amount
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.grid import embed as embed_cells
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem, Workspace

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.patches import Circle, PathPatch


_CELLS = {
    "free": {"facecolor": style.FREE},
    "occupied": {"facecolor": style.OCCUPIED, "label": "occupied cell"},
    "surplus": {
        "facecolor": style.SURPLUS,
        "label": "surplus cell, occupied",
        **style.SURPLUS_HATCH,
    },
}

_OBSTACLE = {"facecolor": style.OCCUPIED, "edgecolor": "0.4", "linewidth": 0.5, "zorder": 0.5}
_OUTLINE = {
    "facecolor": "none",
    "edgecolor": style.BLACK,
    "linewidth": 0.8,
    "linestyle": (0, (3, 2)),
    "zorder": 3,
}

START = style.mark("s", 7, style.BLACK, label="start", zorder=4.5)
TARGET = style.mark("*", 12, style.BLACK, label="target", zorder=4.5)

# A grid drawn from circles or polygons shows its cells only up to this number; above it, the shapes
# suffice.
_MOST_CELLS = 2500

# A grid of more cells than this is drawn as an image, from its occupied cells: outlines of cells
# would hide what they surround.
_MOST_OUTLINES = 10_000

# Up to so many heights are named in the legend.
_MOST_HEIGHTS = 5

# Of a grid with more columns only every third shows its numbers, the last one among them: more
# would not be legible on a sheet of one text column.
_MOST_COLUMNS = 12
_COLUMNS = ["part", "x", "y", "size", "obstacle", "ring", "number"]


class Options(Panel):
    to_scale: ClassVar[bool] = True

    workspace: Described = Field(description="the name of a workspace")
    numbers: Literal["all", "free", "none"] = Field(
        "none",
        description="which cells show their number, of a wide grid in every third column: all, "
        "free or none (left out: this)",
    )
    embed: Flag = Field(
        False,
        description="whether a grid is put into one of a power "
        "of two of rows and columns, true or false",
    )

    def source(self, sources: Sources) -> Workspace:
        """The workspace."""
        return sources.workspaces[self.workspace]


def data(workspace: Workspace, options: Options) -> pd.DataFrame:
    """What is drawn of a workspace, in its unit: one row per corner of its bounds, cell, circle, or
    point of a ring.

    Large grids list no free cells unless they show numbers.

    Columns: part (corner, free, occupied, surplus, circle, ring), x, y (a cell's or circle's
    centre), size (a cell's side, a circle's radius), obstacle and ring (polygons only), number (of
    the cells that show it; see `workspaces.grid`), height (of the cells of a grid with heights, in
    its unit).

    Raises ValueError if numbers or embedding are requested for a workspace without cells.
    """
    if isinstance(workspace, Grid):
        whole = (
            replace(workspace, occupied=embed_cells(workspace.occupied))
            if options.embed
            else workspace
        )
        return _table(whole.bounds, _cells(whole, workspace, options.numbers))
    if options.numbers != "none" or options.embed:
        raise ValueError("numbers and embed are options of workspaces of kind grid")
    return parts(workspace)


def parts(workspace: Workspace) -> pd.DataFrame:
    """What is drawn of a workspace itself, without numbers: rows as in `data`."""
    if isinstance(workspace, Grid):
        source = workspace.drawn
        cells = (
            []
            if source and workspace.occupied.size > _MOST_CELLS
            else [_cells(workspace, workspace, "none")]
        )
        return _table(workspace.bounds, *cells, *([_shapes(source)] if source else []))
    return _table(workspace.bounds, _shapes(workspace))


def ends(problem: Problem) -> pd.DataFrame:
    """Start and target of a problem: rows with part, x and y."""
    import pandas as pd

    places = [("start", *problem.start), ("target", *problem.target)]
    return pd.DataFrame(places, columns=["part", "x", "y"])


def _shapes(workspace: Circles | Polygons) -> pd.DataFrame:
    return _discs(workspace) if isinstance(workspace, Circles) else _rings(workspace)


def _discs(circles: Circles) -> pd.DataFrame:
    import pandas as pd

    x, y = circles.centres.T
    return pd.DataFrame(
        {"part": "circle", "x": x, "y": y, "size": circles.radii, "obstacle": range(len(x))}
    )


def _table(bounds: tuple[float, float, float, float], *drawn: pd.DataFrame) -> pd.DataFrame:
    """The corners of the bounds and everything drawn within them, with all columns; heights only if
    there are any.
    """
    import pandas as pd

    corners = pd.DataFrame({"part": "corner", "x": bounds[:2], "y": bounds[2:]})
    table = pd.concat([corners, *drawn], ignore_index=True)
    return table.reindex(columns=[*_COLUMNS, *table.columns.intersection(["height"])])


def _cells(whole: Grid, grid: Grid, numbers: str) -> pd.DataFrame:
    """Cells of a grid; those beyond its own part are surplus."""
    import pandas as pd

    own_rows, own_columns = grid.occupied.shape
    left_out = (
        ~whole.occupied
        if numbers == "none" and whole.heights is None and whole.occupied.size > _MOST_OUTLINES
        else False
    )
    row, column = np.nonzero(~np.broadcast_to(left_out, whole.occupied.shape))
    surplus = (row >= own_rows) | (column >= own_columns)
    part = np.where(surplus, "surplus", np.where(whole.occupied[row, column], "occupied", "free"))
    shown = {"all": part != "", "free": part == "free", "none": part == ""}[numbers]
    x, y = whole.in_units(np.column_stack([column, row]) + 0.5).T
    cells = pd.DataFrame({"part": part, "x": x, "y": y, "size": whole.cell})
    columns = whole.occupied.shape[1]
    if columns > _MOST_COLUMNS:
        shown &= (columns - 1 - column) % 3 == 0
    cells["number"] = pd.Series(row * columns + column, dtype="Int64").where(shown)
    if whole.heights is not None and whole is grid:
        cells["height"] = whole.heights.ravel()
    return cells


def _rings(workspace: Polygons) -> pd.DataFrame:
    import pandas as pd

    rings = [
        pd.DataFrame(points, columns=["x", "y"]).assign(part="ring", obstacle=obstacle, ring=ring)
        for obstacle, outline in enumerate(workspace.obstacles)
        for ring, points in enumerate(outline)
    ]
    return pd.concat([pd.DataFrame(), *rings], ignore_index=True)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`.

    Cells that show their numbers need no scale: it would take up the room that keeps the numbers
    legible.
    """
    unit = scene.workspaces[options.workspace].unit
    shade(axes, frame)
    numbered = frame[frame["number"].notna()]
    for x, y, number in zip(numbered["x"], numbered["y"], numbered["number"]):
        axes.text(x, y, str(int(number)), ha="center", va="center_baseline", in_layout=False)
    if numbered.empty:
        scale(axes, unit)
        return Note()
    axes.set_xticks([])
    axes.set_yticks([])
    side = numbered["size"].iloc[0]
    if (side, unit) == (1, "cell"):
        return Note()
    return Note(f"cells of {side:g} x {amount(f'{side:g}', unit)}")


def scale(axes: Axes, unit: str) -> None:
    """Label the two coordinates of a workspace, with ticks at edges of cells of side 1."""
    axes.locator_params(nbins=8, steps=[1, 2, 4, 5, 10])
    if np.abs([axes.get_xlim(), axes.get_ylim()]).max() >= 1e5:
        # Projected coordinates: long numbers, written in full, so few of them.
        axes.ticklabel_format(style="plain", useOffset=False)
        axes.locator_params(axis="x", nbins=2)
    axes.set_xlabel(f"x ({unit})")
    axes.set_ylabel(f"y ({unit})")


def shade(axes: Axes, frame: pd.DataFrame, *, outlines: bool = False) -> None:
    """Draw the rows of `data` or `parts` to scale, without numbers or axis labels; only the
    outlines of circles and polygons if something else fills the panel, such as the cells of a grid
    drawn from them.
    """
    corners = frame[frame["part"] == "corner"]
    axes.set_xlim(corners["x"].min(), corners["x"].max())
    axes.set_ylim(corners["y"].min(), corners["y"].max())
    axes.set_aspect("equal")
    cells = frame[frame["part"].isin(_CELLS)]
    area = np.ptp(corners["x"]) * np.ptp(corners["y"])
    are_many = len(cells) and area > _MOST_OUTLINES * cells["size"].iloc[0] ** 2
    if are_many and "height" not in frame:
        _draw_image(axes, cells, corners)
    else:
        for part, look in _CELLS.items():
            _draw_cells(axes, cells[cells["part"] == part], look)
    if "height" in frame:
        _draw_heights(axes, frame[frame["part"] == "free"])
    look = _OUTLINE if outlines or frame["part"].isin(_CELLS).any() else _OBSTACLE
    _draw_obstacles(axes, _circles(frame[frame["part"] == "circle"]), look)
    _draw_obstacles(axes, _polygons(frame[frame["part"] == "ring"]), look)


def _draw_cells(axes: Axes, cells: pd.DataFrame, look: dict) -> None:
    from matplotlib.collections import PolyCollection

    if cells.empty:
        return
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    corners = (
        cells[["x", "y"]].to_numpy()[:, None] + cells["size"].to_numpy()[:, None, None] * square
    )
    shapes = PolyCollection(corners, edgecolor=style.CELL_LINE, linewidth=0.4, zorder=0.5, **look)
    axes.add_collection(shapes, autolim=False)


def _draw_image(axes: Axes, cells: pd.DataFrame, corners: pd.DataFrame) -> None:
    """Draw cells as an image of one pixel each. Cells that are not listed are free."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb

    side = cells["size"].iloc[0]
    (left, right), (bottom, top) = corners["x"], corners["y"]
    shape = round((top - bottom) / side), round((right - left) / side), 3
    image = np.full(shape, to_rgb(_CELLS["free"]["facecolor"]))
    for part in ("occupied", "surplus"):
        own = cells[cells["part"] == part]
        row, column = ((own["y"] - bottom) // side), ((own["x"] - left) // side)
        image[row.astype(int), column.astype(int)] = to_rgb(_CELLS[part]["facecolor"])
        if len(own):
            legend = PolyCollection([], edgecolor=style.CELL_LINE, **_CELLS[part])
            axes.add_collection(legend, autolim=False)
    extent = left, right, bottom, top
    axes.imshow(image, extent=extent, origin="lower", aspect="equal", zorder=0.5)


def _draw_heights(axes: Axes, cells: pd.DataFrame) -> None:
    """Shade free cells by their height; the legend names every height, or of many the lowest and
    the highest.
    """
    low, high = cells["height"].min(), cells["height"].max()
    named = (low, high) if cells["height"].nunique() > _MOST_HEIGHTS else cells["height"].unique()
    for height, own in cells.groupby("height"):
        look = {"facecolor": style.ground((height - low) / (high - low) if high > low else 0.0)}
        _draw_cells(axes, own, look | ({"label": f"height {height:g}"} if height in named else {}))


def _circles(circles: pd.DataFrame) -> list[Circle]:
    from matplotlib.patches import Circle

    return [
        Circle((x, y), radius) for x, y, radius in zip(circles["x"], circles["y"], circles["size"])
    ]


def _polygons(rings: pd.DataFrame) -> list[PathPatch]:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    outlines = [
        Outline.make_compound_path(
            *(Outline(np.vstack([ring, ring[:1]]), closed=True) for ring in _oriented(obstacle))
        )
        for _, obstacle in rings.groupby("obstacle")
    ]
    return [PathPatch(outline) for outline in outlines]


def _oriented(obstacle: pd.DataFrame) -> list[np.ndarray]:
    """The rings (n, 2) of an obstacle, the outer one counterclockwise and its holes clockwise: only
    then do holes stay open.
    """
    rings = []
    for number, ring in obstacle.groupby("ring"):
        points = ring[["x", "y"]].to_numpy()
        x, y = points.T
        counterclockwise = x @ np.roll(y, -1) > y @ np.roll(x, -1)
        rings.append(points if counterclockwise == (number == 0) else points[::-1])
    return rings


def _draw_obstacles(axes: Axes, shapes: list, look: dict) -> None:
    from matplotlib.collections import PatchCollection

    if shapes:
        axes.add_collection(PatchCollection(shapes, label="obstacle", **look), autolim=False)
