"""The curve of a chromosome of control points: whether it is valid, and how long it is (elhoseny2017, equation 6 and Section 3.2.2)."""

import math
from typing import Literal, NamedTuple

import numpy as np
from numba import njit

from bezierplan.geometry.cell_length import cells4, cells8, occupied_cells, parts, polyline_length, sample, touched_cells
from bezierplan.planners.parts.gene_lattice import Field, polygon

# More control points make a chromosome invalid: the curve's degree is at most 60.
MOST_POINTS = 59

# Points of a curve that are examined first: most collisions show up there, which saves the walk over all cells.
_FIRST_SAMPLES = 30
_ON_LINE = 1e-9

FitnessLength = Literal["length", "cells4", "cells8"]
_LENGTH, _CELLS4, _CELLS8 = range(3)


@njit(cache=True)
def validate(ones: np.ndarray, field: Field, rules: NamedTuple) -> tuple[float, bool]:
    """Apply the constraints of equation 6 and Section 3.2.2: the cost (length) of a chromosome, infinite if it is to be deleted, and
    whether its curve is collision-free. `Obstacles` needs no test, as genes of occupied cells are never set. rules:
    `modified_genetic.Rules`.
    """
    if not 0 < len(ones) <= MOST_POINTS:
        return np.inf, False
    points = polygon(ones, field)
    for i in range(1, len(points) - 1):  # `Distance Threshold`
        for j in range(1, i):
            if math.hypot(points[i, 0] - points[j, 0], points[i, 1] - points[j, 1]) < rules.least_distance:
                return np.inf, False
    if not rules.composite and not rules.punished and _collides_at_first_sight(points, field.occupied):
        return np.inf, False
    x, y = _curve(points, rules.composite)
    if rules.fitness_length == _LENGTH and _is_free_at_first_sight(x, y, field.occupied):
        return polyline_length(x, y), True
    columns, rows = touched_cells(x, y)
    bad = occupied_cells(columns, rows, field.occupied)  # `Valid Path`
    if bad > 0 and not rules.punished:
        return np.inf, False
    if rules.fitness_length == _LENGTH:
        length = polyline_length(x, y)
    elif rules.fitness_length == _CELLS4:
        length = cells4(columns, rows)
    else:
        length = cells8(columns, rows)
    return length + rules.penalty * bad, bad == 0


@njit(cache=True)
def _collides_at_first_sight(points, occupied):
    """Whether any of some samples of a curve, all of which `_curve` also has, lie in occupied cells; those on grid lines are left to the
    walk.
    """
    last = parts(points)
    stride = max(1, last // _FIRST_SAMPLES)
    degree = len(points) - 1
    for s in range(last // stride + 1):
        # The terms of `sample` in the same order, one sample at a time: most curves collide at one of the first.
        t = s * stride / last
        x, y, power, binomial = points[0, 0], points[0, 1], 1.0, 1.0
        for i in range(1, degree + 1):
            binomial *= (degree - i + 1) / i
            power *= t
            x = x * (1.0 - t) + power * (binomial * points[i, 0])
            y = y * (1.0 - t) + power * (binomial * points[i, 1])
        if stride == 1 and s == last:
            x, y = points[degree, 0], points[degree, 1]
        column, row = math.floor(x), math.floor(y)
        inside = x - column > _ON_LINE and column + 1 - x > _ON_LINE and y - row > _ON_LINE and row + 1 - y > _ON_LINE
        if inside and occupied[row, column]:
            return True
    return False


@njit(cache=True)
def _is_free_at_first_sight(x, y, occupied):
    """Whether the cells of all samples are free, as well as those whose corner a step between two samples may cut: the walk over the cells
    can then only find the same. Never true for curves with a sample on a grid line.
    """
    rows, columns = occupied.shape
    touched = on_line = False
    # There is no cell beyond the upper and right borders, on which start and target may lie.
    column, row = min(int(x[0]), columns - 1), min(int(y[0]), rows - 1)
    for s in range(len(x)):
        before_column, before_row = column, row
        column, row = min(int(x[s]), columns - 1), min(int(y[s]), rows - 1)
        touched |= occupied[row, column] | occupied[before_row, column] | occupied[row, before_column]
        right, above = x[s] - column, y[s] - row
        on_line |= (right <= _ON_LINE) | (right >= 1.0 - _ON_LINE) | (above <= _ON_LINE) | (above >= 1.0 - _ON_LINE)
    return not (touched or on_line)


@njit(cache=True)
def _curve(points, composite):
    """x and y of samples of the curve less than a cell apart (equation 2)."""
    if not composite:
        return sample(points, parts(points), 1)
    pieces = len(points) - 2
    piece = np.empty((pieces, 3, 2))
    lasts = np.empty(pieces, dtype=np.int64)
    for k in range(pieces):
        for axis in range(2):
            piece[k, 0, axis] = 0.5 * (points[k, axis] + points[k + 1, axis]) if k > 0 else points[0, axis]
            piece[k, 1, axis] = points[k + 1, axis]
            piece[k, 2, axis] = 0.5 * (points[k + 1, axis] + points[k + 2, axis]) if k < pieces - 1 else points[-1, axis]
        lasts[k] = parts(piece[k])
    x, y = np.empty(lasts.sum() + pieces), np.empty(lasts.sum() + pieces)
    first = 0
    for k in range(pieces):
        piece_x, piece_y = sample(piece[k], lasts[k], 1)
        for s in range(len(piece_x)):
            x[first + s], y[first + s] = piece_x[s], piece_y[s]
        first += len(piece_x)
    return x, y
