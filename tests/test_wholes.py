"""Columns of printed means judged as wholes: level, spread, order and deviations."""

import numpy as np
import outcome
import pandas as pd
import pytest
from pivots import pivot_of
from scipy import stats

from bezierplan.analysis import statistics
from bezierplan.analysis.numbers import comparison, wholes
from bezierplan.analysis.results import Results
from bezierplan.places import TREE
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem

PROBLEM = Problem("long", from_lines(["..", ".."], 1.0, "m"), (0.5, 0.5), (1.5, 1.5))
METHODS = ["a", "b", "c", "d", "e"]
TRUE = np.array([10.0, 10.1, 10.2, 10.3, 10.4])
COMMON, OWN = 1.0, 0.1
"""Standard deviations: of the luck that all methods of a repeat share, and of their own."""
SPEC = {
    "where": {"problem": ["long"], "method": METHODS},
    "index": ["method"],
    "columns": ["value"],
    "values": [{"metric": "objective", "statistic": "mean", "label": "value", "decimals": 4}],
}
PAPER = 10


@pytest.fixture(autouse=True)
def few_draws(monkeypatch):
    monkeypatch.setattr(statistics, "DRAWS", 2000)


def drawn(rng, repeats):
    """Values (repeats, methods) of methods that start alike."""
    shape = (repeats, len(TRUE))
    return TRUE + COMMON * rng.normal(size=(repeats, 1)) + OWN * rng.normal(size=shape)


def results(values):
    runs = [
        {
            "id": f"s/e/long/{method}/{repeat}",
            "condition": "long",
            "problem": "long",
            "method": method,
            "drew": True,
            "repeat": repeat,
            "objective": values[repeat, number],
            "length": 1.0,
            "evaluations": 1,
            "feasible": True,
            "claimed_feasible": True,
            "bound": 1.0,
        }
        for number, method in enumerate(METHODS)
        for repeat in range(len(values))
    ]
    return Results(pd.DataFrame(runs), {"long": PROBLEM}, pd.DataFrame())


def judged(ours, means, paired=True):
    """The wholes of printed means, by quantity."""
    printed = pd.DataFrame({"method": METHODS, "metric": "objective", "statistic": "mean"})
    printed = printed.assign(n=PAPER, unit="m", value=np.round(means, 4))
    spec = pivot_of(SPEC)
    compared = comparison.compare(ours, spec, printed, {}, [], "s/table1")
    return wholes.of_table(ours, spec, compared, "s/table1", paired).set_index("quantity")


@pytest.fixture(scope="module")
def ours():
    return results(drawn(np.random.default_rng(1), 400))


def test_methods_that_start_alike_share_their_luck(ours):
    """The closed form for normal values: of a mean, the root of 1 / n + 1 / ours."""
    error = np.sqrt(1 / PAPER + 1 / 400)
    together, apart = (judged(ours, TRUE, paired) for paired in (True, False))
    assert together["together"].all()
    assert not apart["together"].any()
    width = together["high95_predicted"] - together["low95_predicted"]
    assert width["level"] == pytest.approx(2 * 1.96 * error * COMMON, rel=0.1)
    own = apart["high95_predicted"] - apart["low95_predicted"]
    assert own["level"] == pytest.approx(width["level"] / np.sqrt(5), rel=0.1)
    assert together.loc["spread", "high95_predicted"] < 0.25 < apart.loc["spread", "ours"]
    assert together.loc["order", "low95_predicted"] > 0.5 > apart.loc["order", "low95_predicted"]


def test_each_kind_of_column_is_named(ours):
    """A printed column of another level, spread or order, and one with a single odd mean."""
    fits = judged(ours, TRUE + 0.2)
    assert fits["in_range"].all()
    assert (fits["printed"][["deviations", "deviations of the others"]] == 0).all()
    higher = judged(ours, TRUE + 2)
    assert higher["in_range"].to_list() == [False, True, True, True, True]
    wider = judged(ours, 10.2 + 3 * (TRUE - 10.2))["in_range"]
    assert wider.to_list() == [True, False, True, False, False]
    reverse = judged(ours, TRUE[::-1])
    assert reverse["in_range"].to_list() == [True, True, False, False, False]
    order = reverse.loc["order"]
    assert order["printed"] == pytest.approx(-1)
    assert order["chance_any_order"] == pytest.approx(2 / 120, abs=0.01)
    assert order["chance"] < 0.01
    odd = judged(ours, TRUE + np.eye(5)[4])
    assert odd.loc["deviations", "printed"] == 5, "one moves the mean of all"
    assert "e" in odd.loc["deviations", "outside"]
    assert odd.loc["deviations of the others", ["printed", "methods"]].to_list() == [0, 4]
    assert odd.loc["deviations of the others", "in_range"]


