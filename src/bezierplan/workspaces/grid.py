"""A grid of square cells, each free or occupied.

Cells are numbered row by row from the bottom left, from 0: number = column + columns * row
(song2016, Section III; code for papers that number differently converts when it reads or prints).
"""

import math
from dataclasses import dataclass

import numpy as np

from bezierplan.workspaces.arrays import freeze, read_only
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grown import Growth
from bezierplan.workspaces.limits import Bounds, check_cells, check_numbers
from bezierplan.workspaces.polygons import Polygons

# A coordinate this close below a grid line, in cells, counts as on it. Control points at cell
# centres put many samples of a curve exactly on grid lines, where rounding alone would decide; with
# this margin every program finds the same cell: the one above or to the right.
ON_LINE = 1e-9


@dataclass(frozen=True, eq=False)
class Grid:
    """Cells of a rectangle.

    occupied: bool (rows, columns), row 0 at the bottom.
    cell: side of a cell, in units.
    unit: name of the unit of length.
    origin: x, y of the lower left corner, in units.
    shapes: the shapes from which the cells were drawn, if any: circles, which only pictures show,
    or polygons, which are then the obstacles of the certified check and of the exact bounds
    (`raster`).
    heights: (rows, columns) height of the ground in each cell, in units, where it is not flat; only
    some planners use them.
    growth: the grid before its occupied cells grew by a robot's radius, if they did.

    The arrays are read-only.
    """

    occupied: np.ndarray
    cell: float
    unit: str
    origin: tuple[float, float] = (0.0, 0.0)
    shapes: Circles | Polygons | None = None
    heights: np.ndarray | None = None
    growth: Growth | None = None

    def __post_init__(self) -> None:
        # A frozen dataclass sets its own fields only this way.
        object.__setattr__(self, "occupied", read_only(self.occupied, bool))
        if self.heights is not None:
            freeze(self, "heights")

    @property
    def bounds(self) -> Bounds:
        """Return the lowest and highest x, lowest and highest y, in units."""
        rows, columns = self.occupied.shape
        x, y = self.origin
        return x, x + columns * self.cell, y, y + rows * self.cell

    def in_cells(self, points: np.ndarray) -> np.ndarray:
        """Return points (..., 2) in units as multiples of a cell from the lower left corner: cell i
        reaches from i to i + 1.
        """
        return (points - np.array(self.origin)) / self.cell

    def in_units(self, points: np.ndarray) -> np.ndarray:
        """Return points (..., 2) in units; the inverse of `in_cells`."""
        return points * self.cell + np.array(self.origin)

    def cell_of(self, x: float, y: float) -> tuple[int, int] | None:
        """Return row and column of a point in units (song2016, eq. 8), or None outside the grid."""
        # Plain numbers: planners ask for one point after the other, and an array for each takes ten
        # times as long.
        x, y, (x_low, y_low) = float(x), float(y), self.origin
        rows, columns = self.occupied.shape
        if not (
            x_low <= x <= x_low + columns * self.cell and y_low <= y <= y_low + rows * self.cell
        ):
            return None
        column = math.floor((x - x_low) / self.cell + ON_LINE)
        row = math.floor((y - y_low) / self.cell + ON_LINE)
        # The upper and the right border belong to the last cells.
        return min(row, rows - 1), min(column, columns - 1)

    def centre(self, number: int) -> tuple[float, float]:
        """Return the centre of a cell in units (song2016, eq. 7).

        Raises ValueError for a number outside the grid.
        """
        rows, columns = self.occupied.shape
        if not 0 <= number < rows * columns:
            raise ValueError(
                f"cell {number} is not on the grid; its cells are numbered 0 to "
                f"{rows * columns - 1}"
            )
        row, column = divmod(number, columns)
        return self.origin[0] + (column + 0.5) * self.cell, self.origin[1] + (row + 0.5) * self.cell


