"""A workspace: cells with their numbers, circles or polygons, and no path."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import Field

from bezierplan.analysis.naming import format_amount
from bezierplan.figures import style
from bezierplan.figures.panels import Note, Panel, Sources
from bezierplan.schema.model import Line, WorkspaceName
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.grid import embed as embed_cells
from bezierplan.workspaces.limits import Bounds
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem, Workspace

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.patches import Patch


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

ENDS = {
    "start": style.build_mark_style("s", 7, style.BLACK, label="start", zorder=4.5),
    "target": style.build_mark_style("*", 12, style.BLACK, label="target", zorder=4.5),
}

Letters = Annotated[
    list[Line],
    Field(
        min_length=2,
        max_length=2,
        description="what is written next to start and target: a list of two",
    ),
]
# How far a letter stands from a place, towards the panel's centre, in points.
_LETTER_OFFSET = np.array([14, 4])

# What is near an end of a path, as a share of the panel's width.
_NEAR = 0.2

# A grid drawn from circles or polygons shows its cells only up to this number; above it, the shapes
# suffice.
_MOST_CELLS = 2500

# A grid of more cells than this is drawn by its occupied cells alone.
_MOST_OUTLINES = 10_000

# Up to so many heights are named in the legend.
_MOST_HEIGHTS = 5

_COLUMNS = ["part", "x", "y", "size", "obstacle", "ring", "number"]


class Options(Panel):
    workspace: WorkspaceName = Field(description="the name of a workspace")
    numbers: Literal["all", "free", "none"] = Field(
        "none",
        description="which cells show their number: all, free or none (left out: this)",
    )
    embed: bool = Field(
        False,
        description="whether a grid is put into one of a power "
        "of two of rows and columns, true or false",
    )

    def source(self, sources: Sources) -> Workspace:
        """Return the workspace that the panel names."""
        return sources.workspaces[self.workspace]


def data(workspace: Workspace, options: Options) -> pd.DataFrame:
    """Return one row per corner of a workspace's bounds, cell, circle, or point of a ring, in its
    unit.

    Large grids list no free cells unless they show numbers. Columns: part (corner, free, occupied,
    surplus, circle, ring), x, y (a cell's or circle's centre), size (a cell's side, a circle's
    radius), obstacle and ring (polygons only), number (of the cells that show it; see
    `workspaces.grid`), height (of the cells of a grid with heights, in its unit).

    Raises ValueError if numbers or embedding are requested for a workspace without cells.
    """
    if isinstance(workspace, Grid):
        whole = workspace
        if options.embed:
            whole = replace(whole, occupied=embed_cells(whole.occupied))
        return _build_table(whole.bounds, _list_cells(whole, workspace, options.numbers))
    if options.numbers != "none" or options.embed:
        raise ValueError("numbers and embed are options of workspaces of kind grid")
    return list_workspace_rows(workspace)


def list_workspace_rows(workspace: Workspace) -> pd.DataFrame:
    """Return the rows of a workspace, as `data` does, but without numbers."""
    if not isinstance(workspace, Grid):
        return _build_table(workspace.bounds, _list_shapes(workspace))
    shapes = [_list_shapes(workspace.shapes)] if workspace.shapes else []
    if not shapes or workspace.occupied.size <= _MOST_CELLS:
        shapes.insert(0, _list_cells(workspace, workspace, "none"))
    return _build_table(workspace.bounds, *shapes)


def list_ends(problem: Problem) -> pd.DataFrame:
    """Return start and target of a problem as `list_points` gives them."""
    return list_points({"start": [problem.start], "target": [problem.target]})


def list_corners(bounds: Bounds) -> pd.DataFrame:
    """Return the lowest and the highest corner of a workspace as `list_points` gives them."""
    return list_points({"corner": np.reshape(bounds, (2, 2)).T})


def list_points(points: Mapping[str, Any]) -> pd.DataFrame:
    """Return points (n, 2) by part as rows with part, x and y."""
    import pandas as pd

    tables = [
        pd.DataFrame(np.asarray(xy, dtype=float), columns=["x", "y"]).assign(part=part)
        for part, xy in points.items()
    ]
    return pd.concat(tables, ignore_index=True)[["part", "x", "y"]]


def _list_shapes(workspace: Circles | Polygons) -> pd.DataFrame:
    """Return the rows of circles, or of the rings of polygons."""
    import pandas as pd

    if isinstance(workspace, Circles):
        circles = list_points({"circle": workspace.centres})
        return circles.assign(size=workspace.radii, obstacle=range(len(circles)))
    rings = [
        list_points({"ring": points}).assign(obstacle=obstacle, ring=ring)
        for obstacle, outline in enumerate(workspace.obstacles)
        for ring, points in enumerate(outline)
    ]
    return pd.concat([pd.DataFrame(), *rings], ignore_index=True)


def _build_table(bounds: Bounds, *drawn: pd.DataFrame) -> pd.DataFrame:
    """Join the corners of the bounds and the given tables, and keep the columns of a workspace
    alone.

    Heights are a column only if there are any.
    """
    import pandas as pd

    table = pd.concat([list_corners(bounds), *drawn], ignore_index=True)
    return table.reindex(columns=[*_COLUMNS, *table.columns.intersection(["height"])])


def _list_cells(whole: Grid, grid: Grid, numbers: str) -> pd.DataFrame:
    """Return the cells of a grid, in which surplus ones lie beyond the map's own part."""
    import pandas as pd

    rows, columns = whole.occupied.shape
    # Large grids are drawn by their occupied cells alone.
    hidden = numbers == "none" and whole.heights is None and rows * columns > _MOST_OUTLINES
    row, column = np.nonzero(whole.occupied | (not hidden))
    surplus = (row >= grid.occupied.shape[0]) | (column >= grid.occupied.shape[1])
    part = np.where(surplus, "surplus", np.where(whole.occupied[row, column], "occupied", "free"))
    numbered = (part == numbers) | (numbers == "all")
    x, y = whole.in_units(np.column_stack([column, row]) + 0.5).T
    cells = pd.DataFrame({"part": part, "x": x, "y": y, "size": whole.cell})
    cells["number"] = pd.Series(row * columns + column, dtype="Int64").where(numbered)
    if whole.heights is not None and whole is grid:
        cells["height"] = whole.heights.ravel()
    return cells


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`.

    Cells that show their numbers get no scale, because it would take up the room that keeps the
    numbers legible.
    """
    unit = scene.workspaces[options.workspace].unit
    draw_shapes(axes, frame)
    numbered = frame[frame["number"].notna()]
    # Narrow digits: three of them have to fit into a cell.
    look = {"family": "STIXGeneral", "ha": "center", "va": "center_baseline", "in_layout": False}
    for x, y, number in numbered[["x", "y", "number"]].to_numpy():
        axes.text(x, y, str(int(number)), **look)
    if numbered.empty:
        label_axes(axes, unit)
        return Note()
    axes.set(xticks=[], yticks=[])
    side = f"{numbered['size'].iloc[0]:g}"
    return Note(
        "" if (side, unit) == ("1", "cell") else f"cells of {side} x {format_amount(side, unit)}"
    )


def draw_workspace(axes: Axes, home: Workspace, **more: bool) -> None:
    """Draw the workspace behind a panel, with its scale; more: see `draw_shapes`."""
    from matplotlib.colors import ListedColormap

    flat = isinstance(home, Grid) and not home.shapes and home.heights is None
    # Outlines of small cells would hide what they surround.
    if flat and home.occupied.size > _MOST_OUTLINES:
        colours = ListedColormap([style.FREE, style.OCCUPIED])
        axes.imshow(home.occupied, colours, origin="lower", extent=home.bounds, vmin=0, vmax=1)
    else:
        draw_shapes(axes, list_workspace_rows(home), **more)
    label_axes(axes, home.unit)


def label_axes(axes: Axes, unit: str) -> None:
    """Label the two coordinates of a workspace, with ticks at edges of cells of side 1."""
    axes.locator_params(nbins="auto", steps=[1, 2, 4, 5, 10])
    if np.abs([axes.get_xlim(), axes.get_ylim()]).max() >= 1e5:
        # Projected coordinates: long numbers, written in full, so few of them.
        axes.ticklabel_format(style="plain", useOffset=False)
        axes.locator_params(axis="x", nbins=2)
    axes.set_xlabel(f"x ({unit})")
    axes.set_ylabel(f"y ({unit})")


def draw_letters(axes: Axes, frame: pd.DataFrame, letters: list[str] | None) -> None:
    """Write letters next to start and target, rows of a frame with part, x and y."""
    for part, letter in zip(ENDS, letters or ()):
        end = frame.loc[frame["part"] == part, ["x", "y"]].iloc[0].to_numpy(dtype=float)
        inwards = np.sign([np.mean(axes.get_xlim()), np.mean(axes.get_ylim())] - end)
        # Beside the path: above or below one that begins flat, right or left of a steep one.
        away = np.abs(frame.loc[frame["part"] == "path", ["x", "y"]].to_numpy(dtype=float) - end)
        near = away[away.max(axis=1) < _NEAR * np.ptp(axes.get_xlim())]
        flat = bool(len(near)) and near[:, 0].sum() > near[:, 1].sum()
        offset = _LETTER_OFFSET[::-1] if flat else _LETTER_OFFSET
        place = {"xytext": offset * inwards, "textcoords": "offset points"}
        axes.annotate(letter, end, weight="bold", zorder=7, ha="center", va="center", **place)


def draw_shapes(axes: Axes, frame: pd.DataFrame, *, outlines: bool = False) -> None:
    """Draw the rows of `data` or `list_workspace_rows` to scale, without numbers or axis labels.

    outlines: draw only outlines of circles and polygons, because other things fill the panel, such
    as the cells of a grid drawn from them.
    """
    from matplotlib.collections import PatchCollection

    corners = frame[frame["part"] == "corner"]
    axes.set(xlim=corners["x"], ylim=corners["y"], aspect="equal")
    cells = frame[frame["part"].isin(_CELLS)]
    for part, own in cells.groupby("part"):
        draw_cells(axes, own, _CELLS[part])
    if "height" in frame:
        _draw_heights(axes, frame[frame["part"] == "free"])
    look = _OUTLINE if outlines or len(cells) else _OBSTACLE
    if shapes := _build_patches(frame):
        obstacles = PatchCollection(shapes, label="obstacle", **look)
        axes.add_collection(obstacles, autolim=False)


def draw_cells(axes: Axes, cells: pd.DataFrame, look: dict) -> None:
    """Draw cells about x, y of a size, in a look."""
    from matplotlib.collections import PolyCollection

    if cells.empty:
        return
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    corners = (
        cells[["x", "y"]].to_numpy()[:, None] + cells["size"].to_numpy()[:, None, None] * square
    )
    plain = {"edgecolor": style.CELL_LINE, "linewidth": 0.4, "zorder": 0.5}
    axes.add_collection(PolyCollection(corners, **plain | look), autolim=False)


def _draw_heights(axes: Axes, cells: pd.DataFrame) -> None:
    """Draw free cells shaded by their height.

    The legend names every height, or only the lowest and the highest if there are many.
    """
    import matplotlib as mpl

    low, high = cells["height"].min(), cells["height"].max()
    named = (low, high) if cells["height"].nunique() > _MOST_HEIGHTS else cells["height"].unique()
    for height, own in cells.groupby("height"):
        share = (height - low) / (high - low) if high > low else 0.0
        # Pale, so that lines stand out.
        look = {"facecolor": mpl.colors.to_hex(mpl.colormaps["Purples"](0.6 * share))}
        draw_cells(axes, own, look | ({"label": f"height {height:g}"} if height in named else {}))


def _build_patches(frame: pd.DataFrame) -> list[Patch]:
    """Return patches of matplotlib for circles, then for polygons."""
    import shapely
    from matplotlib.patches import Circle
    from shapely.plotting import patch_from_polygon

    circles = frame[frame["part"] == "circle"]
    shapes = [Circle((x, y), size) for x, y, size in circles[["x", "y", "size"]].to_numpy()]
    for _, obstacle in frame[frame["part"] == "ring"].groupby("obstacle"):
        outer, *holes = (ring[["x", "y"]].to_numpy() for _, ring in obstacle.groupby("ring"))
        shapes.append(patch_from_polygon(shapely.Polygon(outer, holes)))
    return shapes
