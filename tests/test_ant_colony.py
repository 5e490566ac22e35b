"""Ant colony optimisation: an ant's choice against its formula, and what becomes of the trails."""

import itertools
import math

import numpy as np
import pytest
from scipy import stats
from test_lattice_planners import colony_rules

from bezierplan.planners import ant_colony
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.lattice import build_grid_lattice

GRID = Grid(np.zeros((6, 6), dtype=bool), 1.0, "unit")
PLACES = build_grid_lattice(GRID, (0.0, 0.0), (6.0, 6.0), "one")


FOUR_CELLS = build_grid_lattice(
    Grid(np.zeros((2, 2), dtype=bool), 1.0, "unit"), (0.0, 0.0), (2.0, 2.0), "one"
)


def search(seed=0, places=PLACES, **changes):
    return ant_colony.search(places, np.random.default_rng(seed), colony_rules(**changes))


def test_the_first_step_is_drawn_by_nearness_of_the_target():
    colony = search(ants=4000, iterations=1, heuristic_weight=3.0)
    cells, counts = np.unique(colony.paths[:, 1], return_counts=True)
    assert cells.tolist() == [1, 6, 7]
    nearness = np.array([1 / math.hypot(5, 4), 1 / math.hypot(5, 4), 1 / math.hypot(4, 4)]) ** 3
    assert stats.chisquare(counts, 4000 * nearness / nearness.sum()).pvalue > 1e-3


def test_the_target_has_a_nearness_of_its_own():
    colony = search(places=FOUR_CELLS, ants=4000, iterations=1, target_heuristic=2.0)
    assert stats.binomtest((colony.sizes == 2).sum(), 4000, 4 / 6).pvalue > 1e-3


@pytest.mark.parametrize(("weight", "direct"), [(0.0, 1 / 3), (1.0, 2 / 4), (2.0, 4 / 6)])
def test_a_trail_draws_by_its_power(weight, direct):
    """Second ants, after first ones that went straight to the target and doubled the trail of that
    step.
    """
    settings = {
        "places": FOUR_CELLS,
        "ants": 1,
        "target_heuristic": 1.0,
        "evaporation": 0.0,
        "deposit": 2 * math.sqrt(2),
        "trail_weight": weight,
    }
    seconds = [
        search(seed, iterations=2, **settings).sizes[0]
        for seed in range(3000)
        if search(seed, iterations=1, **settings).sizes[0] == 2
    ]
    assert len(seconds) > 800
    assert stats.binomtest(seconds.count(2), len(seconds), direct).pvalue > 1e-3


def test_no_ant_visits_a_cell_twice_and_some_die():
    occupied = np.zeros((6, 6), dtype=bool)
    occupied[2, 1:4] = True
    occupied[:2, 4] = True
    places = build_grid_lattice(Grid(occupied, 1.0, "unit"), (0.0, 0.0), (6.0, 6.0), "one")
    colony = search(places=places, ants=500, iterations=1)
    assert 0 < (colony.sizes == 0).sum() < 500
    for path, size in zip(colony.paths, colony.sizes, strict=True):
        assert len(set(path[:size].tolist())) == size
        assert size == 0 or path[size - 1] == places.target


def test_where_all_other_trails_are_gone_ants_follow_the_first_one():
    """One ant lays the only trail; so its path depends on its own deposit, and on nothing else's
    being left.
    """
    for seed in range(5):
        first, last = (
            search(seed, ants=1, iterations=iterations, evaporation=1.0) for iterations in (1, 30)
        )
        assert last.sizes[0] == first.sizes[0]
        assert last.paths[0, : last.sizes[0]].tolist() == first.paths[0, : first.sizes[0]].tolist()


def test_trails_lead_both_ways():
    trail = np.ones((36, 8))
    ant_colony._lay(PLACES, trail, 0, 7, 0.5, 0.2)
    expected = np.ones((36, 8))
    expected[0, 5 + 2] = expected[7, 4] = 0.7
    assert np.allclose(trail, expected)


def laid(monkeypatch, **changes):
    """Every change of a trail in a search: (cell, cell, kept share, what is added), in plain
    Python.
    """
    changed = []
    plain = ant_colony._lay.py_func

    def record(lattice, trail, one, other, kept, added):
        changed.append((int(one), int(other), kept, added))
        plain(lattice, trail, one, other, kept, added)

    with monkeypatch.context() as patched:
        patched.setattr(ant_colony, "_lay", record)
        for name in ("_run_colony", "_walk"):
            patched.setattr(ant_colony, name, getattr(ant_colony, name).py_func)
        search(**changes)
    return changed


def steps(path, size):
    return list(itertools.pairwise(path[:size].tolist()))


def length(path, size):
    return np.hypot(*np.diff(np.divmod(path[:size], 6), axis=1)).sum() + math.sqrt(2)


def test_an_ant_system_adds_one_over_the_length_to_the_steps_of_each_path(monkeypatch):
    first = search(ants=3, iterations=1)
    expected = [
        (*step, 1.0, pytest.approx(5.0 / length(path, size)))
        for path, size in zip(first.paths, first.sizes, strict=True)
        for step in steps(path, size)
    ]
    assert laid(monkeypatch, ants=3, iterations=2, deposit=5.0) == expected


def test_an_ant_colony_system_wears_off_each_step_and_adds_to_the_best_path_alone(monkeypatch):
    system = {
        "trail_update": "ant_colony_system",
        "local_evaporation": 0.2,
        "initial_trail": 0.5,
        "evaporation": 0.3,
        "deposit": 2.0,
    }
    first = search(ants=3, iterations=1, **system)
    worn = [
        step
        for path, size in zip(first.paths, first.sizes, strict=True)
        for step in steps(path, size)
    ]
    changed = laid(monkeypatch, ants=3, iterations=2, **system)
    best = steps(first.best, len(first.best))
    assert changed[: len(worn)] == [(*step, 0.8, 0.1) for step in worn]
    added = changed[len(worn) : len(worn) + len(best)]
    assert added == [
        (*step, 0.7, pytest.approx(0.3 * 2.0 / length(first.best, len(first.best))))
        for step in best
    ]
    assert {change[2:] for change in changed[len(worn) + len(best) :]} == {(0.8, 0.1)}


def test_exploitation_takes_the_most_attractive_step():
    colony = search(ants=10, iterations=3, exploitation=1.0)
    assert (colony.paths[:, :6] == [0, 7, 14, 21, 28, 35]).all()
    assert (colony.history == 6 * math.sqrt(2)).all()
