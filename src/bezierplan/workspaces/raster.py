"""The grid that a cell planner needs for a map of polygons (elhoseny2017, Sections 3.2 and 4.5).

As in a random field, the centres of the outermost cells lie on the border: cell i of a row has its
centre i cells from the border's left side, so that both ends of a map are cells. Only the planner
uses the cells: the certified check and the exact shortest path use the polygons.
"""

import logging
from typing import Literal

import numpy as np

from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.limits import check_cells, check_thickness
from bezierplan.workspaces.polygons import Polygons

logger = logging.getLogger(__name__)

Rule = Literal["overlap", "centre"]

# Two sides closer than this, in cells, count as one: walls often lie on grid lines.
_SAME_LINE = 1e-6


def from_polygons(polygons: Polygons, cell: float, rule: Rule) -> Grid:
    """Build the cells of a map of polygons.

    cell: side of a cell, in units.
    rule: `overlap` or `centre`, see below.

    With `overlap` a cell is occupied if its inside overlaps an obstacle, so a path over free cells
    is free; with `centre` if its centre lies in one or on its edge, so a path may cut up to half a
    cell into a wall. A cell whose centre is outside the border is occupied.

    Raises ValueError for cells that are too small or too many. Warns of obstacles that occupy no
    cell.
    """
    import shapely

    check_thickness(cell, "cell:")
    left, right, bottom, top = polygons.bounds
    columns, rows = (round((high - low) / cell) + 1 for low, high in ((left, right), (bottom, top)))
    check_cells(rows, columns)
    x, y = left + cell * np.arange(columns), bottom + cell * np.arange(rows)
    # Where a side is no multiple of a cell, the last centres may lie beyond the border.
    occupied = (y[:, None] > top + _SAME_LINE * cell) | (x > right + _SAME_LINE * cell)
    for number, (outer, *holes) in enumerate(polygons.obstacles):
        shape = shapely.Polygon(outer, holes)
        # The cells within the obstacle's bounds, and one more on each side.
        low, high = outer.min(axis=0) - (left, bottom), outer.max(axis=0) - (left, bottom)
        first = np.maximum(np.floor(low / cell).astype(int) - 1, 0)
        end = np.ceil(high / cell).astype(int) + 2
        near = np.s_[first[1] : end[1], first[0] : end[0]]
        centre_x, centre_y = np.meshgrid(x[near[1]], y[near[0]])
        shapely.prepare(shape)
        if rule == "overlap":
            # A little less than the cell: a wall along a grid line overlaps only the cells on its
            # own side.
            half = (0.5 - _SAME_LINE) * cell
            met = shapely.intersects(
                shape,
                shapely.box(centre_x - half, centre_y - half, centre_x + half, centre_y + half),
            )
        else:
            met = shapely.dwithin(shape, shapely.points(centre_x, centre_y), _SAME_LINE * cell)
        if not met.any():
            logger.warning("obstacle %d occupies no cell of side %g", number, cell)
        occupied[near] |= met
    return Grid(occupied, cell, polygons.unit, (left - 0.5 * cell, bottom - 0.5 * cell), polygons)


def find_overlap(polygons: Polygons, grid: Grid) -> np.ndarray:
    """Tell which cells of a grid overlap an obstacle or the outside of the border of polygons: bool
    (rows, columns).
    """
    import shapely

    free = polygons.free()
    rows, columns = grid.occupied.shape
    corner = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1)
    low, high = grid.in_units(corner + _SAME_LINE), grid.in_units(corner + 1 - _SAME_LINE)
    shapely.prepare(free)
    return ~shapely.covers(free, shapely.box(low[..., 0], low[..., 1], high[..., 0], high[..., 1]))
