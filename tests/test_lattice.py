"""The 8-connected lattice: its steps against the rule for corners, cell by cell, and its ends."""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.lattice import Corners, build_grid_lattice, list_neighbours, list_points

RULES = tuple(Corners.__members__)
OPEN = Grid(np.zeros((4, 5), dtype=bool), 2.0, "unit")


def random_cells(seed):
    rng = np.random.default_rng(seed)
    return rng.random(rng.integers(1, 7, size=2)) < 0.35


@given(st.integers(0, 10_000), st.sampled_from(RULES))
def test_a_step_leads_to_a_free_cell_beside_so_many_occupied_ones(seed, corners):
    occupied = random_cells(seed)
    rows, columns = occupied.shape
    reached = list_neighbours(occupied, corners).reshape(rows, columns, 8)
    for row, column in product(range(rows), range(columns)):
        allowed = set()
        for up, right in product((-1, 0, 1), (-1, 0, 1)):
            there = row + up, column + right
            if (up, right) == (0, 0) or not (0 <= there[0] < rows and 0 <= there[1] < columns):
                continue
            beside = (
                int(occupied[row + up, column]) + int(occupied[row, column + right])
                if up and right
                else 0
            )
            if (
                not occupied[row, column]
                and not occupied[there]
                and beside <= {"free": 2, "one": 1, "none": 0}[corners]
            ):
                allowed.add(there[0] * columns + there[1])
        found = [cell for cell in reached[row, column].tolist() if cell >= 0]
        assert set(found) == allowed
        assert len(found) == len(allowed)


def test_steps_come_in_the_order_west_east_north_south_and_the_diagonals():
    assert list_neighbours(OPEN.occupied, "none")[6].tolist() == [5, 7, 11, 1, 0, 10, 2, 12]


def test_around_an_occupied_cell_are_the_free_cells_whatever_lies_beside():
    places = build_grid_lattice(
        from_lines([".#.", "##.", "..."], 1.0, "unit"), (0.5, 0.5), (2.5, 2.5), "none"
    )
    assert places.neighbours[4].tolist() == [-1] * 8
    assert places.around[4].tolist() == [-1, 5, -1, 1, 0, 6, 2, 8]


def test_ends_are_the_ways_from_start_and_to_target_in_cells():
    places = build_grid_lattice(OPEN, (0.0, 0.0), (9.0, 8.0), "one")
    assert (places.start, places.target) == (0, 19)
    assert places.ends == pytest.approx(math.sqrt(0.5) + 0.5)


@pytest.mark.parametrize(
    ("start", "target", "named"),
    [((3.0, 1.0), (1.0, 1.0), "start"), ((1.0, 1.0), (3.0, 1.0), "target")],
)
def test_an_end_that_is_in_no_free_cell_is_named(start, target, named):
    grid = from_lines([".....", ".#..."], 2.0, "unit")
    with pytest.raises(ValueError, match=f"{named}: .*expected a point of a free cell"):
        build_grid_lattice(grid, start, target, "one")


def test_points_hold_the_centres_of_start_and_target_once():
    assert list_points(OPEN, (1.0, 1.0), (3.0, 1.0), np.array([0, 1])).tolist() == [[1, 1], [3, 1]]
    assert list_points(OPEN, (0.0, 0.0), (3.0, 1.0), np.array([0, 1])).tolist() == [
        [0, 0],
        [1, 1],
        [3, 1],
    ]
    assert list_points(OPEN, (0.5, 1.0), (0.5, 1.0), np.array([0])).tolist() == [[0.5, 1], [0.5, 1]]
    # A path that comes by its start again keeps that.
    assert list_points(OPEN, (1.0, 1.0), (3.0, 1.0), np.array([0, 5, 0, 1])).tolist() == [
        [1, 1],
        [1, 3],
        [1, 1],
        [3, 1],
    ]