def embed(occupied: np.ndarray) -> np.ndarray:
    """Embed a grid in the smallest one whose numbers of rows and columns are powers of two, with
    the surplus cells occupied (song2016, Remark 1).

    occupied: bool (rows, columns) -> bool (2**i, 2**j).

    Every binary cell number is then a cell.

    >>> embed(np.zeros((2, 3), dtype=bool)).astype(int).tolist()
    [[0, 0, 0, 1], [0, 0, 0, 1]]
    """
    surplus = [(0, (1 << (count - 1).bit_length()) - count) for count in occupied.shape]
    return np.pad(occupied, surplus, constant_values=True)


def add_wall(occupied: np.ndarray) -> np.ndarray:
    """Add a ring of occupied cells, which represents the outside: bool (rows + 2, columns + 2)."""
    return np.pad(occupied, 1, constant_values=True)


def find_occupied_around(cells: np.ndarray) -> np.ndarray:
    """Return which cells around each inner vertex of cells (rows, columns) are occupied: bool (4,
    rows - 1, columns - 1).

    In the order below left, below right, above left, above right. With a ring of cells around a
    grid, vertex [i, j] lies at x = j and y = i, in cells.
    """
    return np.stack([cells[:-1, :-1], cells[:-1, 1:], cells[1:, :-1], cells[1:, 1:]])


def find_runs(boundary: np.ndarray) -> np.ndarray:
    """Find maximal runs of true values in the rows of a bool array.

    Returns (n, 3): row, first column, column after the last.
    """
    around = np.pad(boundary, ((0, 0), (1, 1)))
    # Where a run begins and ends, in turn.
    row, column = np.nonzero(around[:, 1:] != around[:, :-1])
    return np.column_stack([row[::2], column[::2], column[1::2]]).astype(float)


def from_lines(lines: list[str], cell: float, unit: str) -> Grid:
    """Build a grid from text, top row first: `.` is a free cell, `#` an occupied one.

    Raises ValueError, naming the line, for an empty or ragged map, for any other character, and for
    too many cells.

    >>> room = from_lines(["....", ".##.", "#..."], cell=0.5, unit="m")
    >>> room.occupied[0].tolist()
    [True, False, False, False]
    >>> room.bounds
    (0.0, 2.0, 0.0, 1.5)
    >>> room.cell_of(0.75, 0.6)
    (1, 1)
    """
    if not lines or not lines[0]:
        raise ValueError("the map is empty; expected lines of . (free) and # (occupied)")
    for number, line in enumerate(lines, start=1):
        unknown = line.strip(".#")
        if unknown:
            raise ValueError(
                f"line {number}: unknown character {unknown[0]!r}; "
                "a cell is . (free) or # (occupied)"
            )
        if len(line) != len(lines[0]):
            raise ValueError(
                f"line {number} has {len(line)} cells, the first line has {len(lines[0])}; all "
                "lines need the same number"
            )
    check_cells(len(lines), len(lines[0]))
    # The text begins with the top row, the array with the bottom one.
    occupied = np.array(
        [np.frombuffer(line.encode(), dtype=np.uint8) == ord("#") for line in reversed(lines)]
    )
    return Grid(occupied, cell, unit)


def heights_from_lines(lines: list[str], shape: tuple[int, int]) -> np.ndarray:
    """Read the heights (rows, columns) of a grid of that shape from text: one number per cell,
    separated by spaces, top row first.

    Raises ValueError for a wrong number of rows or cells, and for anything that is not a finite
    number within the limits of coordinates.
    """
    try:
        heights = np.array([line.split() for line in reversed(lines)], float)
    except ValueError:
        heights = np.empty(0)
    if heights.shape != shape:
        rows, columns = shape
        raise ValueError(f"expected {rows} lines of {columns} numbers, one a cell")
    check_numbers(heights, "heights")
    return heights


def to_lines(grid: Grid) -> list[str]:
    """Write a grid as text, top row first."""
    return ["".join("#" if occupied else "." for occupied in row) for row in grid.occupied[::-1]]
