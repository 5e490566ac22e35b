"""The bee colony with evolutionary programming: its paths, its parts against plain references,
degenerate cases, settings.
"""

import math
from functools import partial

import numpy as np
import pytest
from fields import assert_path_fits, drawn, field_of
from studies import planned, study

from bezierplan.geometry import curves, shortest_paths
from bezierplan.planners import abc_ep
from bezierplan.planners.parts.settings import fill_settings
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Problem

SETTINGS = study("elhoseny2017").resolve_settings("abc_ep")
plan = partial(planned, "elhoseny2017", "abc_ep")


def field(*circles, side=100):
    """A field from corner to corner with circles (x, y, radius)."""
    return Problem("test", field_of(side, *circles), (0.0, 0.0), (float(side), float(side)))


def settings(**changes):
    """As kernels read them; changes are in cells."""
    return fill_settings(abc_ep.Settings, SETTINGS | changes)


@pytest.mark.parametrize("number", range(12))
def test_paths_touch_no_occupied_cell_and_are_as_long_as_said(number):
    problem = drawn(number, obstacles=15)
    found = plan(problem, seed=number)
    assert_path_fits(problem, found)
    assert found.objective == pytest.approx(curves.length(found.path), rel=1e-12)
    assert found.history[0] == found.extra["first_length"]
    assert found.evaluations == 1 + 20 * 150
    assert found.extra["turns"] == len(found.path.points) - 2


def test_evolution_comes_near_the_shortest_path():
    problem = field((50, 50, 20))
    shortest = shortest_paths.shortest_path(problem).length
    found = [plan(problem, seed) for seed in range(10)]
    first = np.array([each.extra["first_length"] for each in found]) / shortest - 1
    final = np.array([each.objective for each in found]) / shortest - 1
    assert np.median(first) > 0.005
    assert np.median(final) < 0.3 * np.median(first)
    assert final.min() > -1e-9


def test_points_visited_before_repel_out_of_a_dead_end():
    # A cup that is open towards the start.
    cup = [(x, 70, 3) for x in range(40, 72, 3)] + [(70, y, 3) for y in range(40, 72, 3)]
    problem = field(*cup)
    found = [plan(problem, seed).claimed_feasible for seed in range(10)]
    without = [plan(problem, seed, visited_weight=0.0).claimed_feasible for seed in range(10)]
    assert all(found)
    assert sum(without) < 3


def test_reach_is_a_share_of_the_smaller_side(monkeypatch):
    colonies = []

    def build_first_path(rng, occupied, start, target, rules):
        colonies.append((rules.reach, rules.spread))
        return np.array([start, target])

    def evolve(rng, occupied, path, rules):
        assert (rules.reach, rules.spread) == colonies[-1]
        return path, np.zeros(1)

    monkeypatch.setattr(abc_ep, "_build_first_path", build_first_path)
    monkeypatch.setattr(abc_ep, "_evolve", evolve)
    for rows, columns in ((101, 301), (301, 101), (101, 101)):
        wide = Grid(np.zeros((rows, columns), dtype=bool), 1.0, "cell")
        plan(Problem("test", wide, (0.5, 0.5), (50.5, 50.5)), reach=0.1, spread=0.025)
    assert colonies == [(10.0, 2.5)] * 3


def test_cut_short_goes_to_the_last_point_in_sight():
    occupied = np.zeros((20, 20), dtype=bool)
    occupied[5:, 10] = True
    path = np.array(
        [
            [1.5, 15.5],
            [3.5, 12.5],
            [5.5, 9.5],
            [9.5, 4.5],
            [10.5, 3.5],
            [12.5, 5.5],
            [14.5, 10.5],
            [17.5, 15.5],
        ]
    )
    assert abc_ep._cut_short(occupied, path).tolist() == [[1.5, 15.5], [10.5, 3.5], [17.5, 15.5]]


def test_cost_is_the_way_there_and_on_and_the_cones_around_points_chosen():
    occupied = np.zeros((50, 50), dtype=bool)
    occupied[10, 20] = True
    path = np.array([[0.5, 0.5], [8.5, 6.5], [10.5, 10.5], [0.0, 0.0]])
    target = np.array([40.5, 40.5])
    point = np.array([13.9, 14.1])
    colony = settings(reach=10.0)
    # The cones have their height in the middle of the point's cell.
    cones = max(0, 10 - math.dist((8.5, 6.5), (13.5, 14.5))) + max(
        0, 10 - math.dist((10.5, 10.5), (13.5, 14.5))
    )
    expected = 0.5 * math.dist((10.5, 10.5), point) + math.dist(point, target) + 2 * cones
    assert abc_ep._compute_cost(occupied, target, path, 3, point, colony) == pytest.approx(
        expected, rel=1e-12
    )
    assert (
        abc_ep._compute_cost(occupied, target, path, 3, np.array([25.5, 10.5]), colony)
        == abc_ep._UNSEEN
    )


def colony_of(places, costs, monkeypatch, cycles):
    """The points that a colony in plain Python tries, and the weights that its onlookers choose by;
    no try is ever better.

    places: (sources, 2) the first sources, with their costs.
    """
    tried, weights, first = [], [], iter(places)

    def placed(rng, low, high, point):
        point[:] = next(first)

    def priced(occupied, target, path, count, point, colony):
        tried.append(point.copy())
        return costs[len(tried) - 1] if len(tried) <= len(costs) else 1e6

    def chosen(rng, given, count):
        weights.append(given.copy())
        return rng.integers(0, len(given), count)

    for name, changed in (("_draw", placed), ("_compute_cost", priced), ("draw_parents", chosen)):
        monkeypatch.setattr(abc_ep, name, changed)
    monkeypatch.setattr(abc_ep, "_SOURCES", len(places))
    monkeypatch.setattr(abc_ep, "_TRIAL_LIMIT", 10**9)
    colony = settings(cycles=cycles, reach=40.0)
    path = np.array([[50.5, 50.5], [0.0, 0.0]])
    occupied = np.zeros((101, 101), dtype=bool)
    abc_ep._append_next_point.py_func(
        np.random.default_rng(5), occupied, np.array([90.0, 90.0]), path, 1, colony
    )
    return np.array(tried[len(costs) :]), weights


def test_onlookers_prefer_cheap_sources(monkeypatch):
    """In proportion to the fitness 1 / (1 + cost) of an artificial bee colony."""
    costs = [9.0, 1.0, 3.0, 0.0]
    _, weights = colony_of([(40, 40), (60, 40), (60, 60), (40, 60)], costs, monkeypatch, cycles=3)
    assert len(weights) == 3
    for given in weights:
        assert given / given.sum() == pytest.approx(np.array([0.1, 0.5, 0.25, 1.0]) / 1.85)


def test_bees_move_one_coordinate_to_either_side(monkeypatch):
    """By a share of the distance to another source, uniform between -1 and 1."""
    places = np.array([(40.0, 45.0), (50.0, 65.0)])
    tried, _ = colony_of(places, [1.0, 1.0], monkeypatch, cycles=500)
    # The source of which one coordinate is kept.
    bee = np.abs(tried - places[:, None]).min(axis=2).argmin(axis=0)
    share = (tried - places[bee]) / (places[bee] - places[1 - bee])
    assert ((share == 0).sum(axis=1) == 1).all()
    assert (share[:, 0] != 0).mean() == pytest.approx(0.5, abs=0.05)
    moved = np.sort(share[share != 0])
    assert moved == pytest.approx(np.linspace(-1, 1, len(moved)), abs=0.08)
