"""The footprint of a robot: a convex polygon around its reference point, which turns with the
direction of travel.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bezierplan.workspaces.arrays import read_only
from bezierplan.workspaces.limits import LARGEST, SMALLEST_FEATURE

MOST_CORNERS = 100
"""Most corners of a footprint."""

# A corner that turns by less than this, in radians, is no corner.
_STRAIGHT = 1e-9

# The angles of a polygon that goes round once add up to a full turn, within this.
_ONE_TURN = 1e-6

_EXPECTED = "expected [[x, y], ...], at least three corners of a convex polygon"


@dataclass(frozen=True)
class Footprint:
    """A footprint, in the unit of the map.

    corners: (n, 2) counterclockwise, x ahead and y to the left of the reference point, which the
    path is that of; read-only. inscribed, circumscribed: radii of the circles around that point
    within the polygon, 0 if it is outside, and around it. middle: (2,) the centroid. thickness:
    distance of the centroid from the nearest side.
    """

    corners: np.ndarray
    inscribed: float
    circumscribed: float
    middle: np.ndarray
    thickness: float


def footprint(corners: Sequence[Sequence[float]]) -> Footprint:
    """A footprint with some corners, in one order or the other. Raises ValueError unless they are
    those of a convex polygon.
    """
    polygon = _simplified(_points(corners))
    if len(polygon) < 3:
        raise ValueError(f"footprint: its corners lie on one line; {_EXPECTED}")
    turns = _turns(polygon)
    if turns.sum() < 0:
        polygon = polygon[::-1]
        turns = _turns(polygon)
    if turns.min() < 0:
        x, y = polygon[int(turns.argmin())]
        raise ValueError(f"footprint: not convex at [{x:g}, {y:g}]; {_EXPECTED}")
    if abs(turns.sum() - math.tau) > _ONE_TURN:
        raise ValueError(f"footprint: its sides cross; {_EXPECTED}")
    middle = _centroid(polygon)
    thickness = float(_to_sides(middle, polygon).min())
    if thickness < SMALLEST_FEATURE:
        raise ValueError(
            f"footprint: {2 * thickness:.3g} thick; expected at least {2 * SMALLEST_FEATURE:g}"
        )
    inscribed = max(0.0, float(_to_sides(np.zeros(2), polygon).min()))
    return Footprint(
        read_only(polygon, float),
        inscribed,
        float(np.hypot(*polygon.T).max()),
        read_only(middle, float),
        thickness,
    )


def _points(corners: Sequence[Sequence[float]]) -> np.ndarray:
    """The corners as an array (n, 2) of finite numbers."""
    try:
        # Text that looks like a number is none.
        points = np.array(corners)
        points = points.astype(float) if points.dtype.kind in "iuf" else np.empty(0)
    except (TypeError, ValueError):
        points = np.empty(0)
    if points.ndim != 2 or points.shape[1] != 2 or not 3 <= len(points) <= MOST_CORNERS:
        raise ValueError(f"footprint: {str(corners)[:60]}; {_EXPECTED} and at most {MOST_CORNERS}")
    if not np.abs(points).max() <= LARGEST:
        raise ValueError(
            f"footprint: {str(corners)[:60]}: "
            f"expected finite numbers of at most {LARGEST:g} in size"
        )
    return points


def _simplified(points: np.ndarray) -> np.ndarray:
    """The corners of a polygon without repeated ones, such as a last one that is the first again,
    and without those on straight sides.
    """
    points = points[np.any(points != np.roll(points, 1, axis=0), axis=1)]
    return points[np.abs(_turns(points)) > _STRAIGHT] if len(points) else points


def _turns(polygon: np.ndarray) -> np.ndarray:
    """The angle (n,) by which the boundary turns left at each corner; at a spike a half turn."""
    arriving = polygon - np.roll(polygon, 1, axis=0)
    leaving = np.roll(polygon, -1, axis=0) - polygon
    return np.arctan2(
        arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0],
        (arriving * leaving).sum(axis=1),
    )


def _centroid(polygon: np.ndarray) -> np.ndarray:
    x, y = (polygon - polygon[0]).T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    return polygon[0] + np.array([((v + np.roll(v, -1)) * cross).sum() for v in (x, y)]) / (
        3 * cross.sum()
    )


def _to_sides(point: np.ndarray, polygon: np.ndarray) -> np.ndarray:
    """Distance (n,) of a point from the line of each side, positive inside."""
    along = np.roll(polygon, -1, axis=0) - polygon
    return (
        along[:, 0] * (point[1] - polygon[:, 1]) - along[:, 1] * (point[0] - polygon[:, 0])
    ) / np.hypot(*along.T)
