"""Ants with a genetic algorithm after them: what is handed over, and the two stages of the
history.
"""

import numpy as np
from test_lattice_planners import colony_rules, environment, plan

from bezierplan.planners import ant_colony
from bezierplan.workspaces.lattice import lattice


def test_the_history_begins_with_the_ants():
    found = plan("aco_ga", iterations=6, generations=9)
    first, _ = np.random.default_rng(0).spawn(2)
    problem = environment(1)
    colony = ant_colony.search(
        lattice(problem.workspace, problem.start, problem.target, "one"),
        first,
        colony_rules(iterations=6),
    )
    assert len(found.history) == 15
    assert found.history[:6].tolist() == colony.history.tolist()
    assert found.evaluations == 20 * 6 + 100 * 9
