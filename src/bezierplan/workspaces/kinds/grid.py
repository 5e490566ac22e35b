"""A map of cells."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from pydantic import Field

from bezierplan.workspaces import grid
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.kinds import CellMap, File, naming, text
from bezierplan.workspaces.limits import check_numbers, check_thickness
from bezierplan.workspaces.text_file import split_lines


class Options(CellMap):
    """Keys of a workspace of kind `grid`."""

    heights: File = Field(None, description="a file of heights in the study's folder")


def load(description: dict, folder: Path) -> Grid:
    """Read the cells of a file of . and #, the top row first.

    A file of numbers may give their heights, likewise.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     _ = Path(folder, "map.txt").write_text("..#\\n...\\n")
    ...     room = load({"file": "map.txt", "cell": 0.5, "unit": "m"}, Path(folder))
    >>> room.occupied.tolist(), room.bounds
    ([[False, False, False], [False, False, True]], (0.0, 1.5, 0.0, 1.0))
    """
    check_thickness(description["cell"], "cell:")
    lines = split_lines(text(description, "file", folder))
    with naming(description["file"]):
        flat = grid.from_lines(lines, float(description["cell"]), description["unit"])
        # A cell within the limits can still make a map beyond them.
        check_numbers(np.array(flat.bounds), f"cell: {description['cell']}: the border")
    if "heights" not in description:
        return flat
    lines = split_lines(text(description, "heights", folder))
    with naming(description["heights"]):
        return replace(flat, heights=grid.heights_from_lines(lines, flat.occupied.shape))
