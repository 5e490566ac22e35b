"""Operators on paths over a lattice: against plain lists and formulas, and what no operator may
do.
"""

import itertools
from functools import partial

import fields
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from bezierplan.geometry import curves
from bezierplan.planners.parts import cell_paths
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.lattice import STEPS, build_grid_lattice, list_points
from bezierplan.workspaces.problem import Path

ROWS, COLUMNS = 7, 9
random_grid = partial(fields.random_grid, shape=(ROWS, COLUMNS), share=0.25)
seeds = st.integers(0, 10_000)


def places_of(grid, corners="one"):
    rows, columns = grid.occupied.shape
    return build_grid_lattice(grid, grid.centre(0), grid.centre(rows * columns - 1), corners)


def marks_of(places):
    return np.zeros(len(places.row), dtype=np.int64)


OPEN = places_of(Grid(np.zeros((ROWS, COLUMNS), dtype=bool), 1.0, "unit"))


def is_path(path, places):
    return all(other in places.neighbours[one] for one, other in itertools.pairwise(path))


def random_walk(rng, places, steps):
    """A path from the start that may cross itself."""
    path = [places.start]
    for _ in range(steps):
        reached = places.neighbours[path[-1]]
        if (reached < 0).all():
            break
        path.append(int(rng.choice(reached[reached >= 0])))
    return np.array(path)


def joined_list(places, cells, longest):
    """What `join` should give, with a list that grows in its middle; None if the cells cannot be
    joined.
    """
    occupied = places.occupied.reshape(ROWS, COLUMNS)
    cells = list(cells)
    k = 0
    while k < len(cells) - 1:
        one, other = cells[k], cells[k + 1]
        if one == other:
            del cells[k + 1]
        elif other in places.neighbours[one]:
            k += 1
        else:
            (row, column), (other_row, other_column) = divmod(one, COLUMNS), divmod(other, COLUMNS)
            row, column = (row + other_row) // 2, (column + other_column) // 2
            middle = row * COLUMNS + column
            if occupied[row, column] or middle in (one, other):
                around = [(row + up, column + right) for up, right in STEPS]
                inside = [
                    r * COLUMNS + c
                    for r, c in around
                    if 0 <= r < ROWS and 0 <= c < COLUMNS and not occupied[r, c]
                ]
                middle = next((cell for cell in inside if cell not in cells), None)
            if middle is None or len(cells) == longest:
                return None
            cells.insert(k + 1, middle)
    return cells


@given(seeds, st.sampled_from(["one", "none"]), st.integers(10, 60))
def test_cells_are_joined_as_a_list_that_grows_in_its_middle(seed, corners, longest):
    grid, rng = random_grid(seed), np.random.default_rng(seed)
    places, marks = places_of(grid, corners), marks_of(places_of(grid))
    cells = np.array(
        [places.start, *rng.choice(np.flatnonzero(~places.occupied), size=4), places.target]
    )
    # Also where the path just fits.
    for most in {longest, len(joined_list(places, cells.tolist(), 1000) or cells)}:
        path = np.empty(most, dtype=np.int64)
        size = cell_paths.join(places, cells, path, marks)
        expected = joined_list(places, cells.tolist(), most)
        assert path[:size].tolist() == (expected or [])
        assert expected is None or is_path(expected, places)
        assert not marks.any()


@given(seeds)
def test_loops_are_cut_and_nothing_else(seed):
    places = places_of(random_grid(seed))
    path, marks = random_walk(np.random.default_rng(seed), places, 40), marks_of(places)
    expected = []
    for cell in path.tolist():
        expected = expected[: expected.index(cell)] if cell in expected else expected
        expected.append(cell)
    size = cell_paths.cut_loops(path, marks)
    assert path[:size].tolist() == expected
    assert is_path(expected, places)
    assert not marks.any()


@given(seeds)
def test_length_is_that_of_the_polyline_with_its_ends(seed):
    grid = random_grid(seed)
    start, target = (0.1, 0.2), (8.9, 6.3)
    places = build_grid_lattice(grid, start, target, "one")
    path = random_walk(np.random.default_rng(seed), places, 20)
    polyline = Path("polyline", list_points(grid, start, grid.centre(int(path[-1])), path))
    last_way = places.ends - np.hypot(0.4, 0.3)
    assert cell_paths.measure_length(path, places) == pytest.approx(
        curves.length(polyline) + last_way
    )


def test_a_common_cell_is_any_place_of_the_first_path_and_the_last_of_the_other():
    one, other, marks = (
        np.array([0, 1, 2, 3, 2, 4, 8]),
        np.array([0, 2, 5, 2, 3, 6, 8]),
        marks_of(OPEN),
    )
    found = [
        cell_paths.draw_common_cell(np.random.default_rng(i), one, other, marks) for i in range(900)
    ]
    places, counts = np.unique(found, axis=0, return_counts=True)
    assert places.tolist() == [[2, 3], [3, 4], [4, 3]]
    assert stats.chisquare(counts).pvalue > 1e-3
    assert not marks.any()


