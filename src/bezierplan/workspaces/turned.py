"""Maps of cells that are turned about their origin: the same obstacles as polygons, where they
really are.
"""

from bezierplan.workspaces import robot
from bezierplan.workspaces.geojson import rings_of
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
    border = shapely.box(x_low, y_low, x_high, y_high)
    around = border.buffer(x_high - x_low + y_high - y_low, join_style="mitre")
    # One shape before it is turned: rounding would leave slits between cells and what is outside.
    blocked = shapely.union_all([cells, around.difference(border)])
    blocked, border = (
        affinity.rotate(each, yaw, origin=grid.origin, use_radians=True)
        for each in (blocked, border)
    )
    left, bottom, right, top = border.bounds
    inside = blocked.intersection(shapely.box(left, bottom, right, top))
    rings = tuple(rings_of(part) for part in shapely.get_parts(inside) if part.area > 0)
    return Polygons((left, right, bottom, top), rings, grid.unit)
