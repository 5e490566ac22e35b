"""The operations that `make benchmark ARGS=least` counts, on work that is known."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from test_binary_genetic import SETTINGS as GENETIC
from test_chaotic_pso import SETTINGS as SWARM

from bezierplan.planners import binary_genetic, chaotic_pso
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Problem

FIELD = Problem(
    "",
    Circles(
        (0.0, 10.0, 0.0, 10.0), np.array([[5.0, 5.0], [3.0, 7.0]]), np.array([1.0, 0.5]), "unit"
    ),
    (1.0, 1.0),
    (9.0, 9.0),
)


@pytest.fixture
def least(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parent / "benchmark"))
    import least

    return least


def test_a_swarm_measures_every_particle_and_tests_each_of_its_samples_with_each_circle(least):
    size = {"control_points": 3, "samples": 50, "particles": 4, "iterations": 6, "stall_limit": 0}

    def run():
        return chaotic_pso.plan(FIELD, np.random.default_rng(0), **(SWARM | size))

    found, done = least.operations(run)
    assert found.history.tolist() == run().history.tolist()
    paths = 4 * 7
    assert done == Counter(terms=3 * 50 * paths, roots=49 * paths, obstacles=2 * 50 * paths)


def test_a_curve_of_one_piece_is_measured_whole_unless_it_is_a_parents(least):
    grid = Grid(np.zeros((8, 8), dtype=bool), 1.0, "cell")
    problem = Problem("", grid, grid.centre(0), grid.centre(63))
    size = {
        "curve": "bezier",
        "spacing": "parameter",
        "genes": 4,
        "samples": 40,
        "population": 6,
        "generations": 0,
    }
    _, done = least.operations(
        lambda: binary_genetic.plan(problem, np.random.default_rng(0), **(GENETIC | size))
    )
    measured = done["roots"] / 39
    assert done["terms"] == 6 * 40 * measured
    assert done["cells"] == 39 * measured
    assert 1 <= measured <= 6


def test_kernels_are_compiled_ones_again_afterwards(least):
    before = chaotic_pso._swarm
    least.operations(
        lambda: chaotic_pso.plan(FIELD, np.random.default_rng(0), **(SWARM | {"iterations": 1}))
    )
    assert chaotic_pso._swarm is before
