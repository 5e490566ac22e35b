"""The cells that a path touches, and lengths that count cells: 1 for a straight step, 1.5 for a
diagonal one (elhoseny2017, Section 4.6).

The paper counts points on the curve, and does not say how near they lie. `length_by_points` counts
points a cell apart. The nearer they lie, the more of the cells that the curve touches are counted,
up to all of them: `measure_cells4`, by which a free diagonal of N cells costs 1.5 N and any other
curve that is monotone in x and y about 2 N. `measure_cells8` leaves out the corner cells of that
sequence, as line rasterisation usually does.

In the kernels coordinates are in cells from the grid's lower left corner (`Grid.in_cells`): cell i
reaches from i to i + 1.
"""

import math

import numpy as np

from bezierplan.geometry import curves
from bezierplan.geometry.arc_length import find_places, measure_lengths
from bezierplan.kernels import allocation_free
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Path

STRAIGHT = 1.0
DIAGONAL = 1.5

# A coordinate this close to a grid line, in cells, keeps the cell of the previous sample. Otherwise
# rounding would decide, and the two diagonals of a field would differ in length.
_ON_LINE = 1e-9

# Two grid lines that a segment crosses at parameters this close are crossed at their corner. This
# is coarser than `_ON_LINE`, for a parameter is a quotient of differences, each with its own
# rounding.
_IN_CORNER = 1e-6

# A Bézier piece of more control points than this is cut into so many.
HIGH, CUT = 12, 8
# A multiple of this is the number of parts of each.
QUARTERS = 4

# Legs of a polyline whose lengths are computed together.
_BLOCK = 64

# A path of cells passes this close to their centres.
_CENTRE = 1e-9


