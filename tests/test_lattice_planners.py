"""What holds for all planners over the 8-connected lattice: the rivals of ma2020, with the settings
of its environments.
"""

import math
from pathlib import Path as File

import numpy as np
import pytest

from bezierplan.geometry import checker, curves, shortest_paths
from bezierplan.geometry.region import region
from bezierplan.planners import ant_colony, planner_module
from bezierplan.planners.parts.settings import filled
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem

MAPS = File(__file__).parent / "data" / "maps" / "ma2020"

COLONY = {
    "corners": "one",
    "ants": 20,
    "iterations": 50,
    "trail_weight": 1.0,
    "heuristic_weight": 2.0,
    "target_heuristic": 100.0,
    "initial_trail": 1.0,
    "evaporation": 0.1,
    "deposit": 1.0,
    "trail_update": "ant_system",
    "exploitation": 0.0,
    "local_evaporation": 0.0,
}
GENETIC = {
    "population": 100,
    "generations": 50,
    "crossover_probability": 0.9,
    "mutation_probability": 0.1,
    "elitism": 1,
}
SETTINGS = {
    "ant_colony": COLONY,
    "lattice_genetic": GENETIC
    | {
        "corners": "one",
        "coding": "via_cells",
        "genes": 8,
        "initial": "uniform",
        "mutation": "cell",
        "longest_join": 600,
    },
    "ant_colony_genetic": COLONY | GENETIC | {"mutation": "one_cell", "longest_join": 600},
    "fish_swarm_genetic": GENETIC
    | {
        "corners": "one",
        "fish": 20,
        "tries": 8,
    },
}
VARIANTS = {
    "aco": ("ant_colony", {}),
    "aco_strong": (
        "ant_colony",
        {"ants": 50, "heuristic_weight": 7.0, "evaporation": 0.3, "initial_trail": 8.0},
    ),
    "acs": (
        "ant_colony",
        {
            "ants": 10,
            "trail_update": "ant_colony_system",
            "exploitation": 0.9,
            "local_evaporation": 0.1,
            "initial_trail": 1e-4,
        },
    ),
    "ga": ("lattice_genetic", {}),
    "ga_sorted": ("lattice_genetic", {"initial": "sorted"}),
    "ga_flip": ("lattice_genetic", {"mutation": "bit_flip"}),
    "ga_rows": ("lattice_genetic", {"coding": "rows"}),
    "aco_ga": ("ant_colony_genetic", {}),
    "aco_ga_reconnect": ("ant_colony_genetic", {"mutation": "reconnect"}),
    "asfa_ga": ("fish_swarm_genetic", {}),
}
each_variant = pytest.mark.parametrize("name", VARIANTS)

SEALED = from_lines(["....", "..##", "..#."][::-1], 2.0, "unit")


def colony_rules(**changes):
    """The settings of an ant colony as its search takes them."""
    return filled(ant_colony.Settings, COLONY | changes)


def environment(number):
    lines = (MAPS / f"environment{number}.txt").read_text().splitlines()
    return Problem("test", from_lines(lines, 1.0, "cell"), (0.0, 0.0), (20.0, 20.0))


def plan(name, problem=None, seed=0, **changes):
    planner, variant = VARIANTS[name]
    settings = (
        SETTINGS[planner]
        | variant
        | {key: value for key, value in changes.items() if key in SETTINGS[planner]}
    )
    return planner_module(planner).plan(
        problem or environment(1), np.random.default_rng(seed), **settings
    )


@each_variant
@pytest.mark.parametrize("corners", ["one", "none"])
@pytest.mark.parametrize("number", [1, 2])
def test_a_path_is_a_lattice_path_of_its_own_length_and_free(name, corners, number):
    problem = environment(number)
    found = plan(name, problem, seed=number, corners=corners)
    points = found.path.points
    assert points[[0, -1]].tolist() == [[0, 0], [20, 20]]
    assert points[[1, -2]].tolist() == [[0.5, 0.5], [19.5, 19.5]]
    steps = np.abs(np.diff(points[1:-1], axis=0))
    assert (steps.max(axis=1) == 1).all()
    assert found.claimed_feasible
    assert checker.check(curves.bezier_pieces(found.path), region(problem.workspace)).feasible
    assert found.objective == pytest.approx(curves.length(found.path), rel=1e-13)
    least = shortest_paths.lattice_path(
        problem.workspace.occupied, (0, 0), (19, 19), math.sqrt(2), corners
    ).length + math.sqrt(2)
    assert found.objective >= least - 1e-9
    if corners == "none":
        column, row = points[1:-1].astype(int).T
        diagonal = steps.all(axis=1)
        beside = (
            problem.workspace.occupied[row[1:], column[:-1]]
            | problem.workspace.occupied[row[:-1], column[1:]]
        )
        assert not beside[diagonal].any()


