"""Cells that paths touch, and lengths that count them: values by hand, both directions, any
spacing, and the traps of grid lines.
"""

import numpy as np
import pytest
from scipy import interpolate

from bezierplan.geometry import cell_length
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Path


def field(side):
    return Grid(np.zeros((side + 1, side + 1), dtype=bool), 1.0, "cell", (-0.5, -0.5))


def polyline(*points):
    return Path("polyline", np.array(points, dtype=float))


STRAIGHT = [
    ((0, 0), (100, 50), 150.0, 125.0),
    ((3, 7), (60, 40), 88.5, 73.5),
]


@pytest.mark.parametrize(("start", "target", "four", "eight"), STRAIGHT)
def test_straight_paths(start, target, four, eight):
    for path in (polyline(start, target), polyline(target, start)):
        assert cell_length.length4(path, field(100)) == four
        assert cell_length.length8(path, field(100)) == eight


@pytest.mark.parametrize("side", [1, 2, 7, 100, 101, 200, 2000])
def test_both_diagonals_of_an_empty_field_measure_the_same(side):
    rising, falling = polyline((0, 0), (side, side)), polyline((side, 0), (0, side))
    for path in (rising, falling):
        assert cell_length.length4(path, field(side)) == 1.5 * side
        assert cell_length.length8(path, field(side)) == 1.5 * side
    # The same lines as curves with control points on them.
    for ends in (((0, 0), (side, side)), ((side, 0), (0, side))):
        curve = Path("bezier", np.linspace(*ends, 5))
        assert cell_length.length4(curve, field(side)) == 1.5 * side


def test_a_coordinate_that_leaves_a_grid_line_is_in_the_next_cell():
    # On the line at 1.5, and at the next sample on the line at 2.5: the cell between is entered.
    columns, _ = cell_length.list_touched_cells(
        np.array([1.0, 1.5, 2.2, 2.5, 3.0]) + 0.5, np.full(5, 0.5)
    )
    assert list(columns) == [1, 2, 3]
    columns, _ = cell_length.list_touched_cells(
        np.array([3.0, 2.5, 1.8, 1.5, 1.0]) + 0.5, np.full(5, 0.5)
    )
    assert list(columns) == [3, 2, 1]


def test_the_cell_entered_first_lies_between():
    steep = cell_length.list_touched_cells(np.array([0.6, 1.1]), np.array([0.8, 1.5]))
    assert list(zip(*steep)) == [(0, 0), (0, 1), (1, 1)]
    flat = cell_length.list_touched_cells(np.array([0.8, 1.5]), np.array([0.6, 1.1]))
    assert list(zip(*flat)) == [(0, 0), (1, 0), (1, 1)]
    corner = cell_length.list_touched_cells(np.array([0.75, 1.25]), np.array([0.75, 1.25]))
    assert list(zip(*corner)) == [(0, 0), (1, 1)]


def test_thinning_is_greedy_from_the_start():
    # A staircase of three straight steps: the first two become a diagonal one, the third stays.
    columns, rows = np.array([0, 1, 1, 2]), np.array([0, 0, 1, 1])
    assert cell_length.measure_cells4(columns, rows) == 3.0
    assert cell_length.measure_cells8(columns, rows) == 2.5
    # Two steps in one direction, and a step there and back, are no diagonal.
    assert cell_length.measure_cells8(np.array([0, 1, 2]), np.zeros(3, dtype=np.int64)) == 2.0
    assert cell_length.measure_cells8(np.array([0, 1, 0]), np.zeros(3, dtype=np.int64)) == 2.0


def test_a_path_of_cells_is_measured_on_its_own_cells():
    corner = polyline((0, 0), (3, 0), (3, 2), (5, 4))
    assert cell_length.length4(corner, field(10)) == cell_length.length8(corner, field(10)) == 8.0
    # Between centres, but not from neighbour to neighbour: thinned.
    assert cell_length.length8(polyline((0, 0), (2, 1), (4, 2)), field(10)) < cell_length.length4(
        polyline((0, 0), (2, 1), (4, 2)), field(10)
    )


@pytest.mark.parametrize("degree", [2, 3, 7, 20, 60])
def test_samples_of_curves_lie_on_them_and_less_than_a_cell_apart(degree):
    rng = np.random.default_rng(degree)
    for _ in range(20):
        path = Path("bezier", rng.uniform(0, 100, (degree + 1, 2)))
        x, y = cell_length.sample_in_cells(path, field(100))
        assert np.hypot(np.diff(x), np.diff(y)).max() < 1
        # Pieces of a high degree are cut, and then samples are uniform in each part alone.
        parts = np.repeat(path.points[None] + 0.5, 1 if degree < cell_length.HIGH else 8, axis=0)
        cell_length.cut(parts, degree + 1)
        t = np.concatenate(
            [
                (k + np.linspace(0, 1, cell_length.count_parts(part) + 1)) / len(parts)
                for k, part in enumerate(parts)
            ]
        )
        expected = interpolate.BPoly(path.points[:, None] + 0.5, [0, 1])(t)
        np.testing.assert_allclose(np.column_stack([x, y]), expected, rtol=0, atol=1e-10)


def test_monotone_curves_between_corners_measure_between_one_and_a_half_and_two_sides():
    rng = np.random.default_rng(1)
    for _ in range(50):
        x, y = (np.sort(rng.uniform(0, 100, 5)) for _ in range(2))
        path = Path("bezier", np.vstack([(0, 0), np.column_stack([x, y]), (100, 100)]))
        assert 150 <= cell_length.length4(path, field(100)) <= 200
        assert 150 <= cell_length.length8(path, field(100)) <= cell_length.length4(path, field(100))


def test_lengths_are_in_units():
    grid = Grid(np.zeros((11, 11), dtype=bool), 0.1, "m", (-0.05, -0.05))
    assert cell_length.length4(polyline((0, 0), (1, 1)), grid) == pytest.approx(1.5)
    assert cell_length.length8(polyline((0, 0), (1, 0.5)), grid) == pytest.approx(1.25)


def test_legs_from_grid_line_to_grid_line_touch_the_cells_of_their_samples():
    """Legs between quarters of cells, with many corners and grid lines, and between any points;
    each touched cell occupied in its turn.
    """
    rng = np.random.default_rng(0)
    for trial in range(400):
        ends = rng.integers(0, 40, 4) / 4 if trial % 2 else rng.uniform(0, 10, 4)
        leg = Path("polyline", ends.reshape(2, 2))
        grid = Grid(np.zeros((12, 12), dtype=bool), 1.0, "cell")
        columns, rows = cell_length.list_touched_cells(*cell_length.sample_in_cells(leg, grid))
        touched = set(zip(rows.tolist(), columns.tolist()))
        for row, column in np.ndindex(12, 12):
            occupied = grid.occupied.copy()
            occupied[row, column] = True
            free = cell_length.is_free_leg(occupied, *leg.points)
            assert free == ((row, column) not in touched), (
                ends,
                row,
                column,
            )
