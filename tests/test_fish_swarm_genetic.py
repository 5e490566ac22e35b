"""The fish swarm: whom a fish follows, and what its releases give."""

import itertools

import numpy as np
from studies import study
from test_lattice_planners import environment

from bezierplan.planners.fish_swarm_genetic import (
    _ARRIVED,
    _DEAD,
    _SWIMMING,
    Settings,
    _collect_first_paths,
    _follow,
)
from bezierplan.planners.parts import cell_paths
from bezierplan.planners.parts.settings import fill_settings
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.lattice import build_grid_lattice

COLUMNS = 12
GRID = Grid(np.zeros((COLUMNS, COLUMNS), dtype=bool), 1.0, "unit")
PLACES = build_grid_lattice(GRID, (0.0, 0.0), (12.0, 12.0), "one")
SWARM = fill_settings(Settings, study("ma2020").resolve_settings("asfa_ga") | {"fish": 5})


def cell(row, column):
    return row * COLUMNS + column


def follow(cells, states=None, visited=()):
    """The cell that the first of five fish goes to."""
    marks = np.zeros(COLUMNS**2, dtype=np.int64)
    marks[list(visited)] = 1
    states = np.array(states or [_SWIMMING] * 5)
    return _follow(PLACES, 0, np.array(cells), states, marks, SWARM)


FAR = cell(0, 11)


def test_a_fish_goes_next_to_the_one_in_sight_that_is_nearest_to_the_target():
    assert follow([cell(2, 2), cell(2, 6), cell(8, 2), FAR, FAR]) == cell(3, 2)
    # The other one is out of sight.
    assert follow([cell(2, 2), cell(2, 6), cell(9, 2), FAR, FAR]) == cell(2, 3)


def test_a_fish_that_is_nearest_itself_follows_nobody():
    assert follow([cell(6, 6), cell(2, 6), cell(6, 2), FAR, FAR]) == -1


def test_a_crowd_is_not_followed():
    near = [cell(2, 2), cell(3, 3), cell(3, 4), cell(4, 3), cell(4, 4)]
    assert follow(near) == -1
    # Dead ones do not count, those that have arrived do.
    assert follow(near, [_SWIMMING, _DEAD, _SWIMMING, _SWIMMING, _SWIMMING]) == cell(3, 3)
    assert follow(near, [_SWIMMING, _ARRIVED, _SWIMMING, _SWIMMING, _SWIMMING]) == -1


def test_a_dead_fish_is_not_followed():
    assert (
        follow(
            [cell(2, 2), cell(2, 6), FAR, FAR, FAR],
            [_SWIMMING, _DEAD, _SWIMMING, _SWIMMING, _SWIMMING],
        )
        == -1
    )


def test_a_fish_does_not_follow_into_a_cell_that_it_has_visited():
    beside = {cell(2, 3), cell(1, 3), cell(3, 3)}
    assert follow([cell(2, 2), cell(2, 6), FAR, FAR, FAR], visited=[cell(2, 3)]) in beside - {
        cell(2, 3)
    }
    around = {cell(2 + up, 2 + right) for up in (-1, 0, 1) for right in (-1, 0, 1)}
    assert follow([cell(2, 2), cell(2, 6), FAR, FAR, FAR], visited=around) == -1


def released(wanted=100, seed=0, **changes):
    problem = environment(1)
    places = build_grid_lattice(problem.workspace, problem.start, problem.target, "one")
    swarm = SWARM._replace(fish=20, population=wanted, **changes)
    return places, *_collect_first_paths(np.random.default_rng(seed), places, swarm)


def test_fish_that_arrive_give_as_many_paths_as_wanted():
    places, paths, sizes, _ = released()
    assert len(paths) == len(sizes) == 100
    for path, size in zip(paths, sizes, strict=True):
        assert (path[0], path[size - 1]) == (places.start, places.target)
        assert len(set(path[:size].tolist())) == size
        assert all(
            cell_paths.step_between(places, *pair) >= 0 for pair in itertools.pairwise(path[:size])
        )


def test_releases_end_when_there_are_enough_paths():
    *_, sizes, count = released(wanted=10)
    assert (len(sizes), count) == (10, 1)


def test_tries_make_first_paths_shorter():
    without, with_tries = (released(tries=tries)[2].mean() for tries in (0, 8))
    assert with_tries < 0.6 * without