# Mean lengths of 30 runs of an independent program.
MEANS = {
    ("aco", "one"): (46.12, 42.05),
    ("aco_strong", "one"): (31.72, 32.38),
    ("ga", "one"): (39.27, 37.23),
    ("ga_rows", "one"): (31.31, 32.38),
    ("aco_ga", "one"): (34.32, 33.07),
    ("aco_ga_reconnect", "one"): (31.45, 32.40),
    ("asfa_ga", "one"): (31.78, 32.60),
    ("aco", "none"): (50.0, 43.8),
    ("ga", "none"): (47.4, 41.8),
    ("aco_ga", "none"): (37.2, 35.3),
    ("asfa_ga", "none"): (33.7, 33.8),
}


@pytest.mark.parametrize(("name", "corners"), MEANS)
@pytest.mark.parametrize("number", [1, 2])
def test_mean_lengths_are_those_of_an_independent_program(name, corners, number):
    lengths = [
        plan(
            name,
            environment(number),
            seed,
            corners=corners,
            iterations=50 * number,
            generations=50 * number,
        ).objective
        for seed in range(30)
    ]
    # Both means have the error of 30 runs; the other one is rounded.
    error = math.sqrt(2 / 30) * np.std(lengths, ddof=1) + 0.05
    assert abs(np.mean(lengths) - MEANS[name, corners][number - 1]) < 3.5 * error


@each_variant
def test_history_never_rises_and_ends_with_the_objective(name):
    found = plan(name)
    assert (found.history[1:] <= found.history[:-1]).all()
    assert found.history[-1] == found.objective
    assert found.evaluations >= len(found.history)


@each_variant
def test_a_sealed_target_has_no_path(name):
    problem = Problem("test", SEALED, SEALED.centre(0), SEALED.centre(11))
    found = plan(name, problem)
    assert found.path is None
    assert found.objective == math.inf
    assert not found.claimed_feasible
    assert found.stop == "no path"


@each_variant
def test_start_equal_to_target_is_a_path_of_no_length_without_a_generation(name):
    found = plan(name, environment(1)._replace(target=(0.0, 0.0)))
    assert found.path.points.tolist() == [[0, 0], [0, 0]]
    assert found.history.tolist() == [0]


@each_variant
def test_start_and_target_in_one_cell_are_joined_by_its_centre(name):
    found = plan(name, environment(1)._replace(target=(0.9, 0.5)))
    assert found.path.points.tolist() == [[0, 0], [0.5, 0.5], [0.9, 0.5]]
    assert found.objective == pytest.approx(math.sqrt(0.5) + 0.4)


@each_variant
def test_an_empty_map_has_the_diagonal_as_bound(name):
    found = plan(
        name, Problem("test", from_lines(["." * 20] * 20, 1.0, "cell"), (0.0, 0.0), (20.0, 20.0))
    )
    assert found.objective >= 20 * math.sqrt(2) - 1e-9


@each_variant
def test_the_only_way_is_found(name):
    corridor = from_lines(["......"], 3.0, "unit")
    found = plan(name, Problem("test", corridor, corridor.centre(5), corridor.centre(0)))
    assert found.objective == pytest.approx(15)


@each_variant
def test_no_generation_leaves_the_best_of_the_first(name):
    few = plan(name, generations=0, iterations=1)
    assert few.objective == few.history[-1]
    assert len(few.history) == 1
    assert few.claimed_feasible


@each_variant
def test_lengths_are_in_units(name):
    problem = environment(1)
    grid = problem.workspace
    large = Problem(
        "test",
        from_lines((MAPS / "environment1.txt").read_text().splitlines(), 10.0, "m"),
        (0.0, 0.0),
        (200.0, 200.0),
    )
    assert grid.cell == 1.0
    scaled = plan(name, large)
    assert scaled.history == pytest.approx(10 * plan(name, problem).history)


@pytest.mark.parametrize("planner", ["lattice_genetic", "ant_colony_genetic", "fish_swarm_genetic"])
def test_an_odd_population_is_named(planner):
    with pytest.raises(ValueError, match=r"population: 7; .*even"):
        planner_module(planner).check(SETTINGS[planner] | {"population": 7})


@each_variant
def test_a_start_in_an_occupied_cell_is_named(name):
    grid = from_lines(["....", ".#..", "...."], 1.0, "unit")
    with pytest.raises(
        ValueError,
        match=r"start: .*occupied cell of row 1, column 1; expected a point of a free cell",
    ):
        plan(name, Problem("test", grid, (1.0, 1.0), (4.0, 3.0)))
