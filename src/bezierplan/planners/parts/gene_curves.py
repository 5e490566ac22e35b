"""The curve of a chromosome of control points: whether it is valid, and how long it is
(elhoseny2017, equation 6 and Section 3.2.2).
"""

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from bezierplan.geometry.cell_length import (
    CUT,
    HIGH,
    QUARTERS,
    count_occupied_cells,
    count_parts,
    cut,
    find_cell_at,
    sum_of_steps,
    write_samples,
    write_touched_cells,
)
from bezierplan.kernels import allocation_free, compile_inline
from bezierplan.planners.parts.gene_lattice import Field, write_polygon

# More control points make a chromosome invalid: the curve's degree is at most 60.
MOST_POINTS = 59

# Equal parts of a curve, and fewest of a piece of it, whose ends are examined first: most
# collisions show up there.
_FIRST_PARTS = 30
_FEWEST_PARTS = 4
_ON_LINE = 1e-9

# A sum of lengths is exact to this share.
_ROUNDING = 1e-9

CurveKind = IntEnum("CurveKind", "single chain")
_FREE, _OCCUPIED, _UNKNOWN = range(3)


class Scratch(NamedTuple):
    """Room for a chromosome's curve, overwritten by each `validate`.

    points: (points, 2) its polygon.
    pieces: (points, points, 2) those of its pieces.
    x, y: (samples,).
    t, power: (samples,) of `write_samples`.
    columns, rows: (2 samples,) the cells that it touches; before that, columns: the reach of some
        samples.
    """

    points: np.ndarray
    pieces: np.ndarray
    x: np.ndarray
    y: np.ndarray
    t: np.ndarray
    power: np.ndarray
    columns: np.ndarray
    rows: np.ndarray


def prepare_scratch(field: Field) -> Scratch:
    """Return room for any curve on a field."""
    # `count_parts` of a curve: at most 2.04 for each cell of its polygon, whose legs are no longer
    # than the diagonal, and 3 more for each piece; before them the samples of the first look.
    samples = (
        math.ceil(2.04 * (MOST_POINTS + 1) * math.hypot(*field.occupied.shape))
        + 4 * (MOST_POINTS + 1)
        + 2 * (_FIRST_PARTS + 1)
    )
    numbers, cells = np.empty((4, samples)), np.empty((2, 2 * samples), np.int64)
    return Scratch(
        np.empty((MOST_POINTS + 2, 2)),
        np.empty((MOST_POINTS, MOST_POINTS + 2, 2)),
        *numbers,
        *cells,
    )


@allocation_free
def validate(
    ones: np.ndarray, field: Field, rules: NamedTuple, limit: float, scratch: Scratch
) -> float:
    """Return the cost (length) of a chromosome, infinite if it is to be deleted (equation 6 and
    Section 3.2.2).

    `Obstacles` needs no test, as genes of occupied cells are never set.

    rules: `modified_genetic.Settings`.
    limit: nobody needs to know by how much a length exceeds it, so a cost above it may be less than
        the length.
    scratch: `prepare_scratch` of the field.
    """
    if not 0 < len(ones) <= MOST_POINTS:
        return np.inf
    points = scratch.points[: write_polygon(ones, field, scratch.points)]
    pieces = _write_pieces(points, rules.curve, field.room, scratch)
    if pieces == 0:
        return np.inf
    # Pieces of a chain are cubic, a single curve has all its points in each piece.
    size = 4 if pieces == len(points) - 3 else len(points)
    # Most collisions show up in this look at some samples; the walk over all cells comes last.
    sight, least = _look_at_curve(pieces, size, field.room, scratch)
    if sight == _OCCUPIED or _is_near(points, rules.least_distance):
        return np.inf
    if sight == _FREE and least > limit:
        return least
    count = 0
    for k in range(pieces):
        piece, x, y = scratch.pieces[k, :size], scratch.x[count:], scratch.y[count:]
        last = count_parts(piece)
        write_samples(piece, last, 0, 1, last + 1, x, y, scratch.t, scratch.power)
        count += last + 1
    x, y = scratch.x[:count], scratch.y[:count]
    if sight == _UNKNOWN:
        count = write_touched_cells(x, y, scratch.columns, scratch.rows)
        if count_occupied_cells(scratch.columns[:count], scratch.rows[:count], field.occupied) > 0:
            return np.inf  # `Valid Path`
    return sum_of_steps(x, y, scratch.t)


