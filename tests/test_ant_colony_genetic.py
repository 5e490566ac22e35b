"""Ants with a genetic algorithm after them: what is handed over, and the two stages of the
history.
"""

import numpy as np
from test_lattice_planners import colony_rules, environment, plan

from bezierplan.planners import ant_colony
from bezierplan.planners.ant_colony_genetic import _choose_first_population
from bezierplan.workspaces.lattice import build_grid_lattice


def colony_of(sizes, best):
    """A colony whose ants' paths tell them apart."""
    paths = np.arange(5 * len(sizes)).reshape(len(sizes), 5)
    return ant_colony.Colony(np.array(best), np.array([9.0]), paths, np.array(sizes))


def test_the_best_path_and_the_last_ants_in_turn_are_the_first_population():
    paths, sizes = _choose_first_population(colony_of([3, 0, 4], [40, 41]), 6)
    assert sizes.tolist() == [2, 3, 4, 3, 4, 3]
    assert [path[:size].tolist() for path, size in zip(paths, sizes, strict=True)] == [
        [40, 41],
        *([0, 1, 2], [10, 11, 12, 13], [0, 1, 2], [10, 11, 12, 13], [0, 1, 2]),
    ]


def test_where_all_last_ants_died_all_are_the_best_path():
    paths, sizes = _choose_first_population(colony_of([0, 0], [40, 41, 42]), 4)
    assert sizes.tolist() == [3] * 4
    assert paths[:, :3].tolist() == [[40, 41, 42]] * 4


def test_the_history_begins_with_the_ants():
    found = plan("aco_ga", iterations=6, generations=9)
    first, _ = np.random.default_rng(0).spawn(2)
    problem = environment(1)
    colony = ant_colony.search(
        build_grid_lattice(problem.workspace, problem.start, problem.target, "one"),
        first,
        colony_rules(iterations=6),
    )
    assert len(found.history) == 15
    assert found.history[:6].tolist() == colony.history.tolist()
    assert found.evaluations == 20 * 6 + 100 * 9