def test_columns_of_true_experiments_are_seldom_out_of_range(ours):
    rng = np.random.default_rng(2)
    inside = [judged(ours, drawn(rng, PAPER).mean(axis=0))["in_range"] for _ in range(40)]
    assert 0.92 < np.mean(inside) < 1


def test_an_experiment_prints_the_mean_of_the_runs_that_count():
    values = np.full((20, 5), 3.0)
    values[::2] = np.nan
    group = pd.DataFrame({"n_published": [PAPER] * 5, "decimals": 2})
    runs = pd.MultiIndex.from_product([["long"], range(20)])
    group["by_run"] = [pd.Series(column, runs) for column in values.T]
    means, tail = wholes.experiments(group, True, np.random.default_rng(3))
    assert (means == 3).all()
    assert 0.99 < len(means) / statistics.DRAWS < 1, "in 1 of 1,024 or so no run counts"
    assert tail < statistics.TAIL


def test_columns_of_few_methods_and_few_runs_are_no_wholes(ours):
    few = ours._replace(runs=ours.runs[ours.runs["method"] < "d"])
    assert judged(few, TRUE).empty
    assert judged(results(np.ones((5, 5))), TRUE).empty


@pytest.mark.parametrize(
    ("printed", "chance", "in_range"),
    [(0, 0.02, False), (1, 0.04, False), (5, 0.12, True), (50, 1, True), (97.5, 0.06, True)],
)
def test_chance_is_the_share_that_lies_as_far_out_on_both_sides(printed, chance, in_range):
    """Beside the experiments 1, 2, ... 99; the printed one is one of them."""
    found = wholes._placed("level", np.array([printed, *range(1, 100)]), 0.025)
    assert found["chance"] == pytest.approx(chance)
    assert found["in_range"] == in_range
    assert [found[end] for end in ("low95_predicted", "ours", "high95_predicted")] == (
        pytest.approx([1 + 0.025 * 98, 50, 99 - 0.025 * 98])
    )


def test_chance_of_deviations_is_the_share_of_experiments_with_as_large_ones():
    """Experiments deviate by -50, ... 50 of a direction, the printed means by 48.5 of it."""
    sizes = np.array([48.5, *range(-50, 0), *range(1, 51)])
    means = 7 + np.outer(sizes, [3.0, -3.0, 1.0, -1.0])
    every, others = wholes._deviations(means, np.array(list("abcd")), 0.025)
    assert every["chance"] == pytest.approx(5 / 101)
    assert (every["printed"], every["outside"], every["methods"]) == (4, "a, b, c, d", 4)
    assert not every["in_range"]
    assert (others["quantity"], others["methods"]) == ("deviations of the others", 3)


def test_level_and_spread_are_mean_and_sample_deviation(ours):
    found = judged(ours, TRUE)["printed"]
    assert found["level"] == pytest.approx(TRUE.mean())
    assert found["spread"] == pytest.approx(TRUE.std(ddof=1))


def test_rank_correlation():
    first, second, third = np.round(np.random.default_rng(4).normal(size=(3, 8)), 0)
    found = wholes.rank_correlations(np.array([first, second, np.ones(8)]), third)
    expected = [stats.spearmanr(each, third).statistic for each in (first, second)]
    assert found[:2] == pytest.approx(expected)
    assert np.isnan(found[2])


def test_printed_means_of_tharwat2018():
    """Level and spread fit, the order is the reverse; without Gauss, 3 of 15 averages are out."""
    kept = pd.read_csv(TREE / outcome.KEPT / outcome.WHOLES)
    found = kept.query("study == 'tharwat2018' and metric == 'objective'")
    found = found.set_index(["table", "quantity"])
    order = found.loc[("table3", "order")]
    assert order["printed"] == pytest.approx(-0.786, abs=1e-3)
    assert order["chance_any_order"] == pytest.approx(0.028, abs=5e-3)
    assert order["chance"] < 0.02
    assert found.loc[("table3", "level"), "in_range"]
    spread = found.loc[("table3", "spread"), ["low95_predicted", "high95_predicted"]]
    assert spread.to_list() == pytest.approx([0.13, 0.57], abs=0.03)
    assert found.loc[("table3", "deviations"), "outside"] == "cpso1_tent"
    others = found.loc[("table4", "deviations of the others"), "outside"]
    assert others == "cpso2_singer, cpso2_tent"
    assert found["together"].all()
