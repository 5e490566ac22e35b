"""Ways that a robot follows: polylines with arc length."""

import math
from typing import NamedTuple

import numpy as np

from bezierplan.geometry import curves
from bezierplan.workspaces.problem import Path


class Way(NamedTuple):
    """points: (n, 2), in units, no two successive ones equal. at: (n,) length of the way up to each of them."""

    points: np.ndarray
    at: np.ndarray

    @property
    def length(self) -> float:
        """Length of the whole way."""
        return float(self.at[-1])

    def place(self, s: np.ndarray | float) -> np.ndarray:
        """Points (..., 2) after given lengths of way."""
        return np.stack([np.interp(s, self.at, self.points[:, axis]) for axis in range(2)], axis=-1)

    def part(self, begin: float, end: float) -> np.ndarray:
        """The polyline (m, 2) between two lengths of way, of at least two points."""
        inside = self.points[(self.at > begin) & (self.at < end)]
        return np.concatenate([self.place(begin)[None], inside, self.place(end)[None]])


def way(points: np.ndarray) -> Way:
    """A way through points (n, 2); repeated ones are left out, except that a way has at least one point."""
    points = np.asarray(points, dtype=float)
    points = points[np.concatenate([[True], np.any(points[1:] != points[:-1], axis=1)])]
    return Way(points, np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))]))


def polyline(path: Path, spacing: float) -> np.ndarray:
    """The points (n, 2) of a polyline, or chords of another curve whose mean length is at most a spacing, in units."""
    if path.curve == "polyline":
        return path.points
    legs = np.hypot(*np.diff(path.points, axis=0).T).sum()
    pieces = len(curves.bezier_pieces(path))
    samples = pieces * max(2, math.ceil(legs / spacing / pieces)) + 1
    points = curves.sample_matrix(path.curve, len(path.points), samples) @ path.points
    points[[0, -1]] = path.points[list(curves.ends(path.curve))]
    return points
