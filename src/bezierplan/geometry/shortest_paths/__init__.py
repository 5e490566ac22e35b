"""Exact shortest paths of a point robot: any-angle on grids, around circles and polygons; through
cell centres; on the 8-connected lattice.

They use the same region as the certified check, which finds the resulting paths free: touching is
allowed. There is one file for each kind of region, and one for the lattice.
"""

import numpy as np

from bezierplan.geometry.checker import TOLERANCE, check
from bezierplan.geometry.region import CircleRegion, GridRegion, build_region
from bezierplan.geometry.shortest_paths.circles import shortest_around_circles
from bezierplan.geometry.shortest_paths.graph import Bound, no_path
from bezierplan.geometry.shortest_paths.grid import centre_path, shortest_on_grid
from bezierplan.geometry.shortest_paths.lattice import lattice_path
from bezierplan.geometry.shortest_paths.polygons import shortest_among_polygons
from bezierplan.workspaces.problem import Problem

__all__ = ["Bound", "centre_path", "lattice_path", "least_length", "shortest_path"]


def shortest_path(problem: Problem) -> Bound:
    """Find the shortest path from start to target.

    Parameters
    ----------
    problem : Problem
        The workspace with both ends.

    Returns
    -------
    Bound
        No path if start or target is blocked.

    Notes
    -----
    On a grid the visibility of start and target is decided for the nearest points of a lattice:
    coordinates that are not fractions of a cell with a common denominator of at most 2**20 are off
    by up to 5e-7 cells in that test. Lengths are those of the points themselves. Around circles the
    length is a sum of closed forms, and the polyline is up to `circles.POLYLINE_EXCESS` longer.

    Examples
    --------
    Around two occupied cells, by their upper left corner:

    >>> from bezierplan.workspaces.grid import from_lines
    >>> room = from_lines(["....", ".##.", "...."], cell=1.0, unit="m")
    >>> found = shortest_path(Problem("room", room, start=(0.5, 0.5), target=(3.5, 2.5)))
    >>> round(found.length, 6)
    4.130649
    >>> found.points.tolist()
    [[0.5, 0.5], [3.0, 1.0], [3.5, 2.5]]
    """
    blocked = build_region(problem.workspace)
    for point in problem.ends:
        # The check itself judges a path that stays at the point, so both allow the same places.
        if not check(np.array([[point, point]]), blocked).feasible:
            return no_path()
    if isinstance(blocked, GridRegion):
        return shortest_on_grid(problem, blocked)
    if isinstance(blocked, CircleRegion):
        return shortest_around_circles(problem, blocked)
    return shortest_among_polygons(problem, blocked)


def least_length(bound: Bound) -> float:
    """Return the exact shortest length less an allowance: no path that the certified check calls
    free is shorter, but for the exceptions below.

    Parameters
    ----------
    bound : Bound
        The shortest path.

    Returns
    -------
    float
        Its length less an allowance, in the problem's unit.

    Notes
    -----
    Such a path may be a few 1e-9 deep and cut its bends by as much; the allowance is a relative
    1e-9 plus 1e-8 per radian of turning. Obstacles that are sharper than a right angle and gaps
    below 1e-7 can allow more.
    """
    step = np.diff(bound.points, axis=0)
    step = step[np.hypot(*step.T) > TOLERANCE]
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    return bound.length * (1 - 1e-9) - 1e-8 * float(np.abs(np.diff(heading)).sum())
