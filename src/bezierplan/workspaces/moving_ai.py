"""Grids and scenarios of the MovingAI benchmarks: a `.map` file of characters, and `.scen` files
with starts, targets and optimal lengths.

Cells of `.`, `G` and `S` are free, those of `@`, `O`, `T` and `W` are occupied. A scenario counts
columns from the left and rows from the top; its optimal length is that of the shortest path over
the eight neighbours, with diagonal steps of length sqrt 2, that cuts no corner of an occupied cell.
"""

from pathlib import Path, PureWindowsPath
from typing import NamedTuple

import numpy as np

from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.text_file import is_count, lines_of, read_text
from bezierplan.workspaces.text_file import number as number_of

FREE, OCCUPIED = ".GS", "@OTW"

MOST_CELLS = 16_000_000


class Scenario(NamedTuple):
    """One line of a `.scen` file. start, target: (x, y) the centres of their cells, in cells.
    optimal: length in cells.
    """

    start: tuple[float, float]
    target: tuple[float, float]
    optimal: float


def read(file: Path, unit: str) -> Grid:
    """The grid of a `.map` file, with cells of side 1. Raises ValueError, naming the line."""
    lines = lines_of(read_text(file, largest=2 * MOST_CELLS))
    kind, height, width = (
        _header(lines, number, key)
        for number, key in enumerate(("type", "height", "width"), start=1)
    )
    rows, columns = int(height), int(width)
    if kind != "octile":
        raise ValueError(f"line 1: type {kind}; expected type octile")
    if rows * columns > MOST_CELLS:
        raise ValueError(f"line 2: {rows} x {columns} cells; expected at most {MOST_CELLS:,}")
    if len(lines) < 4 or lines[3].strip() != "map":
        raise ValueError("line 4: expected the word map")
    cells = lines[4 : 4 + rows]
    if len(cells) != rows or any(lines[4 + rows :]):
        raise ValueError(f"height: {rows}; but {sum(map(bool, lines[4:]))} lines of cells follow")
    for number, line in enumerate(cells, start=5):
        if len(line) != columns:
            raise ValueError(f"line {number} has {len(line)} cells; expected {columns}, the width")
        strange = line.strip(FREE + OCCUPIED)
        if set(strange) - set(FREE + OCCUPIED):
            raise ValueError(
                f"line {number}: unknown character {strange[0]!r}; expected one of {FREE}{OCCUPIED}"
            )
    free = np.frombuffer("".join(cells).encode(), dtype=np.uint8).reshape(rows, columns)
    return Grid(~np.isin(free, np.frombuffer(FREE.encode(), dtype=np.uint8))[::-1], 1.0, unit)


def _header(lines: list[str], number: int, key: str) -> str:
    words = lines[number - 1].split() if len(lines) >= number else []
    if len(words) != 2 or words[0] != key or (key != "type" and not is_count(words[1])):
        found = lines[number - 1][:40] if len(lines) >= number else "the file ends"
        raise ValueError(
            f"line {number}: {found!r}; expected {key} and "
            f"{'octile' if key == 'type' else 'a whole number of at least 1'}"
        )
    return words[1]


def _whole(word: str) -> int:
    """A word as a whole number of at least 0. Raises ValueError."""
    if word != "0" and not is_count(word):
        raise ValueError
    return int(word)


def scenario(file: Path, number: int, grid: Grid, name: str) -> Scenario:
    """A scenario of a `.scen` file, by its number from 1, on the grid of a map file of that name.

    Raises ValueError, naming the line and what is expected, also for scenarios of a different map.
    """
    lines = lines_of(read_text(file, largest=2 * MOST_CELLS))
    if not lines or lines[0].split()[:1] != ["version"]:
        raise ValueError("line 1: expected version 1")
    if not 1 <= number < len(lines):
        raise ValueError(f"scenario {number}; expected a number from 1 to {len(lines) - 1}")
    line = f"line {number + 1}"
    words = lines[number].split()
    try:
        _, home, width, height, *ends = words
        columns, rows, x, y, target_x, target_y = map(_whole, (width, height, *ends[:4]))
        optimal = number_of(ends[4])
    except (ValueError, IndexError):
        raise ValueError(
            f"{line}: expected bucket, map, width, height, start x, start y, target x, target y, "
            "optimal length"
        ) from None
    if name not in (Path(home).name, PureWindowsPath(home).name):
        raise ValueError(f"{line}: map {home}; expected a scenario of {name}")
    if (rows, columns) != grid.occupied.shape:
        raise ValueError(
            f"{line}: a map of {columns} x {rows} cells; {name} has {grid.occupied.shape[1]} x "
            f"{grid.occupied.shape[0]}"
        )
    for end, column, row in (("start", x, y), ("target", target_x, target_y)):
        if not (0 <= column < columns and 0 <= row < rows) or grid.occupied[rows - 1 - row, column]:
            raise ValueError(f"{line}: {end} {column} {row}: expected a free cell of {name}")
    return Scenario((x + 0.5, rows - y - 0.5), (target_x + 0.5, rows - target_y - 0.5), optimal)