@allocation_free
def count_parts(points: np.ndarray) -> int:
    """Return the number of equal parameter intervals over each of which a Bézier piece (degree + 1,
    2), in cells, moves less than one cell.

    The parts of a straight piece are at most half a cell long. The speed of a curve is at most its
    degree times the longest leg of its polygon.
    """
    degree = len(points) - 1
    total = longest = 0.0
    for i in range(degree):
        leg = math.sqrt(
            (points[i + 1, 0] - points[i, 0]) ** 2 + (points[i + 1, 1] - points[i, 1]) ** 2
        )
        total += leg
        longest = max(longest, leg)
    if degree == 1:
        return max(1, math.ceil(2.0 * total))
    # Two per cent more parts than the bound of the speed asks for: a step of exactly one cell
    # could skip a cell by rounding. A curve of a few cells gets two more, as its chords are short
    # beside its bends.
    count = math.ceil(max(2.0 * total, 1.02 * degree * longest)) + 2
    return count if degree < HIGH else -(-count // QUARTERS) * QUARTERS


@allocation_free
def cut(pieces: np.ndarray, points: int) -> None:
    """Cut a Bézier piece into parts of equal length in its parameter, in place (de Casteljau).

    pieces: (2**k, points or more, 2); the first holds the piece, of `points` control points, and
        all of them hold the parts in the end.
    """
    step = len(pieces) // 2
    while step > 0:
        for k in range(0, len(pieces), 2 * step):
            left, right = pieces[k].reshape(-1), pieces[k + step].reshape(-1)  # x, y, x, y, ...
            for i in range(2 * points):
                right[i] = left[i]
            for level in range(1, points):
                for i in range(2 * (points - level)):
                    right[i] = 0.5 * (right[i] + right[i + 2])
                left[2 * level], left[2 * level + 1] = right[0], right[1]
        step //= 2


def sample_curve(curve: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return x and y of samples of a curve less than a cell apart, from its Bézier pieces (pieces,
    degree + 1, 2).

    A piece of high degree is cut, for its polygon zigzags too much to tell how fast it is.
    """
    points = curve.shape[1]
    xs, ys = [], []
    for piece in curve:
        shorter = np.repeat(piece[None], CUT if points > HIGH else 1, axis=0)
        cut(shorter, points)
        for each in shorter:
            last = count_parts(each)
            x, y, t, power = np.empty((4, last + 1))
            write_samples(each, last, 0, 1, last + 1, x, y, t, power)
            xs.append(x)
            ys.append(y)
    return np.concatenate(xs), np.concatenate(ys)


@allocation_free
def write_samples(
    points: np.ndarray,
    last: int,
    first: int,
    stride: int,
    count: int,
    x: np.ndarray,
    y: np.ndarray,
    t: np.ndarray,
    power: np.ndarray,
) -> None:
    """Write x and y of a Bézier piece (degree + 1, 2) at `count` parameters: first / last, (first +
    stride) / last, ..., at most 1.

    t, power: (count,) or more, scratch.

    Horner's rule in Bernstein form, all weights positive, for all samples at once; two control
    points at a time, so that each sample is read and written fewer times. A sample is the same to
    the last bit, whichever others are written with it.
    """
    degree = len(points) - 1
    for s in range(count):
        t[s] = (first + s * stride) / last
        power[s] = 1.0
        x[s], y[s] = points[0, 0], points[0, 1]
    binomial = 1.0
    if degree % 2:
        binomial = float(degree)
        weight_x, weight_y = binomial * points[1, 0], binomial * points[1, 1]
        for s in range(count):
            power[s] = t[s]
            x[s] = x[s] * (1.0 - t[s]) + t[s] * weight_x
            y[s] = y[s] * (1.0 - t[s]) + t[s] * weight_y
    for i in range(1 + degree % 2, degree, 2):
        binomial *= (degree - i + 1) / i
        weight_x, weight_y = binomial * points[i, 0], binomial * points[i, 1]
        binomial *= (degree - i) / (i + 1)
        next_x, next_y = binomial * points[i + 1, 0], binomial * points[i + 1, 1]
        for s in range(count):
            rest = 1.0 - t[s]
            here = power[s] * t[s]
            power[s] = here * t[s]
            x[s] = (x[s] * rest + here * weight_x) * rest + power[s] * next_x
            y[s] = (y[s] * rest + here * weight_y) * rest + power[s] * next_y
    # Horner's rule can miss the last point by a bit: from degree 11 on binomials carry rounding.
    if first + (count - 1) * stride == last:
        x[count - 1], y[count - 1] = points[degree, 0], points[degree, 1]


@allocation_free
def find_cell_at(x: float, y: float, cells: np.ndarray) -> tuple[int, int]:
    """Return column and row of the cell (of an array (rows, columns)) in which a point lies; the
    upper and the right border belong to the last cells.
    """
    rows, columns = cells.shape
    return min(int(x), columns - 1), min(int(y), rows - 1)


@allocation_free
def _find_cell(coordinate: float, before: int) -> int:
    """Return the column or row of a coordinate; on a grid line, keep that of the sample before if
    it borders the line.
    """
    line = math.floor(coordinate + 0.5)
    if abs(coordinate - line) <= _ON_LINE and (before == line or before == line - 1):
        return before
    return math.floor(coordinate)


def list_touched_cells(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """List the columns and rows of the cells that a polyline touches, in order.

    Consecutive vertices are less than a cell apart. A step is diagonal only where the polyline
    passes through a corner of cells.
    """
    columns, rows = np.empty((2, 2 * len(x)), np.int64)
    count = write_touched_cells(x, y, columns, rows)
    return columns[:count], rows[:count]


@allocation_free
def write_touched_cells(x: np.ndarray, y: np.ndarray, columns: np.ndarray, rows: np.ndarray) -> int:
    """Write the columns and rows of the cells that a polyline (n,) touches, in order; return how
    many there are, at most 2 n.
    """
    column, row = math.floor(x[0]), math.floor(y[0])
    columns[0], rows[0] = column, row
    count = 1
    for s in range(1, len(x)):
        next_column, next_row = _find_cell(x[s], column), _find_cell(y[s], row)
        if next_column == column and next_row == row:
            continue
        if next_column != column and next_row != row:
            to_x = (max(column, next_column) - x[s - 1]) / (x[s] - x[s - 1])
            to_y = (max(row, next_row) - y[s - 1]) / (y[s] - y[s - 1])
            # The cell between: the line that is crossed first tells which.
            if abs(to_x - to_y) >= _IN_CORNER:
                columns[count] = next_column if to_x < to_y else column
                rows[count] = row if to_x < to_y else next_row
                count += 1
        column, row = next_column, next_row
        columns[count], rows[count] = column, row
        count += 1
    return count


@allocation_free
def count_occupied_cells(columns: np.ndarray, rows: np.ndarray, occupied: np.ndarray) -> int:
    """Count the cells of a sequence that are occupied, bool (rows, columns), or outside the
    grid.
    """
    count = 0
    for i in range(len(columns)):
        inside = 0 <= rows[i] < occupied.shape[0] and 0 <= columns[i] < occupied.shape[1]
        count += not inside or occupied[rows[i], columns[i]]
    return count


@allocation_free
def is_free_leg(occupied: np.ndarray, start: np.ndarray, end: np.ndarray) -> bool:
    """Tell whether all cells that a straight leg between two points (2,) touches are free; cells
    outside the grid are not free.

    These are the cells of `list_touched_cells`, found without samples: from grid line to grid line.
    A leg counts as passing through a corner if it comes so close that no sample could tell the
    difference, so no leg is free here that is not free there.
    """
    rows, columns = occupied.shape
    (x0, y0), (x1, y1) = start, end
    column, row = math.floor(x0), math.floor(y0)
    last_column, last_row = _find_last_cell(x0, x1), _find_last_cell(y0, y1)
    if (
        min(column, last_column) < 0
        or max(column, last_column) >= columns
        or min(row, last_row) < 0
        or max(row, last_row) >= rows
    ):
        return False
    if occupied[row, column]:
        return False
    width, height = abs(x1 - x0), abs(y1 - y0)
    right, up = x1 > x0, y1 > y0
    # Distances to the next grid lines along x and y.
    to_x = column + 1 - x0 if right else x0 - column
    to_y = row + 1 - y0 if up else y0 - row
    in_corner = _ON_LINE * min(width, height)
    while column != last_column or row != last_row:
        later = to_x * height - to_y * width  # above 0: the horizontal line comes first
        crosses_x = column != last_column and (row == last_row or later <= in_corner)
        if row != last_row and (column == last_column or later >= -in_corner):
            row += 1 if up else -1
            to_y += 1.0
        if crosses_x:
            column += 1 if right else -1
            to_x += 1.0
        if occupied[row, column]:
            return False
    return True


@allocation_free
def _find_last_cell(first: float, last: float) -> int:
    """Return the column or row in which a leg ends; if it ends on a grid line, the one that it
    comes from.
    """
    if last > first:
        return max(math.floor(first), math.ceil(last - _ON_LINE) - 1)
    return min(math.floor(first), math.floor(last + _ON_LINE))


@allocation_free
def measure_cells4(columns: np.ndarray, rows: np.ndarray) -> float:
    """Return the length of a sequence of cells, each a neighbour of the one before."""
    length = 0.0
    for i in range(1, len(columns)):
        diagonal = columns[i] != columns[i - 1] and rows[i] != rows[i - 1]
        length += DIAGONAL if diagonal else STRAIGHT
    return length


@allocation_free
def measure_cells8(columns: np.ndarray, rows: np.ndarray) -> float:
    """Return the length of a sequence of cells in which a diagonal step replaces two straight ones
    that form it, from the beginning onwards.
    """
    length = 0.0
    i = 0
    while i < len(columns) - 1:
        # Two steps to a cell that shares a corner are straight ones, for none stays where it is.
        step = 1
        if i + 2 < len(columns):
            step += abs(columns[i + 2] - columns[i]) == 1 and abs(rows[i + 2] - rows[i]) == 1
        diagonal = columns[i + step] != columns[i] and rows[i + step] != rows[i]
        length += DIAGONAL if diagonal else STRAIGHT
        i += step
    return length


@allocation_free
def sum_of_steps(x: np.ndarray, y: np.ndarray, steps: np.ndarray) -> float:
    """Return the length of a polyline.

    steps: scratch, at least as many numbers as in a block or as steps.
    """
    # Square roots and their sum are computed in two loops, so that the first can use vector
    # instructions, and the order of the sum stays as written; by blocks, so that a processor takes
    # the roots of one block while it still adds those of the one before.
    length = 0.0
    for first in range(0, len(x) - 1, _BLOCK):
        size = min(_BLOCK, len(x) - 1 - first)
        for s in range(size):
            steps[s] = math.sqrt(
                (x[first + s + 1] - x[first + s]) ** 2 + (y[first + s + 1] - y[first + s]) ** 2
            )
        for s in range(size):
            length += steps[s]
    return length


def sample_in_cells(path: Path, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Return x and y of samples of a path, in cells, less than a cell apart."""
    return sample_curve(grid.in_cells(curves.bezier_pieces(path)))


def length_by_points(path: Path, grid: Grid) -> float:
    """Return the length of a path, in units, by counting points along it: a step from the cell of
    one to a neighbouring cell counts 1, a diagonal one 1.5.

    The points have equal distances, at most a cell.

    >>> from bezierplan.workspaces.grid import from_lines
    >>> field = from_lines(["....", "...."], cell=1.0, unit="m")
    >>> length_by_points(Path("polyline", np.array([[0.5, 0.5], [2.5, 0.5], [3.5, 1.5]])), field)
    3.5
    """
    walked = np.column_stack(sample_in_cells(path, grid))
    at = measure_lengths(walked)
    wanted = np.linspace(0.0, at[-1], math.ceil(at[-1]) + 1)
    steps = np.abs(np.diff(np.floor(find_places(walked, at, wanted)), axis=0))
    return (
        float((STRAIGHT * steps.max(axis=1) + (DIAGONAL - STRAIGHT) * steps.min(axis=1)).sum())
        * grid.cell
    )


def length4(path: Path, grid: Grid) -> float:
    """Return the length of a path, in units, by the cells that it touches (`measure_cells4`).

    >>> from bezierplan.workspaces.grid import from_lines
    >>> field = from_lines(["...", "..."], cell=1.0, unit="m")
    >>> length4(Path("polyline", np.array([[0.5, 0.5], [2.5, 1.5]])), field)
    3.0
    """
    return measure_cells4(*list_touched_cells(*sample_in_cells(path, grid))) * grid.cell


def length8(path: Path, grid: Grid) -> float:
    """Return the length of a path, in units, by the cells that it touches without corner cells
    (`measure_cells8`).

    A path that runs from centre to centre of neighbouring cells is measured on exactly these cells.

    >>> from bezierplan.workspaces.grid import from_lines
    >>> field = from_lines(["...", "..."], cell=1.0, unit="m")
    >>> length8(Path("polyline", np.array([[0.5, 0.5], [2.5, 1.5]])), field)
    2.5
    """
    own = _is_cell_path(path, grid)
    return (measure_cells4 if own else measure_cells8)(
        *list_touched_cells(*sample_in_cells(path, grid))
    ) * grid.cell


def _is_cell_path(path: Path, grid: Grid) -> bool:
    """Tell whether a path leads through centres of cells along rows, columns and diagonals."""
    if path.curve != "polyline":
        return False
    points = grid.in_cells(path.points) - 0.5
    legs = np.abs(np.diff(np.rint(points), axis=0))
    straight = (legs.min(axis=1) == 0) | (legs[:, 0] == legs[:, 1])
    return bool(np.all(np.abs(points - np.rint(points)) <= _CENTRE) and straight.all())
