"""The genetic algorithm over paths of cells: its paths, its operators against plain references,
degenerate cases, settings.
"""

from functools import partial

import numpy as np
import pytest
from fields import assert_path_fits, drawn, on_map
from studies import planned

from bezierplan.geometry import cell_length, shortest_paths
from bezierplan.planners import grid_genetic

plan = partial(planned, "elhoseny2017", "ga")


def least(problem):
    grid = problem.workspace
    return (
        shortest_paths.lattice_path(
            grid.occupied, grid.cell_of(*problem.start), grid.cell_of(*problem.target), 1.5, "free"
        ).length
        * grid.cell
    )


@pytest.mark.parametrize("number", range(12))
def test_paths_are_free_and_cost_what_is_said(number):
    problem = drawn(number)
    found = plan(problem, seed=number)
    grid = problem.workspace
    assert_path_fits(problem, found)
    assert (
        found.objective
        == cell_length.length4(found.path, grid)
        == cell_length.length8(found.path, grid)
    )
    assert least(problem) <= found.objective <= 1.01 * least(problem)
    assert found.evaluations == 60 * 81


def test_a_diagonal_step_may_pass_between_two_occupied_cells():
    found = plan(on_map("#.", ".#"))
    assert found.objective == 1.5
    assert found.path.points.tolist() == [[0.5, 0.5], [1.5, 1.5]]


def test_start_and_target_need_not_be_centres_of_cells():
    found = plan(on_map("....", "....", start=(0.2, 0.9), target=(3.6, 1.1)))
    assert found.path.points.tolist() == [
        [0.2, 0.9],
        [0.5, 0.5],
        [1.5, 1.5],
        [3.5, 1.5],
        [3.6, 1.1],
    ] or (
        found.path.points[[0, 1, -2, -1]].tolist()
        == [[0.2, 0.9], [0.5, 0.5], [3.5, 1.5], [3.6, 1.1]]
    )
    assert found.objective == 3.5


def walker(grid):
    walls = np.pad(grid, 1, constant_values=True)
    visits = np.zeros((2, walls.size), dtype=np.int64)
    return grid_genetic._Walker(walls.ravel(), walls.shape[1], 0.0, *visits)


def test_a_walk_steps_back_out_of_a_dead_end():
    """The nearest cells to the target are those of a pocket, three cells deep."""
    pocket = ("........", ".#####..", "......#.", ".#####..", "........")
    problem = on_map(*pocket, start=(0.5, 2.5), target=(7.5, 2.5))
    found = plan(problem)
    assert_path_fits(problem, found)
    assert found.objective == least(problem)


def is_path(cells, walls, columns):
    row, column = np.divmod(cells, columns)
    steps = np.maximum(abs(np.diff(row)), abs(np.diff(column)))
    return bool((steps == 1).all() and not walls[cells].any())


@pytest.mark.filterwarnings("ignore::numba.NumbaPendingDeprecationWarning")
def test_parents_are_drawn_in_proportion_to_the_inverse_of_their_cost(monkeypatch):
    """The search in plain Python: what the wheel is given, beside the costs of the paths that it
    draws from.
    """
    given, costs = [], []
    best, wheel = grid_genetic._select_best, grid_genetic.draw_parents

    def sorted_paths(*arguments):
        found = best(*arguments)
        costs.append(found[1][:6].copy())
        return found

    def drawn_parents(rng, weights, count):
        given.append(weights.copy())
        return wheel(rng, weights, count)

    for name, changed in (
        ("_select_best", sorted_paths),
        ("draw_parents", drawn_parents),
        ("_search", grid_genetic._search.py_func),
    ):
        monkeypatch.setattr(grid_genetic, name, changed)
    plan(drawn(3), population=6, generations=4)
    assert len(given) == 4
    for weights, own in zip(given, costs):
        assert weights * own == pytest.approx(weights[0] * own[0])
    assert np.ptp(costs[0]) > 0


def test_mutation_replaces_what_lies_between_two_cells():
    rng = np.random.default_rng(0)
    grid = np.zeros((20, 20), dtype=bool)
    given = walker(grid)
    columns = given.columns
    # Along the left border and then along the upper one.
    path = np.array(
        [row * columns + 1 for row in range(1, 21)]
        + [20 * columns + column for column in range(2, 21)]
    )
    walk = np.empty(3000, dtype=np.int64)
    shorter = 0
    for _ in range(200):
        walk[: len(path)] = path
        count = grid_genetic._walk_anew(rng, given, walk, len(path))
        assert (walk[0], walk[count - 1]) == (path[0], path[-1])
        assert is_path(walk[:count], given.walls, columns)
        # Head and tail are the path's own, in their places from its two ends; a free field is
        # crossed straight between them.
        after, both = walk[:count], min(count, len(path))
        head = int((after[:both] == path[:both]).cumprod().sum())
        tail = int((after[-both:] == path[-both:])[::-1].cumprod().sum())
        row, column = np.divmod(after[max(head, 1) - 1 : count - max(tail, 1) + 1], columns)
        assert head + tail >= 2
        assert len(row) <= 2 or len(row) - 1 == max(abs(np.ptp(row)), abs(np.ptp(column)))
        shorter += count < len(path)
        assert grid_genetic._measure_path(walk, count, columns, 1.5) <= 38
    assert 60 < shorter < 140
