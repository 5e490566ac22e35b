"""Problems given to planners, and the paths they return."""

from typing import NamedTuple

import numpy as np

from bezierplan.workspaces.files import Workspace


class Problem(NamedTuple):
    """A workspace with a start and a target, both (x, y) in the workspace's unit."""

    name: str
    workspace: Workspace
    start: tuple[float, float]
    target: tuple[float, float]


class Path(NamedTuple):
    """A curve kind of `curves.CURVES` and its control points (n, 2), in the workspace's unit."""

    curve: str
    points: np.ndarray
