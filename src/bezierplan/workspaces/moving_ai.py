"""Grids of the MovingAI benchmarks: a `.map` file, whose cells of `.`, `G` and `S` are free, and
those of `@`, `O`, `T` and `W` occupied.
"""

from pathlib import Path

from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.text_file import lines_of, read_text

_CELLS = str.maketrans("GS@OTW", "..####")


def read(file: Path, unit: str) -> Grid:
    """The grid of a `.map` file, with cells of side 1. Raises ValueError, naming the line."""
    head, cells = (lines := lines_of(read_text(file)))[:4], lines[4:]
    words = [line.split() for line in head]
    if [each[:1] for each in words] != [["type"], ["height"], ["width"], ["map"]]:
        raise ValueError("line 1: expected four lines with type octile, height, width, and map")
    try:
        grid = from_lines([line.translate(_CELLS) for line in cells], 1.0, unit)
    except ValueError as error:
        raise ValueError(f"below the word map: {error}") from None
    if [each[1:] for each in words[1:3]] != [[str(count)] for count in grid.occupied.shape]:
        rows, columns = grid.occupied.shape
        raise ValueError(f"line 2: {head[1]}, {head[2]}; but {rows} x {columns} cells follow")
    return grid