@compile_inline
def _write_pieces(points, curve, room, scratch):
    """Write the pieces of a curve that are walked one after another, and return their number.

    It is 0 if an end of one is in an occupied cell.
    """
    if curve == CurveKind.chain and len(points) > 3:
        for k in range(len(points) - 3):
            _write_piece(points, k, scratch.pieces[k])
        return len(points) - 3
    pieces = CUT if len(points) > HIGH else 1
    if pieces > 1:
        # A look at a few points comes before the cut, which takes longer.
        x, y, ends = scratch.x, scratch.y, QUARTERS * pieces - 1
        write_samples(points, ends + 1, 1, 1, ends, x, y, scratch.t, scratch.power)
        for i in range(ends):
            if _count_free_samples(x[i], y[i], room) == 0:
                return 0
    for i in range(len(points)):
        for axis in range(2):
            scratch.pieces[0, i, axis] = points[i, axis]
    cut(scratch.pieces[:pieces], len(points))
    return pieces


@compile_inline
def _is_near(points, least_distance):
    """Tell whether two control points are closer than a distance (`Distance Threshold`)."""
    for i in range(1, len(points) - 1):
        for j in range(1, i):
            width, height = abs(points[i, 0] - points[j, 0]), abs(points[i, 1] - points[j, 1])
            # The larger side alone rules out most pairs, without a root.
            if max(width, height) < least_distance and math.hypot(width, height) < least_distance:
                return True
    return False


