"""The five proposed algorithms, and the generic one beside them, as the documentation shows them,
each a page of plain Python (docs/algorithms): they find what the kernels find, to the last bit.
"""

from pathlib import Path

import numpy as np
import pytest
from studies import built, study

from bezierplan.planners import load_planner

ALGORITHMS = Path(__file__).parents[1] / "docs" / "algorithms"
SEEDS = range(20)

# Problems of an experiment, and settings; a smaller search shows the same.
CASES = {
    ("song2016", "routes"): (
        ["0_15", "15_240"],
        [{"population": 20, "generations": 20}, {"genes": 3, "samples": 61, "generations": 2}],
    ),
    ("elhoseny2017", "fields100"): (
        ["case1_100_0_25", "case2_100_dense_1_15"],
        [
            {"population": 10, "iterations": 10},
            {"population": 16, "iterations": 4, "eta": 0.5, "mutation_rate": 0.05},
        ],
    ),
    ("tharwat2018", "search_range"): (
        ["equal", "equal_wide"],
        [{"chaotic_term": "cognitive"}, {}, {"control_points": 5, "iterations": 9}],
    ),
    ("differential_evolution", "worth"): (
        ["equal"],
        [{}, {"population": 6, "generations": 20, "weight": 0.5, "crossover": 0.5}],
    ),
    ("ma2020", "environments"): (
        ["environment1", "environment2"],
        [{"population": 20, "generations": 20}, {"samples": 51, "generations": 2}],
    ),
    ("meledje", "operators"): (
        ["env1_initial", "env2_modified"],
        [{"population": 16}, {"most_nodes": 7, "crossover_probability": 0.5, "generations": 3}],
    ),
}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case[0])
def test_a_page_of_python_finds_what_the_kernel_finds(case):
    key, experiment = case
    page = load_planner(str(ALGORITHMS / f"{key}.py"))
    home, _, method = page.METHOD.partition("/")
    kernel = load_planner(study(home).planner(method))
    settings = study(home).resolve_settings(method)
    assert page.plan.__kwdefaults__.items() <= settings.items()
    names, changes = CASES[case]
    problems = [built(study(home), experiment, name) for name in names]
    for changed in changes:
        for seed in SEEDS:
            problem = problems[seed % len(problems)]
            points, history = page.plan(problem, np.random.default_rng(seed), **changed)
            found = kernel.plan(problem, np.random.default_rng(seed), **(settings | changed))
            np.testing.assert_array_equal(points, found.path.points)
            np.testing.assert_array_equal(history, found.history)


@pytest.mark.parametrize("file", sorted(ALGORITHMS.glob("*.py")), ids=lambda file: file.stem)
def test_an_algorithm_is_a_page_without_kernels(file):
    lines = file.read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 120
    assert not any("numba" in line or "bezierplan.planners" in line for line in lines)
