"""`make benchmark`: each part runs at its smallest size, and what it measures is right where that
is known.
"""

import importlib
import math
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from test_binary_genetic import SETTINGS as GENETIC
from test_chaotic_pso import SETTINGS as SWARM

from bezierplan.planners import binary_genetic, chaotic_pso
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Problem

SCRIPTS = Path(__file__).parent / "benchmark"
NAMES = {file.stem for file in SCRIPTS.glob("*.py")}
SIZES = np.array([10.0, 20.0, 40.0, 80.0, 160.0, 320.0])


@pytest.fixture
def script(monkeypatch):
    """Imports a script of the benchmark, whose names mean nothing elsewhere."""
    monkeypatch.syspath_prepend(str(SCRIPTS))
    yield importlib.import_module
    for name in NAMES & sys.modules.keys():
        del sys.modules[name]


@pytest.mark.parametrize("part", ["runs", "least", "simulation", "limits", "growth", "start"])
def test_each_part_runs_at_its_smallest_size(part, script, tmp_path, monkeypatch, capsys):
    run = script("run")
    assert part in run.PARTS
    monkeypatch.setattr(run.frame, "FOLDER", tmp_path)
    monkeypatch.setattr(run.frame, "ROUNDS", 1)
    run.main([part, "small"])
    heading, *lines = capsys.readouterr().out.strip().splitlines()
    assert heading.startswith(f"{part}: ")
    assert len(lines) == len((tmp_path / f"{part}.csv").read_text().splitlines()) - 1 > 1


@pytest.mark.parametrize("power", [0.0, 0.5, 1.0, 2.0, 3.0])
def test_slope_of_a_power_is_its_exponent(script, power):
    line = script("growth").slope(SIZES, 0.003 * SIZES**power)
    assert line.value == pytest.approx(power, abs=1e-12)
    assert power == 1 or line.steeper == (power > 1)  # rounding decides at the limit


def test_slopes_with_a_constant_cost_or_errors_of_measurement(script):
    slope = script("growth").slope
    assert slope(SIZES, np.where(SIZES < 40, 1.0, SIZES**2 / 1600)).steeper
    noise = np.exp(np.random.default_rng(0).normal(0, 0.1, (1000, len(SIZES))))
    assert np.mean([slope(SIZES, SIZES * each).steeper for each in noise]) < 0.12
    assert np.mean([slope(SIZES, SIZES**2 * each).steeper for each in noise]) > 0.99


def test_a_swarm_tests_every_sample_with_every_circle_and_measures_paths_that_may_be_best(script):
    discs = np.array([[5.0, 5.0], [3.0, 7.0]]), np.array([1.0, 0.5])
    field = Problem("", Circles((0.0, 10.0, 0.0, 10.0), *discs, "unit"), (1.0, 1.0), (9.0, 9.0))
    size = {"control_points": 3, "samples": 50, "particles": 4, "iterations": 6, "stall_limit": 0}
    before = chaotic_pso._swarm

    def run():
        return chaotic_pso.plan(field, np.random.default_rng(0), **(SWARM | size))

    plan, done = script("least").operations(run)
    assert plan.history.tolist() == run().history.tolist()
    paths = 4 * 7
    measured = done.pop("roots") / 49
    assert measured in range(4, paths)
    assert done == Counter(terms=3 * 50 * paths, obstacles=2 * 50 * paths)
    assert chaotic_pso._swarm is before  # compiled again


def test_a_curve_of_one_piece_is_measured_whole_unless_it_is_a_parents(script):
    grid = Grid(np.zeros((8, 8), dtype=bool), 1.0, "cell")
    problem = Problem("", grid, grid.centre(0), grid.centre(63))
    size = {"genes": 4, "samples": 40, "population": 6, "generations": 0}
    settings = GENETIC | {"curve": "bezier", "spacing": "parameter"} | size
    rng = np.random.default_rng(0)
    _, done = script("least").operations(lambda: binary_genetic.plan(problem, rng, **settings))
    measured = done["roots"] / 39
    assert done["terms"] == 6 * 40 * measured
    assert done["cells"] == 39 * measured
    assert 1 <= measured <= 6


@pytest.mark.parametrize("number", range(5))
def test_contests_of_make_compare_without_the_other_library(script, number):
    compare = script("compare_planners")
    contest = compare.CONTESTS[number]
    attempts = compare.compete(compare.arena(contest), {}, seeds=1)
    assert set(attempts["method"]) == {*contest.methods, "rounded"}
    assert len(attempts) == 2 * len(compare.SHARES) + 1
    (near,) = attempts.loc[attempts["method"] == "rounded", "excess"]
    assert 0 <= near < 0.05


def test_time_until_a_path_is_near_the_shortest_one(script):
    rows = [("p", "m", 0, 3.0, 0.005), ("p", "m", 0, 1.0, 0.08), ("p", "m", 1, 2.0, math.inf)]
    columns = ["problem", "method", "seed", "cpu_s", "excess"]
    table = script("compare_planners").time_table(pd.DataFrame(rows, columns=columns))
    assert table["median_s"].tolist() == [1.0, 3.0, 3.0, 3.0]
    assert table["reached"].tolist() == [0.5] * 4
