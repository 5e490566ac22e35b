"""A grid of square cells, each free or occupied.

Cells are numbered row by row from the bottom left, from 0: number = column + columns * row (song2016, Section III; other papers number
differently and convert where they read or print numbers).
"""

from dataclasses import dataclass

import numpy as np

# A coordinate this close below a grid line, in cells, counts as on it. Centres of cells put many samples of a curve exactly on grid
# lines, where rounding alone would decide; with this margin every program gives the same cell: the one above or to the right.
ON_LINE = 1e-9


@dataclass(frozen=True)
class Grid:
    """Cells of a rectangle whose lower left corner is the origin.

    occupied: bool (rows, columns), row 0 at the bottom. cell: side of a cell, in units. unit: name of the unit of length.
    """

    occupied: np.ndarray
    cell: float
    unit: str

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Lowest and highest x, lowest and highest y, in units."""
        rows, columns = self.occupied.shape
        return 0.0, columns * self.cell, 0.0, rows * self.cell

    def cell_of(self, x: float, y: float) -> tuple[int, int] | None:
        """Row and column of a point in units (song2016, eq. 8), or None outside the grid."""
        rows, columns = self.occupied.shape
        if not (0 <= x <= columns * self.cell and 0 <= y <= rows * self.cell):
            return None
        row, column = (int(np.floor(value / self.cell + ON_LINE)) for value in (y, x))
        return min(row, rows - 1), min(column, columns - 1)

    def centre(self, number: int) -> tuple[float, float]:
        """Centre of a cell in units (song2016, eq. 7). Raises ValueError for a number that is not on the grid."""
        rows, columns = self.occupied.shape
        if not 0 <= number < rows * columns:
            raise ValueError(f"cell {number} is not on the grid; its cells are numbered 0 to {rows * columns - 1}")
        row, column = divmod(number, columns)
        return (column + 0.5) * self.cell, (row + 0.5) * self.cell


def embed(occupied: np.ndarray) -> np.ndarray:
    """The grid in the smallest one of a power of two of rows and of columns, the surplus cells occupied (song2016, Remark 1).

    occupied: bool (rows, columns) -> bool (2**i, 2**j). With it every binary cell number is a cell.
    """
    rows, columns = (1 << (count - 1).bit_length() for count in occupied.shape)
    embedded = np.ones((rows, columns), dtype=bool)
    embedded[: occupied.shape[0], : occupied.shape[1]] = occupied
    return embedded


def from_lines(lines: list[str], cell: float, unit: str) -> Grid:
    """A grid from text, top row first: `.` is a free cell, `#` an occupied one.

    Raises ValueError, naming the line, for an empty or ragged map and for any other character.
    """
    if not lines:
        raise ValueError("the map is empty; expected lines of . (free) and # (occupied)")
    for number, line in enumerate(lines, start=1):
        for character in line:
            if character not in ".#":
                raise ValueError(f"line {number}: unknown character {character!r}; a cell is . (free) or # (occupied)")
        if len(line) != len(lines[0]):
            raise ValueError(f"line {number} has {len(line)} cells, the first line has {len(lines[0])}; all lines need the same number")
    occupied = np.array([[character == "#" for character in line] for line in reversed(lines)])
    return Grid(occupied, cell, unit)


def to_lines(grid: Grid) -> list[str]:
    """The text of a grid, top row first."""
    return ["".join("#" if occupied else "." for occupied in row) for row in grid.occupied[::-1]]
