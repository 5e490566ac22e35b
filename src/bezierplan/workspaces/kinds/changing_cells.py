"""A map whose cells change."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from pydantic import Field, model_validator

from bezierplan.schema.model import Model, Positive, build_error
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.kinds import CellMap, File, World, grid

if TYPE_CHECKING:
    from bezierplan.workspaces.worlds import ChangingCells


class Change(Model):
    """A moment at which the cells of a map change."""

    file: File = Field(description="the map file that is valid from then on")
    after: Positive | None = Field(
        None,
        description="when: the share of its way that a robot on the shortest path from cell to "
        "cell has then covered, above 0",
    )
    at: Positive | None = Field(None, description="or when: a step, a number above 0")

    @model_validator(mode="after")
    def _check_moment(self) -> Change:
        """Refuse both or neither of after and at."""
        if len(self.model_fields_set & {"after", "at"}) != 1:
            raise build_error("expected either after or at")
        return self


class Options(CellMap, World):
    """Keys of a workspace of kind `changing_cells`."""

    given_kind = "grid"

    changes: list[Change] = Field(
        description="a list of {file, after} or {file, at}, in order of time", min_length=1
    )


def world(
    description: dict, problem: dict, name: str, folder: Path, length: Callable[[Grid], float]
) -> ChangingCells:
    """Build the maps of a description, each from its moment on.

    Raises ValueError for maps of different sizes, and for moments that do not ascend.
    """
    from bezierplan.workspaces.worlds import ChangingCells

    # Each map is a description of kind `grid`, so it is checked as one.
    names = [description["file"], *(change["file"] for change in description["changes"])]
    maps = tuple(grid.load(description | {"file": file}, folder) for file in names)
    for file, each in zip(names, maps):
        if each.occupied.shape != maps[0].occupied.shape:
            raise ValueError(
                f"changes: {file}: {each.occupied.shape} cells, but {names[0]} has "
                f"{maps[0].occupied.shape}"
            )
    pace = float(description["pace"])
    moments = np.array(
        [_moment(change, maps[0], length, pace) for change in description["changes"]]
    )
    if (np.diff(moments) <= 0).any() or (moments <= 0).any():
        raise ValueError(
            f"changes: they are at steps {', '.join(f'{each:g}' for each in moments)}; expected "
            "ascending ones above 0"
        )
    return ChangingCells(maps, moments, pace, description["steps"])


def _moment(change: dict, first: Grid, length: Callable[[Grid], float], pace: float) -> float:
    """Return the step at which a change happens: as given, or once a robot has made a share of the
    shortest way from cell to cell.
    """
    if "at" in change:
        return float(change["at"])
    # A share of the way of a robot that follows the shortest path from cell to cell.
    way = length(first)
    if math.isinf(way):
        raise ValueError(
            f"changes: after: {change['after']:g}: no path leads from start to target on the "
            "first map; expected at: a step"
        )
    return change["after"] * way / pace
