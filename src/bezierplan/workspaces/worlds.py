"""Worlds that change while a robot drives: circles that move, and grids whose cells change. They
never react to the robot.

Time is counted in steps. A world has a pace, the way that a robot covers in a step, and an end,
after which a robot has failed.
"""

import json
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import numpy as np

from bezierplan.kernels import compile_kernel
from bezierplan.workspaces import files, random_field
from bezierplan.workspaces.arrays import freeze
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.limits import Bounds


@dataclass(frozen=True)
class MovingCircles:
    """Circles that move in straight lines and are reflected where their centres meet a wall.

    At whole steps the reflected positions are exact. From one step to the next each circle moves
    uniformly along a straight line.

    bounds: lowest and highest x, lowest and highest y of the robot's field, in units.
    walls: likewise, of the centres.
    centres: (n, 2) at step 0, in units.
    velocities: (n, 2), in units per step.
    radii: (n,), in units.
    view: planners see the field's cells, of side 1 (`random_field`), or the circles.
    pace: in units per step.
    end: in steps.
    unit: name of the unit of length.
    """

    bounds: Bounds
    walls: Bounds
    centres: np.ndarray
    velocities: np.ndarray
    radii: np.ndarray
    view: Literal["cells", "circles"]
    pace: float
    end: int
    unit: str

    def __post_init__(self) -> None:
        freeze(self, "centres", "velocities", "radii")

    def at(self, step: int) -> np.ndarray:
        """Return the centres (n, 2) at a whole step, in units."""
        return positions(self.centres, self.velocities, np.array(self.walls, float), step)

    def workspace(self, step: int, margin: float = 0.0) -> Grid | Circles:
        """Return what planners see at a step: the circles, grown by a margin in units, or the cells
        that they occupy.
        """
        circles = self.obstacles(step, margin)
        if self.view == "circles":
            return circles
        # A field of cells has its centres within the walls; the robot's bounds reach half a cell
        # farther.
        return random_field.from_circles(replace(circles, bounds=self.walls))

    def obstacles(self, step: int, margin: float = 0.0) -> Circles:
        """Return what the robot must not enter at a step; grown by a margin in units."""
        return Circles(self.bounds, self.at(step), self.radii + margin, self.unit)


@dataclass(frozen=True)
class ChangingCells:
    """Grids that follow each other.

    maps: the first one, and the one that begins at each moment.
    moments: (changes,) ascending, in steps.
    pace: in units per step.
    end: in steps.
    """

    maps: tuple[Grid, ...]
    moments: np.ndarray
    pace: float
    end: int

    def __post_init__(self) -> None:
        freeze(self, "moments")

    def index(self, time: float) -> int:
        """Return the number of the map in force at a time; at a moment of change, the new one's."""
        return int(np.searchsorted(self.moments, time, side="right"))

    def workspace(self, time: float, margin: float = 0.0) -> Grid:
        """Return what planners see at a time; cells have no margin."""
        return self.maps[self.index(time)]

    obstacles = workspace
    """What the robot must not enter at a time."""


World = MovingCircles | ChangingCells


@compile_kernel
def positions(centres, velocities, walls, step):
    """Return the centres (n, 2) after some steps of uniform motion with reflection at walls.

    walls: (4,) lowest and highest x, lowest and highest y.

    >>> walls = np.array([0.0, 4.0, 0.0, 3.0])
    >>> positions(np.array([[1.0, 1.0]]), np.array([[0.0, 3.0]]), walls, 1).tolist()
    [[1.0, 2.0]]
    """
    moved = np.empty_like(centres)
    for axis in range(2):
        low, width = walls[2 * axis], walls[2 * axis + 1] - walls[2 * axis]
        for i in range(len(centres)):
            # Unfolded, the motion is uniform; every other image of the field is mirrored.
            along = (centres[i, axis] + velocities[i, axis] * step - low) % (2.0 * width)
            moved[i, axis] = low + min(along, 2.0 * width - along)
    return moved


def to_json(world: World) -> str:
    """Write a world as text; `from_json` restores it bit by bit."""
    if isinstance(world, ChangingCells):
        content = {
            "maps": [files.write_json(each) for each in world.maps],
            "moments": world.moments.tolist(),
        }
    else:
        # Python writes the shortest decimals that restore a number's every bit.
        table = np.column_stack([world.centres, world.velocities, world.radii]).tolist()
        content = {
            "bounds": world.bounds,
            "walls": world.walls,
            "circles": table,
            "seen": world.view,
            "unit": world.unit,
        }
    return json.dumps(content | {"pace": world.pace, "end": world.end})


def from_json(text: str) -> World:
    """Read the world that `to_json` wrote."""
    content = json.loads(text)
    if "maps" in content:
        maps = tuple(map(_read_grid, content["maps"]))
        return ChangingCells(maps, np.array(content["moments"]), content["pace"], content["end"])
    table = np.array(content["circles"], float).reshape(-1, 5)
    return MovingCircles(
        bounds=tuple(content["bounds"]),
        walls=tuple(content["walls"]),
        centres=table[:, :2],
        velocities=table[:, 2:4],
        radii=table[:, 4],
        view=content["seen"],
        pace=content["pace"],
        end=content["end"],
        unit=content["unit"],
    )


# Worlds with equal maps share the object, so `build_region` prepares it once.
@cache
def _read_grid(text: str) -> Grid:
    """Read the map that `files.write_json` wrote."""
    workspace = files.read_json(text)
    assert isinstance(workspace, Grid)  # the cells of a world change
    return workspace
