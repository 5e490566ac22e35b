"""Memory of a map that has grown by a robot's radius, so that a path of the robot's centre is also
judged on the map itself.
"""

from typing import Any, NamedTuple

import numpy as np


class Growth(NamedTuple):
    """How a map has grown.

    radius: by how much obstacles grew and the border shrank, in units.
    original: the map before.
    centres: (n, 2) the corners of its obstacles around which the grown ones are round, in units.
    """

    radius: float
    original: Any
    centres: np.ndarray


def find_growth(workspace: Any) -> Growth | None:
    """Return by how much a map has grown and from which; None for a map as it was given."""
    # Cells drawn from shapes have not grown themselves: the shapes have.
    shapes = getattr(workspace, "shapes", None)
    return (shapes.growth if shapes else None) or workspace.growth


def original(workspace: Any) -> Any:
    """Return the map before it grew."""
    growth = find_growth(workspace)
    return growth.original if growth else workspace