def test_the_ends_are_no_common_cells():
    apart = cell_paths.draw_common_cell(
        np.random.default_rng(0), np.array([0, 1, 2]), np.array([0, 9, 2]), marks_of(OPEN)
    )
    assert apart == (0, 0)


def test_a_changed_cell_stays_beside_the_same_two():
    path, child = np.array([0, 1, 2, 3]), np.empty(4, dtype=np.int64)
    found = set()
    for i in range(200):
        assert cell_paths.change_cell(np.random.default_rng(i), OPEN, path, child) == 4
        assert is_path(child, OPEN)
        found.add(tuple(child.tolist()))
    assert found == {(0, 10, 2, 3), (0, 1, 11, 3)}


def test_a_cell_that_nothing_can_replace_is_dropped_if_its_neighbours_meet():
    corridor = places_of(Grid(np.zeros((1, 6), dtype=bool), 1.0, "unit"))
    child = np.empty(9, dtype=np.int64)
    assert cell_paths.change_cell(np.random.default_rng(0), corridor, np.arange(6), child) == 0
    corner = places_of(Grid(np.array([[False, False], [True, False]]), 1.0, "unit"))
    found = set()
    for i in range(50):
        size = cell_paths.change_cell(
            np.random.default_rng(i), corner, np.array([0, 1, 3, 1]), child
        )
        found.add(tuple(child[:size].tolist()))
    assert found == {(0, 3, 1), (0, 1, 0, 1)}


def test_paths_of_three_cells_are_left_alone():
    assert (
        cell_paths.change_cell(
            np.random.default_rng(0), OPEN, np.array([0, 1, 2]), np.empty(3, dtype=np.int64)
        )
        == 0
    )


@given(seeds)
def test_a_reconnected_part_is_a_path_by_way_of_the_bounding_box(seed):
    places, rng = places_of(random_grid(seed)), np.random.default_rng(seed)
    first, last = rng.choice(np.flatnonzero(~places.occupied), size=2, replace=False)
    part = np.empty(60, dtype=np.int64)
    size = cell_paths.join_through_random_cell(rng, places, first, last, part, marks_of(places))
    if size:
        assert (part[0], part[size - 1]) == (first, last)
        assert is_path(part[:size], places)


@given(seeds, st.integers(0, 8))
def test_a_walk_meets_its_end_without_a_cell_twice(seed, tries):
    places, rng = places_of(random_grid(seed)), np.random.default_rng(seed)
    first, last = rng.choice(np.flatnonzero(~places.occupied), size=2, replace=False)
    part, marks = np.empty(30, dtype=np.int64), marks_of(places)
    size = cell_paths.forage(rng, places, first, last, tries, part, marks)
    assert not marks.any()
    if size:
        assert (part[0], part[size - 1]) == (first, last)
        assert is_path(part[:size], places)
        assert len(set(part[:size].tolist())) == size


def first_paths(places, seed, population=8, longest=60):
    """Paths from start to target through random cells."""
    rng, marks = np.random.default_rng(seed), marks_of(places)
    free = np.flatnonzero(~places.occupied)
    paths, sizes = (
        np.zeros((population, longest), dtype=np.int64),
        np.zeros(population, dtype=np.int64),
    )
    for i in range(population):
        while not sizes[i]:
            cells = np.array([places.start, *rng.choice(free, size=3), places.target])
            sizes[i] = cell_paths.join(places, cells, paths[i], marks)
    return paths, sizes


RULES = {
    "swapped tails, reconnected": cell_paths.Rules(
        0.9, 0.5, 1, cell_paths.RECONNECT, 60, shorter_parts=False
    ),
    "shorter parts, one cell": cell_paths.Rules(0.9, 0.5, 1, cell_paths.ONE_CELL, 60),
    "shorter parts, walks": cell_paths.Rules(0.9, 0.5, 1, cell_paths.WALK, 30, 8),
    "no elite": cell_paths.Rules(1.0, 1.0, 0, cell_paths.RECONNECT, 60),
}


@pytest.mark.parametrize("rules", RULES.values(), ids=RULES)
@pytest.mark.parametrize("seed", range(4))
def test_evolution_ends_with_a_path_of_the_length_that_it_says(rules, seed):
    places = places_of(
        Grid(
            np.random.default_rng(seed).random((ROWS, COLUMNS)) < [0, 0.05, 0.1, 0.0][seed],
            1.0,
            "unit",
        )
    )
    paths, sizes = first_paths(places, seed)
    shortest = min(
        cell_paths.measure_length(path[:size], places)
        for path, size in zip(paths, sizes, strict=True)
    )
    best, history = cell_paths.evolve(np.random.default_rng(seed), places, paths, sizes, 30, rules)
    assert (best[0], best[-1]) == (places.start, places.target)
    assert is_path(best, places)
    assert history[0] == shortest
    assert history[-1] == cell_paths.measure_length(best, places)
    assert (np.diff(history) <= 0).all()
    assert history[-1] < shortest
