"""Problems given to planners, and the paths they return."""

from typing import NamedTuple

import numpy as np

from bezierplan.workspaces.files import Workspace


class Problem(NamedTuple):
    """A workspace with a start and a target.

    Attributes
    ----------
    name : str
        Its name.
    workspace : Grid, Circles or Polygons
        What the robot moves in.
    start, target : tuple of float
        (x, y) in the workspace's unit.
    """

    name: str
    workspace: Workspace
    start: tuple[float, float]
    target: tuple[float, float]

    @property
    def ends(self) -> np.ndarray:
        """Return start and target (2, 2), in the workspace's unit."""
        return np.array([self.start, self.target], float)


class Path(NamedTuple):
    """A path, given by the control points of its curve.

    Attributes
    ----------
    curve : str
        A kind of `curves.CURVES`.
    points : (n, 2) array
        Control points, in the workspace's unit.
    """

    curve: str
    points: np.ndarray
