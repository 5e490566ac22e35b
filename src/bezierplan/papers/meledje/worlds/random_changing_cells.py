"""A map whose cells change at random; `obstacles` of a problem says how many at a time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field

from bezierplan.schema.model import Count
from bezierplan.workspaces import random_field
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.kinds import CellMap, World, grid
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    from bezierplan.workspaces.worlds import ChangingCells

# Draws of one change before a world is abandoned.
_MOST_CHANGES = 1000


class Options(CellMap, World):
    """Keys of a workspace."""

    drawn_kind = "grid"

    every: Count = Field(
        description="after how many steps as many cells change as a problem has obstacles, a "
        "whole number of at least 1"
    )


def world(description: dict, problem: dict, name: str, folder: Path, length: Any) -> ChangingCells:
    """Draw maps of which, at every `every`-th step, as many random cells change as the problem has
    `obstacles`.

    Start and target stay free, and connected.

    Raises ValueError for more obstacles than cells that can change, and if no such change is found.
    """
    from bezierplan.workspaces.worlds import ChangingCells

    first = grid.load(description, folder)
    start, target = random_field.end_cells(first, problem)
    moments = np.arange(
        description["every"], description["steps"], description["every"], dtype=float
    )
    ends = *problem["start"], *problem["target"]
    # The seed leaves out `every` and the steps: a longer world begins like a shorter one.
    rng = generator(name, *ends, problem["obstacles"], problem["layout"])
    changeable = np.ones(first.occupied.shape, dtype=bool)
    # A change never blocks an end.
    changeable[start] = changeable[target] = False
    numbers = np.flatnonzero(changeable)
    if problem["obstacles"] > len(numbers):
        raise ValueError(
            f"obstacles: {problem['obstacles']}; "
            f"expected at most {len(numbers)}, the cells that can change"
        )
    maps = [first]
    for _ in moments:
        for _ in range(_MOST_CHANGES):
            occupied = maps[-1].occupied.copy()
            occupied.flat[rng.choice(numbers, problem["obstacles"], replace=False)] ^= True
            if random_field.is_connected(occupied, start, target):
                break
        else:
            raise ValueError(
                f"obstacles: {problem['obstacles']}: start and target are cut off from each other "
                f"in {_MOST_CHANGES} changes"
            )
        maps.append(Grid(occupied, first.cell, first.unit))
    return ChangingCells(tuple(maps), moments, float(description["pace"]), description["steps"])
