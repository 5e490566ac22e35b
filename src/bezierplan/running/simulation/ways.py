"""Ways that a robot follows: polylines with arc length."""

import itertools
import math
from typing import NamedTuple

import numpy as np

from bezierplan.geometry import checker, curves
from bezierplan.geometry.arc_length import find_places, measure_lengths
from bezierplan.geometry.region import Region, from_origin, is_blocked
from bezierplan.workspaces.problem import Path

# A chord this short, in units, is not halved: beside a circle of radius 2 it enters only as deep as
# the checker calls free.
_SHORTEST = 1e-4


class Way(NamedTuple):
    """A polyline. points: (n, 2), in units, successive ones differ. at: (n,) length of the way up
    to each.
    """

    points: np.ndarray
    at: np.ndarray

    @property
    def length(self) -> float:
        """Return the length of the whole way."""
        return float(self.at[-1])

    def place(self, s: np.ndarray | float) -> np.ndarray:
        """Return points (..., 2) after given lengths of way."""
        return find_places(self.points, self.at, s)


def cut(
    points: np.ndarray, at: np.ndarray, begin: float, end: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the part between two values of what moves straight from point to point (n, 2): at
    least two points, and the value at each. at: (n,) the value at each point.
    """
    inside = (at > begin) & (at < end)
    first, last = find_places(points, at, np.array([begin, end]))
    between = np.concatenate([[begin], at[inside], [end]])
    return np.concatenate([[first], points[inside], [last]]), between


def build_way(points: np.ndarray) -> Way:
    """Build a way through points (n, 2). Repeated ones are left out, but at least one is kept."""
    points = np.asarray(points, dtype=float)
    points = points[np.concatenate([[True], np.any(points[1:] != points[:-1], axis=1)])]
    return Way(points, measure_lengths(points))


def build_polyline(path: Path, spacing: float) -> np.ndarray:
    """Return the points (n, 2) of a polyline, or chords of another curve whose mean length is at
    most `spacing`, in units.
    """
    if path.curve == "polyline":
        return path.points
    legs = np.hypot(*np.diff(path.points, axis=0).T).sum()
    pieces = len(curves.bezier_pieces(path))
    samples = pieces * max(2, math.ceil(legs / spacing / pieces)) + 1
    points = curves.sample_matrix(path.curve, len(path.points), samples) @ path.points
    # Sums round; a way begins and ends exactly at the path's own points.
    points[[0, -1]] = path.points[curves.ends(path.curve)]
    return points


def build_drivable(path: Path, spacing: float, obstacles: Region) -> np.ndarray:
    """Return `build_polyline` of a path, with further points where chords enter an obstacle.

    A chord of a curve that touches an obstacle can enter it. Between two free points it is halved
    until no part of it does.
    """
    points = build_polyline(path, spacing)
    if path.curve == "polyline" or _is_free(points, obstacles):
        return points
    return _halve_chords(
        path, np.linspace(0.0, len(curves.bezier_pieces(path)), len(points)), points, obstacles
    )


def _halve_chords(path: Path, at: np.ndarray, points: np.ndarray, obstacles: Region) -> np.ndarray:
    """Add points of a path between given ones (n, 2) where their chord enters an obstacle; return
    all points (m, 2).

    at: parameters (n,) of the given points, as in `curves.point_at`.
    """
    corners = [points[0]]
    # A stack with the first chord on top, so that points come out in order.
    open_ = list(itertools.pairwise(zip(at, points)))[::-1]
    while open_:
        begin, until = open_.pop()
        chord = np.array([begin[1], until[1]])
        if (
            math.dist(*chord) < _SHORTEST
            or _is_free(chord, obstacles)
            or any(is_blocked(obstacles, tuple(end)) for end in chord)
        ):
            corners.append(until[1])
            continue
        between = (begin[0] + until[0]) / 2
        middle = (between, curves.point_at(path, between))
        open_ += [(middle, until), (begin, middle)]
    return np.array(corners)


def _is_free(points: np.ndarray, obstacles: Region) -> bool:
    """Return whether a polyline (n, 2) is free."""
    return math.isinf(find_first_collision(points, obstacles))


def find_first_collision(points: np.ndarray, obstacles: Region) -> float:
    """Return where a polyline (n, 2) first enters an obstacle: the chord's number plus the share of
    it; infinite if never.
    """
    chords = np.stack([points[:-1], points[1:]], axis=1)
    collision_at, _ = checker.find_first_collision(from_origin(chords, obstacles), obstacles)
    return collision_at
