"""What holds for all planners over the 8-connected lattice: the rivals of ma2020."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from studies import planned, study

from bezierplan.geometry import checker, curves, shortest_paths
from bezierplan.geometry.region import build_region
from bezierplan.planners import ant_colony
from bezierplan.planners.parts.settings import fill_settings
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.lattice import list_neighbours
from bezierplan.workspaces.problem import Problem

DATA = Path(__file__).parent / "data"
COLONY = study("ma2020").resolve_settings("aco")
VARIANTS = {
    "aco": ("aco", {}),
    "aco_strong": ("aco_strong", {}),
    "acs": ("aco_system", {}),
    "ga": ("ga", {}),
    "ga_sorted": ("ga", {"initial": "sorted"}),
    "ga_flip": ("ga", {"mutation": "bit_flip"}),
    "ga_rows": ("ga_strong", {}),
    "aco_ga": ("aco_ga", {}),
    "aco_ga_reconnect": ("aco_ga_strong", {}),
    "asfa_ga": ("asfa_ga", {}),
}
each_variant = pytest.mark.parametrize("name", VARIANTS)


def colony_rules(**changes):
    """The settings of an ant colony as its search takes them."""
    return fill_settings(ant_colony.Settings, COLONY | changes)


def environment(number):
    """One of two maps on which an independent program has run."""
    lines = (DATA / f"lattice_map{number}.txt").read_text().splitlines()
    return Problem("test", from_lines(lines, 1.0, "cell"), (0.0, 0.0), (20.0, 20.0))


def plan(name, problem=None, seed=0, **changes):
    method, variant = VARIANTS[name]
    known = study("ma2020").resolve_settings(method)
    changes = {key: value for key, value in changes.items() if key in known}
    return planned("ma2020", method, problem or environment(1), seed, **variant | changes)


@each_variant
@pytest.mark.parametrize("corners", ["one", "none"])
@pytest.mark.parametrize("number", [1, 2])
def test_a_path_is_a_lattice_path_of_its_own_length_and_free(name, corners, number):
    problem = environment(number)
    found = plan(name, problem, seed=number, corners=corners)
    points = found.path.points
    assert points[[0, -1]].tolist() == [[0, 0], [20, 20]]
    assert points[[1, -2]].tolist() == [[0.5, 0.5], [19.5, 19.5]]
    column, row = points[1:-1].astype(int).T
    reached = list_neighbours(problem.workspace.occupied, corners)
    assert all(other in reached[one] for one, other in pairwise(20 * row + column))
    assert found.claimed_feasible
    assert checker.check(curves.bezier_pieces(found.path), build_region(problem.workspace)).feasible
    assert found.objective == pytest.approx(curves.length(found.path), rel=1e-13)
    least = shortest_paths.lattice_path(
        problem.workspace.occupied, (0, 0), (19, 19), math.sqrt(2), corners
    ).length + math.sqrt(2)
    assert found.objective >= least - 1e-9


# Mean lengths of 30 runs of an independent program, by environment.
MEANS = {
    ("aco", "one"): {1: 46.12, 2: 42.05},
    ("aco_strong", "one"): {1: 31.72, 2: 32.38},
    ("ga", "one"): {1: 39.27, 2: 37.23},
    ("ga_rows", "one"): {1: 31.31},
    ("aco_ga", "one"): {1: 34.32, 2: 33.07},
    ("aco_ga_reconnect", "one"): {1: 31.45, 2: 32.40},
    ("asfa_ga", "one"): {1: 31.78, 2: 32.60},
    ("aco", "none"): {1: 50.0, 2: 43.8},
    ("ga", "none"): {1: 47.4, 2: 41.8},
    ("aco_ga", "none"): {1: 37.2, 2: 35.3},
    ("asfa_ga", "none"): {1: 33.7, 2: 33.8},
}


@pytest.mark.parametrize(
    ("name", "corners", "number", "mean"),
    [(*case, number, mean) for case, means in MEANS.items() for number, mean in means.items()],
)
def test_mean_lengths_are_those_of_an_independent_program(name, corners, number, mean):
    changes = {"corners": corners, "iterations": 50 * number, "generations": 50 * number}
    lengths = [plan(name, environment(number), seed, **changes).objective for seed in range(30)]
    # Both means have the error of 30 runs; the other one is rounded.
    error = math.sqrt(2 / 30) * np.std(lengths, ddof=1) + 0.05
    assert abs(np.mean(lengths) - mean) < 3.5 * error


@each_variant
def test_start_and_target_in_one_cell_are_joined_by_its_centre(name):
    found = plan(name, environment(1)._replace(target=(0.9, 0.5)))
    assert found.path.points.tolist() == [[0, 0], [0.5, 0.5], [0.9, 0.5]]
    assert found.objective == pytest.approx(math.sqrt(0.5) + 0.4)


@each_variant
def test_the_only_way_is_found(name):
    corridor = from_lines(["......"], 3.0, "unit")
    found = plan(name, Problem("test", corridor, corridor.centre(5), corridor.centre(0)))
    assert found.objective == pytest.approx(15)
