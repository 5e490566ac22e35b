"""Columns of printed means judged as wholes: level and order."""

import numpy as np
import outcome
import pandas as pd
import pytest
from pivots import pivot_of
from scipy import stats

from bezierplan.analysis import statistics
from bezierplan.analysis.numbers import comparison, order_and_level
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
            "workspace": "room",
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
    compared = comparison.compare(ours, spec, printed, {}, [], "s/table1", [], {})
    return order_and_level.compare_columns(ours, spec, compared, "s/table1", paired).set_index(
        "quantity"
    )


@pytest.fixture(scope="module")
def ours():
    return results(drawn(np.random.default_rng(1), 400))


def test_methods_that_start_alike_share_their_luck(ours):
    """The closed form for normal values: of a mean, the root of 1 / n + 1 / ours."""
    error = np.sqrt(1 / PAPER + 1 / 400)
    together, apart = (judged(ours, TRUE, paired) for paired in (True, False))
    width = together["high95_predicted"] - together["low95_predicted"]
    assert width["level"] == pytest.approx(2 * 1.96 * error * COMMON, rel=0.1)
    own = apart["high95_predicted"] - apart["low95_predicted"]
    assert own["level"] == pytest.approx(width["level"] / np.sqrt(5), rel=0.1)
    assert together.loc["order", "low95_predicted"] > 0.5 > apart.loc["order", "low95_predicted"]


@pytest.mark.parametrize(
    ("means", "level", "order"),
    [
        (TRUE + 0.2, "inside", "inside"),
        (TRUE + 2, "above", "inside"),
        (TRUE - 2, "below", "inside"),
        (TRUE[::-1], "inside", "below"),
    ],
)
def test_level_and_order_of_a_column_have_positions(ours, means, level, order):
    assert judged(ours, means)["position"].to_dict() == {"level": level, "order": order}


def test_columns_of_true_experiments_are_seldom_out_of_range(ours):
    rng = np.random.default_rng(2)
    found = [judged(ours, drawn(rng, PAPER).mean(axis=0))["position"] for _ in range(40)]
    assert np.mean([position == "inside" for position in found]) > 0.92


def test_an_experiment_prints_the_mean_of_the_runs_that_count():
    values = np.full((20, 5), 3.0)
    values[::2] = np.nan
    group = pd.DataFrame({"n_published": [PAPER] * 5, "decimals": 2})
    runs = pd.MultiIndex.from_product([["long"], range(20)])
    group["by_run"] = [pd.Series(column, runs) for column in values.T]
    means, tail = order_and_level.draw_means(group, True, np.random.default_rng(3))
    assert (means == 3).all()
    assert 0.99 < len(means) / statistics.DRAWS < 1, "in 1 of 1,024 or so no run counts"
    assert tail < statistics.TAIL


def test_columns_of_few_methods_and_few_runs_are_no_wholes(ours):
    few = ours._replace(runs=ours.runs[ours.runs["method"] < "d"])
    assert judged(few, TRUE).empty
    assert judged(results(np.ones((5, 5))), TRUE).empty


def test_rank_correlation():
    first, second, third = np.round(np.random.default_rng(4).normal(size=(3, 8)), 0)
    found = order_and_level.compute_rank_correlations(np.array([first, second, np.ones(8)]), third)
    expected = [stats.spearmanr(each, third).statistic for each in (first, second)]
    assert found[:2] == pytest.approx(expected)
    assert np.isnan(found[2])


def test_printed_means_of_tharwat2018():
    """Under our default reading ours may have their order."""
    kept = pd.read_csv(TREE / outcome.KEPT / outcome.ORDERS)
    found = kept.query("study == 'tharwat2018' and metric == 'objective'")
    order = found.set_index(["table", "quantity"]).loc[("table3", "order")]
    assert (order["printed"], order["position"]) == (pytest.approx(0.429, abs=1e-3), "inside")
