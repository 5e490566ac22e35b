"""The certified collision check: whether, where and how deeply a path of Bézier pieces enters the
blocked region, or how close it comes to it.

The curve of a piece lies in the hull of its control points (`hulls`). A piece is halved until every
part is either certified free, because its hull is, or begins at a point that is certainly blocked
(`collision`). Two thresholds guarantee that this always ends: a collision is certified by a point
deeper than `TOLERANCE`, freedom by a depth of at most twice that. (In a corner between two walls,
twice that from each wall.) Depth and clearance are found by branch and bound over the same halves
(`distances`).

Each search is written once. What it needs to know about a region (`certificates`) is selected by
the type of the region when the kernel is compiled.
"""

import math
from typing import NamedTuple

import numpy as np

from bezierplan.geometry.checker.certificates import is_free
from bezierplan.geometry.checker.collision import find_first_collision
from bezierplan.geometry.checker.distances import (
    CLEARANCE_TOLERANCE,
    DEPTH_TOLERANCE,
    find_largest_depth,
    find_least_clearance,
)
from bezierplan.geometry.checker.hulls import (
    LARGEST_COORDINATE,
    LARGEST_DEGREE,
    TOLERANCE,
    choose_resolution,
)
from bezierplan.geometry.region import CircleRegion, Region, from_origin

__all__ = ["TOLERANCE", "Check", "check", "find_first_collision", "is_free", "refuse_unfit"]

# Each halving accumulates as many rounding errors as the degree. Above this degree coordinates must
# be smaller, so that the sum of the errors does not grow further.
_FULL_RANGE_DEGREE = 32


class Check(NamedTuple):
    """The verdict on a path.

    Attributes
    ----------
    feasible : bool
        Whether it does not enter the blocked region.
    collision_at : float
        Number of the piece plus the parameter within it of the first collision; nan when free.
    depth : float
        Largest depth in the blocked region, in units: the distance to free space; where discs
        overlap or extend beyond the border, the largest of their depths, a lower bound. 0 when
        free.
    clearance : float
        Least distance to the blocked region, in units; 0 when colliding.
    tolerance : float
        Proven error, in units, of `clearance` when free, of `depth` when colliding.
    intervals : int
        Number of parameter intervals that the verdict required.
    """

    feasible: bool
    collision_at: float
    depth: float
    clearance: float
    tolerance: float
    intervals: int


def check(pieces: np.ndarray, region: Region) -> Check:
    """Check whether a path of Bézier pieces enters a blocked region, and how deep, or how close it
    comes.

    Parameters
    ----------
    pieces : (pieces, degree + 1, 2) array
        Control points, in the region's unit; each piece begins where the previous one ends.
    region : Region
        The blocked region of a workspace (`region.region`).

    Returns
    -------
    Check
        The verdict.

    Raises
    ------
    ValueError
        For coordinates that are not finite or beyond 1e5, or 1e5 x 32 / degree for a degree above
        32, and for a degree above 60.

    Notes
    -----
    A path deeper than 4e-9 is never called free, and one no deeper than 1e-9 never colliding; in
    between, either verdict is possible. At the tip of a notch between polygons that is sharper than
    60 degrees, 4e-9 becomes 2e-9 divided by the sine of half its angle.

    Examples
    --------
    A straight line runs into an obstacle, a parabola goes around it:

    >>> from bezierplan.geometry.region import build_region
    >>> from bezierplan.workspaces.grid import from_lines
    >>> room = build_region(from_lines(["....", ".##.", "...."], cell=1.0, unit="m"))
    >>> straight = check(np.array([[[0.5, 0.5], [3.5, 2.5]]]), room)
    >>> straight.feasible, round(straight.collision_at, 6), straight.depth
    (False, 0.25, 0.5)
    >>> parabola = check(np.array([[[0.5, 0.5], [4.0, -0.5], [3.5, 2.5]]]), room)
    >>> parabola.feasible, parabola.clearance
    (True, 0.25)
    """
    # In rows: for an array of another layout numba compiles each kernel once more.
    pieces = np.ascontiguousarray(pieces, dtype=float)
    refuse_unfit(pieces)
    pieces = from_origin(pieces, region)
    collision_at, intervals = find_first_collision(pieces, region)
    if collision_at < math.inf:
        depth = find_largest_depth(pieces, region, collision_at)
        return Check(
            False,
            collision_at,
            depth,
            0.0,
            max(DEPTH_TOLERANCE * depth, choose_resolution(pieces.reshape(-1, 2))),
            intervals,
        )
    if isinstance(region, CircleRegion):
        centres, radii = region.centres, region.radii
    else:
        centres, radii = np.empty((0, 2)), np.empty(0)
    clearance = find_least_clearance(pieces, region.edges, region.bins, centres, radii)
    return Check(True, math.nan, 0.0, clearance, CLEARANCE_TOLERANCE, intervals)


def refuse_unfit(pieces: np.ndarray) -> None:
    """Raise ValueError for pieces of a wrong shape, too high a degree or unfit coordinates."""
    if pieces.ndim != 3 or pieces.shape[2] != 2 or not 2 <= pieces.shape[1] <= LARGEST_DEGREE + 1:
        raise ValueError(
            f"pieces have the shape {pieces.shape}; expected (pieces, degree + 1, 2) with a "
            f"degree of 1 to {LARGEST_DEGREE}"
        )
    # Written so that nan fails as well.
    largest = LARGEST_COORDINATE * min(1.0, _FULL_RANGE_DEGREE / (pieces.shape[1] - 1))
    if not np.abs(pieces).max(initial=0.0) <= largest:
        raise ValueError(f"a path has a coordinate that is not finite or beyond {largest:g}")
