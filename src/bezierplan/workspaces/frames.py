"""The frame in which a map is computed with: near the origin, since the certified checker keeps its
tolerance only for small numbers, and along the axes of a grid. Maps in projected coordinates lie
far away, and maps of ROS may be turned: places and headings go inward into the frame, and what is
answered goes outward into the world.

An offset without a yaw is a whole number of units, so that moving such a map is exact.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.files import Workspace
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.grown import Grown, original
from bezierplan.workspaces.limits import LARGEST
from bezierplan.workspaces.polygons import Polygons


@dataclass(frozen=True)
class Frame:
    """offset: x and y in the world of the frame's origin, in units. yaw: direction in the world of
    its x-axis, in radians counterclockwise.
    """

    offset: tuple[float, float] = (0.0, 0.0)
    yaw: float = 0.0

    def inward(self, points: ArrayLike) -> np.ndarray:
        """Points (..., 2) of the world in the frame."""
        return self.inward_vectors(np.asarray(points, dtype=float) - self.offset)

    def outward(self, points: ArrayLike) -> np.ndarray:
        """The inverse of `inward`."""
        return self.outward_vectors(points) + self.offset

    def inward_vectors(self, vectors: ArrayLike) -> np.ndarray:
        """Vectors (..., 2) of the world in the frame: these are turned only."""
        return _turned(vectors, -self.yaw)

    def outward_vectors(self, vectors: ArrayLike) -> np.ndarray:
        """The inverse of `inward_vectors`."""
        return _turned(vectors, self.yaw)

    def inward_heading(self, heading: float) -> float:
        """A heading in the world, in radians, in the frame; of a turned one from -pi to pi."""
        return math.remainder(heading - self.yaw, math.tau) if self.yaw else heading

    def outward_headings(self, headings: np.ndarray) -> np.ndarray:
        """Headings (n,) in the frame, in radians, in the world; of a turned one from -pi to pi."""
        if not self.yaw:
            return headings
        turned = headings + self.yaw
        return turned - math.tau * np.round(turned / math.tau)


WORLD = Frame()
"""The frame of a map that lies near the origin along the axes of the world."""


def frame_of(workspace: Workspace) -> Frame:
    """The frame of a map of the world: that of the world, unless a coordinate is beyond `LARGEST`
    or the map is turned.

    It is the same before and after the map grows by a robot's radius. Raises ValueError for a map
    that is wider than that.
    """
    home = original(workspace)
    x_low, x_high, y_low, y_high = bounds = home.bounds
    yaw = home.yaw if isinstance(home, Grid) else 0.0
    if not yaw and max(map(abs, bounds)) <= LARGEST:
        return WORLD
    low = (x_low, y_low) if yaw else (float(math.floor(x_low)), float(math.floor(y_low)))
    if max(x_high - low[0], y_high - low[1]) > LARGEST:
        raise ValueError(
            f"the border: {x_high - x_low:g} x {y_high - y_low:g} units; expected at most "
            f"{LARGEST:g} on a side, so a larger unit"
        )
    return Frame(low, yaw)


def inward_map(workspace: Workspace, frame: Frame) -> Workspace:
    """A map of the world in its frame."""
    if frame == WORLD:
        return workspace
    return _placed(workspace, (-frame.offset[0], -frame.offset[1]), 0.0)


def outward_map(workspace: Workspace, frame: Frame) -> Workspace:
    """A map in its frame as one of the world; one that is turned is a grid."""
    return workspace if frame == WORLD else _placed(workspace, frame.offset, frame.yaw)


def corners(workspace: Workspace, frame: Frame) -> np.ndarray:
    """The corners (4, 2) in the world of the border of a map in its frame, counterclockwise."""
    x_low, x_high, y_low, y_high = workspace.bounds
    around = [(x_low, y_low), (x_high, y_low), (x_high, y_high), (x_low, y_high)]
    return frame.outward(around)


def _placed(workspace: Workspace, by: tuple[float, float], yaw: float) -> Workspace:
    """A map whose coordinates are larger by a vector, and whose grids have a yaw."""
    if not isinstance(workspace, Grid):
        return _moved(workspace, by, yaw)
    drawn = _moved(workspace.drawn, by, yaw) if workspace.drawn else None
    origin = workspace.origin[0] + by[0], workspace.origin[1] + by[1]
    grown = _grown(workspace.grown, by, yaw)
    return replace(workspace, origin=origin, yaw=yaw, drawn=drawn, grown=grown)


def _moved(
    workspace: Circles | Polygons, by: tuple[float, float], yaw: float
) -> Circles | Polygons:
    x_low, x_high, y_low, y_high = workspace.bounds
    bounds = x_low + by[0], x_high + by[0], y_low + by[1], y_high + by[1]
    grown = _grown(workspace.grown, by, yaw)
    if isinstance(workspace, Circles):
        return replace(
            workspace, bounds=bounds, centres=workspace.centres + np.array(by), grown=grown
        )
    obstacles = tuple(tuple(ring + np.array(by) for ring in rings) for rings in workspace.obstacles)
    return replace(workspace, bounds=bounds, obstacles=obstacles, grown=grown)


def _grown(grown: Grown | None, by: tuple[float, float], yaw: float) -> Grown | None:
    return grown and Grown(
        grown.radius, _placed(grown.original, by, yaw), grown.centres + np.array(by)
    )


def _turned(vectors: ArrayLike, yaw: float) -> np.ndarray:
    """Vectors (..., 2) turned by an angle, in radians counterclockwise."""
    vectors = np.asarray(vectors, dtype=float)
    if not yaw:
        return vectors
    x, y, cos, sin = vectors[..., 0], vectors[..., 1], math.cos(yaw), math.sin(yaw)
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
