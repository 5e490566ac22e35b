"""The curve of a chromosome of control points: whether it is valid, and how long it is (elhoseny2017, equation 6 and Section 3.2.2)."""

import math
from typing import Literal, NamedTuple

import numpy as np

from bezierplan.geometry.cell_length import cells4, cells8, occupied_cells, parts, sum_of_steps, write_samples, write_touched_cells
from bezierplan.kernels import allocation_free
from bezierplan.planners.parts.gene_lattice import Field, write_polygon

# More control points make a chromosome invalid: the curve's degree is at most 60.
MOST_POINTS = 59

# Points of a curve that are examined first: most collisions show up there, which saves the walk over all cells.
_FIRST_SAMPLES = 30
_ON_LINE = 1e-9

FitnessLength = Literal["length", "cells4", "cells8"]
_LENGTH, _CELLS4, _CELLS8 = range(3)
_FREE, _OCCUPIED, _UNKNOWN = range(3)


class Scratch(NamedTuple):
    """Room for a chromosome's curve, overwritten by each `validate`.

    order: (points,) its genes. points: (points, 2) its polygon. piece: (3, 2) one of its quadratic pieces. x, y: (samples,). t, power:
    (samples,) of `write_samples`. columns, rows: (2 samples,) the cells that it touches.
    """

    order: np.ndarray
    points: np.ndarray
    piece: np.ndarray
    x: np.ndarray
    y: np.ndarray
    t: np.ndarray
    power: np.ndarray
    columns: np.ndarray
    rows: np.ndarray


def scratch_for(field: Field) -> Scratch:
    """Room for any curve on a field."""
    # `parts` of a curve: at most 2.04 for each cell of its polygon, whose legs are no longer than the diagonal, and 3 more for each piece.
    samples = math.ceil(2.04 * (MOST_POINTS + 1) * math.hypot(*field.occupied.shape)) + 4 * (MOST_POINTS + 1)
    numbers, cells = np.empty((4, samples)), np.empty((2, 2 * samples), dtype=np.int64)
    return Scratch(np.empty(MOST_POINTS, dtype=np.int64), np.empty((MOST_POINTS + 2, 2)), np.empty((3, 2)), *numbers, *cells)


@allocation_free
def validate(ones: np.ndarray, field: Field, rules: NamedTuple, scratch: Scratch) -> tuple[float, bool]:
    """Apply the constraints of equation 6 and Section 3.2.2: the cost (length) of a chromosome, infinite if it is to be deleted, and
    whether its curve is collision-free. `Obstacles` needs no test, as genes of occupied cells are never set. rules:
    `modified_genetic.Rules`. scratch: `scratch_for` the field.
    """
    if not 0 < len(ones) <= MOST_POINTS:
        return np.inf, False
    points = scratch.points[: write_polygon(ones, field, scratch.points, scratch.order)]
    for i in range(1, len(points) - 1):  # `Distance Threshold`
        for j in range(1, i):
            width, height = abs(points[i, 0] - points[j, 0]), abs(points[i, 1] - points[j, 1])
            if max(width, height) < rules.least_distance and math.hypot(width, height) < rules.least_distance:
                return np.inf, False
    if not rules.composite and not rules.punished:
        last = parts(points)
        count = write_samples(points, last, max(1, last // _FIRST_SAMPLES), scratch.x, scratch.y, scratch.t, scratch.power)
        if _collides(scratch.x[:count], scratch.y[:count], field.room):
            return np.inf, False
    count = _write_curve(points, rules.composite, scratch)
    x, y = scratch.x[:count], scratch.y[:count]
    sight = _at_first_sight(x, y, field.room)
    if sight == _OCCUPIED and not rules.punished:
        return np.inf, False
    if sight == _FREE and rules.fitness_length == _LENGTH:
        return sum_of_steps(x, y, scratch.t), True
    count = write_touched_cells(x, y, scratch.columns, scratch.rows)
    columns, rows = scratch.columns[:count], scratch.rows[:count]
    bad = occupied_cells(columns, rows, field.occupied)  # `Valid Path`
    if bad > 0 and not rules.punished:
        return np.inf, False
    if rules.fitness_length == _LENGTH:
        length = sum_of_steps(x, y, scratch.t)
    elif rules.fitness_length == _CELLS4:
        length = cells4(columns, rows)
    else:
        length = cells8(columns, rows)
    return length + rules.penalty * bad, bad == 0


@allocation_free
def _collides(x, y, room):
    """Whether any of some samples of a curve lie in occupied cells; those on grid lines are left to the walk over the cells."""
    rows, columns = room.shape
    for s in range(len(x)):
        column, row = min(int(x[s]), columns - 1), min(int(y[s]), rows - 1)
        if room[row, column] == 0 and _is_within(x[s] - column, y[s] - row):
            return True
    return False


@allocation_free
def _is_within(right, above):
    """Whether a sample is not on a grid line, by its distances from those to the left and below."""
    return _ON_LINE < right < 1.0 - _ON_LINE and _ON_LINE < above < 1.0 - _ON_LINE


@allocation_free
def _at_first_sight(x, y, room):
    """What a walk over the cells of a curve would find, if a look at its samples tells: `_OCCUPIED` if a sample is in an occupied cell;
    `_FREE` if the cells of all samples are free, as well as those whose corner a step between two samples may cut. `_UNKNOWN` where neither
    holds, and for free curves with a sample on a grid line.

    Samples are less than a cell apart, so after one with free cells all around it the next ones need no look.
    """
    rows, columns = room.shape
    cut = False
    s = 0
    while s < len(x):
        # There is no cell beyond the upper and right borders, on which start and target may lie.
        before = max(s - 1, 0)
        before_column, before_row = min(int(x[before]), columns - 1), min(int(y[before]), rows - 1)
        column, row = min(int(x[s]), columns - 1), min(int(y[s]), rows - 1)
        if room[row, column] == 0 and _is_within(x[s] - column, y[s] - row):
            return _OCCUPIED
        cut |= room[row, column] == 0 or room[before_row, column] == 0 or room[row, before_column] == 0
        s += max(room[row, column], 1)
    if cut:
        return _UNKNOWN
    on_line = False
    for s in range(len(x)):
        # `np.floor` returns a float, unlike `math.floor`, whose integer would keep this loop from being vectorised.
        right, above = x[s] - np.floor(x[s]), y[s] - np.floor(y[s])
        on_line |= (right <= _ON_LINE) | (right >= 1.0 - _ON_LINE) | (above <= _ON_LINE) | (above >= 1.0 - _ON_LINE)
    return _UNKNOWN if on_line else _FREE


@allocation_free
def _write_curve(points, composite, scratch):
    """Write x and y of samples of the curve less than a cell apart (equation 2); returns their number."""
    x, y, t, power, piece = scratch.x, scratch.y, scratch.t, scratch.power, scratch.piece
    if not composite:
        return write_samples(points, parts(points), 1, x, y, t, power)
    pieces = len(points) - 2
    count = 0
    for k in range(pieces):
        for axis in range(2):
            piece[0, axis] = 0.5 * (points[k, axis] + points[k + 1, axis]) if k > 0 else points[0, axis]
            piece[1, axis] = points[k + 1, axis]
            piece[2, axis] = 0.5 * (points[k + 1, axis] + points[k + 2, axis]) if k < pieces - 1 else points[-1, axis]
        count += write_samples(piece, parts(piece), 1, x[count:], y[count:], t, power)
    return count
