"""Maps of cells that are turned about their origin: the same obstacles as polygons, where they
really are.
"""

import numpy as np

from bezierplan.workspaces import robot
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.polygons import Polygons


def polygons(grid: Grid, yaw: float) -> Polygons:
    """The occupied cells of a grid that is turned by yaw, in radians counterclockwise about its
    origin. What lies outside of its border, within the turned border's bounds, is blocked.

    Raises ValueError for cells with more than `robot.MOST_CORNERS` corners.
    """
    import shapely
    from shapely import affinity

    cells = robot.union_of_cells(grid)
    if cells is None:
        raise ValueError(
            f"origin: yaw {yaw:.6g}: a turned map whose occupied cells have more than "
            f"{robot.MOST_CORNERS:,} corners; expected fewer, or a yaw of 0"
        )
    x_low, x_high, y_low, y_high = grid.bounds
    shape, border = (
        affinity.rotate(each, yaw, origin=grid.origin, use_radians=True)
        for each in (cells, shapely.box(x_low, y_low, x_high, y_high))
    )
    left, bottom, right, top = border.bounds
    outside = shapely.box(left, bottom, right, top).difference(border)
    rings = tuple(
        tuple(np.array(ring.coords)[:-1] for ring in (part.exterior, *part.interiors))
        for part in (*shapely.get_parts(shape), *shapely.get_parts(outside))
    )
    return Polygons((left, right, bottom, top), rings, grid.unit)
