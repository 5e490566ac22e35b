"""Square maps with blocks of occupied cells at random positions, none of which touch."""

import math
from collections.abc import Iterator
from functools import cache
from typing import Literal

import numpy as np
from pydantic import Field

from bezierplan.schema.model import Count, Positive
from bezierplan.workspaces import lattice
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.kinds import Workspace
from bezierplan.workspaces.random_field import end_cells
from bezierplan.workspaces.seeds import generator

# Number of maps drawn before giving up, and number of blocks tried for one map.
MOST_MAPS = 500
MOST_BLOCKS = 4000

# Tolerance between the shortest lattice path's length and the wanted one, in cells.
_SAME_LENGTH = 1e-4


class Options(Workspace):
    """Keys of a workspace."""

    drawn_kind = "grid"
    with_side = True

    largest_block: Count = Field(
        description="the most cells of a block's side, a whole number of at least 1"
    )
    clear_ends: Count = Field(
        description="a whole number of at least 1: 1 keeps the cells of start and target free"
    )
    corners: Literal["free", "one", "none"] = Field(
        description="how many of the two cells that a diagonal step passes between may be occupied"
    )
    lattice_length: Positive | None = Field(
        None, description="the length that the shortest lattice path must have, a number above 0"
    )


def draw(description: dict, problem: dict, name: str) -> Grid:
    """Draw the first of some maps (`draw_maps`) whose shortest path over the 8-connected
    lattice has the length `lattice_length`, in cells, if one is given.

    Raises ValueError if there is none.
    """
    from bezierplan.geometry import shortest_paths

    wanted, corners = description.get("lattice_length"), description["corners"]
    for grid in draw_maps(description, problem, name):
        ends = lattice.build_grid_lattice(
            grid, tuple(problem["start"]), tuple(problem["target"]), corners
        )
        start, target = divmod(ends.start, problem["side"]), divmod(ends.target, problem["side"])
        path = shortest_paths.lattice_path(grid.occupied, start, target, ends.diagonal, corners)
        length = path.length + ends.ends
        if math.isfinite(length) and (wanted is None or abs(length - wanted) < _SAME_LENGTH):
            return grid
    asked = (
        "a path from start to target"
        if wanted is None
        else f"a shortest lattice path of lattice_length {wanted:g}"
    )
    raise ValueError(
        f"obstacles: {problem['obstacles']}: of {MOST_MAPS} maps none has so many occupied cells "
        f"and {asked}"
    )


def draw_maps(description: dict, problem: dict, name: str) -> Iterator[Grid]:
    """Draw maps for a problem, one after another, from names and numbers alone.

    description: largest_block, the maximum side of a block in cells; clear_ends, how many cells in
    every direction from start and target stay free, including their own; and unit. problem: side,
    the width and height of a map in cells; start; target; layout, its number; and obstacles, the
    number of occupied cells. name: study's and workspace's.

    Width, height and place of a block are uniform. A block that touches another, even at a corner,
    comes too close to an end, or would occupy too many cells is left out. Draws with the required
    number of occupied cells are maps; there are `MOST_MAPS` draws.

    Raises ValueError, naming the key, if start or target is not on the map.
    """
    side = problem["side"]
    empty = Grid(np.zeros((side, side), dtype=bool), 1.0, description["unit"])
    ends = np.zeros((side, side), dtype=bool)
    for cell in end_cells(empty, problem):
        ends |= (
            np.abs(np.indices(ends.shape) - np.reshape(cell, (2, 1, 1))).max(axis=0)
            < description["clear_ends"]
        )
    numbers = *problem["start"], *problem["target"], problem["obstacles"], problem["layout"]
    # The wanted length is no part of the seed: it chooses among the same maps.
    rng = generator(name, side, *numbers)
    for _ in range(MOST_MAPS):
        occupied = _draw_blocks(
            rng, ends, problem["obstacles"], min(description["largest_block"], side)
        )
        if occupied.sum() == problem["obstacles"]:
            yield Grid(occupied, 1.0, description["unit"])


def _draw_blocks(rng: np.random.Generator, ends: np.ndarray, most: int, largest: int) -> np.ndarray:
    """Draw occupied cells (side, side), `most` of them, or fewer if the blocks run out.

    ends: bool (side, side), cells to leave free.
    """
    side = len(ends)
    occupied = np.zeros_like(ends)
    count = 0
    # All numbers are drawn at once, so a block does not depend on which ones before it fit.
    sizes = rng.integers(1, largest + 1, size=(MOST_BLOCKS, 2))
    corners = rng.integers(0, side - sizes + 1)
    # A set of cells is an integer with a bit for each cell of the map and of a frame around it, so
    # that a block is tested in one operation.
    stride = side + 2
    taken = sum(
        1 << ((row + 1) * stride + column + 1) for row, column in np.argwhere(ends).tolist()
    )
    for (height, width), (row, column) in zip(sizes.tolist(), corners.tolist()):
        if count == most:
            break
        block = _fill_rectangle(height, width, stride) << ((row + 1) * stride + column + 1)
        if count + height * width <= most and not taken & block:
            # With a frame around the block, so that none touches it, not even at a corner.
            taken |= _fill_rectangle(height + 2, width + 2, stride) << (row * stride + column)
            occupied[row : row + height, column : column + width] = True
            count += height * width
    return occupied


@cache
def _fill_rectangle(height: int, width: int, stride: int) -> int:
    """Return the cells of a rectangle from its lower left cell on; `stride` cells make a row."""
    return sum(((1 << width) - 1) << (row * stride) for row in range(height))