@compile_inline
def _look_at_curve(pieces, size, room, scratch):
    """Return what a walk over the cells of a curve would find, if a look at some of its samples
    tells.

    This is `_OCCUPIED` or `_FREE`, otherwise `_UNKNOWN`; beside it comes a length that the polyline
    through its samples has at least.
    """
    sight, least = _FREE, 0.0
    for k in range(pieces):
        seen, chords = _look_at_piece(
            scratch.pieces[k, :size], max(_FEWEST_PARTS, _FIRST_PARTS // pieces), room, scratch
        )
        if seen == _OCCUPIED:
            return _OCCUPIED, 0.0
        if seen == _UNKNOWN:
            sight = _UNKNOWN
        least += chords
    return sight, least


@compile_inline
def _look_at_piece(piece, least_parts, room, scratch):
    """Tell from some samples of a piece whether its cells are free, as `_look_at_curve` does for a
    curve.

    First come the ends of at least so many equal parts (fewer only if there are fewer samples),
    then all samples of those parts that come too close to obstacles to tell.
    """
    last = count_parts(piece)
    stride = max(1, last // least_parts)
    ends = -(-last // stride) + 1
    x, y, reach = scratch.x, scratch.y, scratch.columns
    write_samples(piece, last, 0, stride, last // stride + 1, x, y, scratch.t, scratch.power)
    x[ends - 1], y[ends - 1] = piece[-1, 0], piece[-1, 1]
    for i in range(ends):
        reach[i] = _count_free_samples(x[i], y[i], room)
        if reach[i] == 0:
            return _OCCUPIED, 0.0
    sight = _FREE
    away = _bound_distance_from_chords(piece, last / stride)
    first = 0
    while first < ends - 1:
        after = first
        while after < ends - 1 and not _is_free_part(x, y, reach, after, away):
            after += 1
        if after > first:
            begin, count = first * stride, min(after * stride, last) - first * stride + 1
            write_samples(
                piece, last, begin, 1, count, x[ends:], y[ends:], scratch.t, scratch.power
            )
            seen = _look_at_samples(x[ends : ends + count], y[ends : ends + count], room)
            if seen == _OCCUPIED:
                return _OCCUPIED, 0.0
            if seen == _UNKNOWN:
                sight = _UNKNOWN
        first = after + 1
    return sight, (1.0 - _ROUNDING) * sum_of_steps(x[:ends], y[:ends], scratch.t)


@allocation_free
def _bound_distance_from_chords(piece, count):
    """Return how far a piece gets at most from its chords, along x or y.

    The piece is cut into `count` parts of equal length in the parameter, and compared with points
    at the same parameters on their chords: an eighth of the second derivative at most, times the
    square of a part's length.
    """
    degree = len(piece) - 1
    most = 0.0
    for i in range(1, degree):
        for axis in range(2):
            most = max(most, abs(piece[i - 1, axis] - 2.0 * piece[i, axis] + piece[i + 1, axis]))
    return degree * (degree - 1) * most / (8.0 * count * count)


@allocation_free
def _is_free_part(x, y, reach, i, away):
    """Tell whether the free cells around both ends of a part hold all its samples.

    A step, which is less than a cell, lies in both.
    """
    # Around an end of room r, r - 1 cells are free in each direction. A sample is at most
    # `between` from one end and the other together, and `away` from the chord; the cell that its
    # step leads to is one further.
    between = max(abs(x[i + 1] - x[i]), abs(y[i + 1] - y[i]))
    return between + 2.0 * away + 1.0 <= reach[i] - 1 + reach[i + 1] - 1


@allocation_free
def _look_at_samples(x, y, room):
    """Tell from samples (n,) in a row whether their cells are free: `_OCCUPIED`, `_FREE` or
    `_UNKNOWN`.

    `_OCCUPIED` means that one is in an occupied cell; `_FREE` that the cells of all are free, and
    also those whose corner a step between two samples may cut.
    """
    sight = _FREE
    s = 0
    while s < len(x):
        reach = _count_free_samples(x[s], y[s], room)
        if reach == 0:
            return _OCCUPIED
        if reach < 0 or (
            reach == 1 and s > 0 and _can_cut_corner(x[s - 1], y[s - 1], x[s], y[s], room)
        ):
            sight = _UNKNOWN
        # With free cells all around a sample, the next ones need no look.
        s += max(reach, 1)
    return sight


@allocation_free
def _count_free_samples(x, y, room):
    """Return how many samples from one on, itself included, touch free cells only, whichever way
    they lead.

    It is 0 if the sample's cell is occupied, -1 if that cannot be told: a sample on a grid line may
    count to the cell on either side.
    """
    # There is no cell beyond the upper and right borders, on which start and target may lie.
    column, row = find_cell_at(x, y, room)
    right, above = x - column, y - row
    if _ON_LINE < right < 1.0 - _ON_LINE and _ON_LINE < above < 1.0 - _ON_LINE:
        return room[row, column]
    return room[row, column] - 1 if room[row, column] > 2 and right < 1.0 and above < 1.0 else -1


@allocation_free
def _can_cut_corner(x0, y0, x, y, room):
    """Tell whether the step between two samples may cut the corner of an occupied cell.

    The second sample is within a free cell.
    """
    before_column, before_row = find_cell_at(x0, y0, room)
    if room[before_row, before_column] > 1:
        return False
    return (
        _count_free_samples(x0, y0, room) < 0
        or room[before_row, int(x)] == 0
        or room[int(y), before_column] == 0
    )


@allocation_free
def _write_piece(points, k, piece):
    """Write the control points (4, 2) of piece k of a chain of cubic pieces with the same tangent
    and curvature where they meet (Section 2.1).

    The chain is a clamped uniform B-spline of four or more points.
    """
    pieces = len(points) - 3
    before, after = min(k, 1), min(pieces - k - 1, 1)  # steps to the next knot on either side
    further_before, further_after = min(k, 2), min(pieces - k - 1, 2)
    for axis in range(2):
        a, b, c, d = points[k, axis], points[k + 1, axis], points[k + 2, axis], points[k + 3, axis]
        step = (c - b) / (before + 1 + after)
        inner, outer = b + before * step, c - after * step
        came = a + (b - a) * further_before / (further_before + 1)
        goes = d + (c - d) * further_after / (further_after + 1)
        piece[0, axis] = came + (inner - came) * before / (before + 1)
        piece[1, axis], piece[2, axis] = inner, outer
        piece[3, axis] = goes + (outer - goes) * after / (after + 1)
