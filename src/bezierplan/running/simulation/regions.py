"""The blocked regions of the maps of a world, which a drive needs again and again: when it plans,
when it looks ahead, and when it is judged.
"""

from functools import lru_cache

import numpy as np

from bezierplan.geometry.region import Region, region
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Workspace

# The regions of larger maps, in cells, take more memory than it is worth to keep them.
_MOST_CELLS = 10_000


def region_of(workspace: Workspace) -> Region:
    """`region` of a workspace; of a small map that has been asked for before, the same one. It is
    found by the map's content, and no planner is given it.
    """
    if (
        not isinstance(workspace, Grid)
        or workspace.shapes is not None
        or workspace.occupied.size > _MOST_CELLS
    ):
        return region(workspace)
    cells = workspace.occupied
    return _of_cells(cells.tobytes(), cells.shape, workspace.cell, workspace.origin)


@lru_cache(maxsize=64)
def _of_cells(
    cells: bytes, shape: tuple[int, int], cell: float, origin: tuple[float, float]
) -> Region:
    occupied = np.frombuffer(cells, dtype=bool).reshape(shape)
    return region(Grid(occupied, cell, "", origin))
