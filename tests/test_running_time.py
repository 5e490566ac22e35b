"""Expected running times, performance profiles and mean ranks over problems: small tables whose
answers can be counted.
"""

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from panels import options_of

from bezierplan.analysis import metrics, running_time
from bezierplan.analysis.results import Results
from bezierplan.figures.panels import (
    critical_difference,
    expected_running_time,
    performance_profile,
)


def results(rows) -> Results:
    """Runs (problem, method, length over the bound or None for a path that is not certified,
    evaluations), numbered within each method.
    """
    runs = pd.DataFrame(rows, columns=["condition", "method", "over", "evaluations"])
    runs["repeat"] = runs.groupby(["condition", "method"]).cumcount()
    runs["id"] = runs["condition"] + "/" + runs["method"] + "/" + runs["repeat"].map(str)
    runs["feasible"] = runs["over"].notna()
    # A path that is not certified can be as short as it likes.
    runs = runs.assign(
        bound=10.0,
        length=10 * runs["over"].fillna(0.5),
        cpu_s=runs["evaluations"] / 100,
        experiment="e",
        problem=runs["condition"],
    )
    return Results(runs, {}, pd.DataFrame())


TWO = results(
    [
        *[
            ("p", "good", 1.005, 100),
            ("p", "good", 1.03, 200),
            ("p", "good", None, 300),
            ("p", "good", 1.2, 400),
        ],
        *[("p", "bad", None, 50), ("p", "bad", 1.5, 50)],
        *[("q", "good", 1.0, 10), ("q", "good", 1.0, 10)],
        *[("q", "bad", 1.04, 20), ("q", "bad", 1.04, 20)],
    ]
)


def value(metric, condition, method):
    runs = TWO.runs
    own = metrics.values(runs, metric, {})[
        (runs["condition"] == condition) & (runs["method"] == method)
    ]
    assert own.nunique() == 1, "it belongs to all runs of a method"
    return own.iloc[0]


@pytest.mark.parametrize(
    ("percent", "good", "bad"),
    [
        (1, 1000 / 1, math.inf),
        (2, 1000 / 1, math.inf),
        (5, 1000 / 2, math.inf),
        (10, 1000 / 2, math.inf),
    ],
)
def test_work_of_all_runs_over_those_that_get_there(percent, good, bad):
    """Also of those that do not: 100 + 200 + 300 + 400 evaluations, of which one or two are
    enough.
    """
    assert value(f"evaluations_to_{percent}pct", "p", "good") == good
    assert value(f"evaluations_to_{percent}pct", "p", "bad") == bad
    assert value(f"cpu_s_to_{percent}pct", "p", "good") == pytest.approx(good / 100)
    assert value(f"evaluations_to_{percent}pct", "q", "good") == 10


def test_a_path_that_is_not_certified_solves_nothing_however_short():
    runs = TWO.runs
    assert running_time.solves(runs, 10.0).tolist() == runs["feasible"].tolist()
    lengths = metrics.values(runs, "certified_length", {})
    assert np.isinf(lengths[~runs["feasible"]]).all()
    assert (lengths[runs["feasible"]] == runs["length"][runs["feasible"]]).all()


@given(st.floats(0.05, 1), st.integers(0, 2**32 - 1))
def test_restarts_cost_what_is_expected(chance, seed):
    """Restarts until a success: the mean work of many is that of all their runs over their number,
    by the definition.
    """
    rng = np.random.default_rng(seed)
    work, done, spent, restarts = rng.uniform(1, 9, 400), rng.random(400) < chance, 0.0, []
    for each, got in zip(work, done):
        spent += each
        if got:
            restarts.append(spent)
            spent = 0.0
    found = running_time.expected(work.sum() - spent, done.sum())
    assert found == pytest.approx(np.mean(restarts)) if restarts else math.isinf(found)


def profile(**options):
    frame = performance_profile.data(TWO, options_of(performance_profile, **options))
    return {
        method: list(zip(own["ratio"], own["share"])) for method, own in frame.groupby("method")
    }, frame.set_index("method")


def test_profile_of_lengths_counts_the_median_run():
    """On p the lower medians are 10.3 and 15, on q 10 and 10.4."""
    steps, counts = profile(cost="length")
    assert steps["good"] == [(1.0, 1.0)]
    assert steps["bad"] == [pytest.approx((1.04, 0.5)), pytest.approx((15 / 10.3, 1.0))]
    assert counts["solved"].unique().tolist() == counts["problems"].unique().tolist() == [2]


def test_profile_of_work_leaves_out_what_a_method_never_solves():
    steps, counts = profile(cost="evaluations", within=0.05)
    assert steps["good"] == [(1.0, 1.0)]
    assert steps["bad"] == [(2.0, 0.5)]
    assert counts.loc["bad", "reached"] == 1
    steps, counts = profile(cost="cpu_s", within=1e-9)
    assert steps == {"good": [(1.0, 0.5)], "bad": [(1.0, 0.0)]}
    assert counts["solved"].unique().tolist() == [1], "no method solves p"


@given(
    st.lists(
        st.lists(st.one_of(st.just(math.inf), st.floats(0.01, 100)), min_size=3, max_size=3),
        min_size=1,
        max_size=8,
    )
)
def test_the_best_of_each_solved_problem_has_the_ratio_1(rows):
    found = running_time.ratios(pd.DataFrame(rows, columns=list("abc"))).to_numpy()
    values = np.array(rows)
    solved = np.isfinite(values).any(axis=1)
    assert (found[solved].min(axis=1) == 1).all()
    assert np.isinf(found[~solved]).all()
    assert (np.isinf(found) == np.isinf(values)).all()


def test_methods_need_shared_problems():
    part = TWO._replace(
        runs=TWO.runs[(TWO.runs["method"] == "good") | (TWO.runs["condition"] == "p")]
    )
    for panel, more in ((performance_profile, {"within": 0.05}), (expected_running_time, {})):
        with pytest.raises(ValueError, match="bad has no run under q"):
            panel.data(part, options_of(panel, cost="evaluations", **more))


def test_expected_running_times_of_one_problem_and_of_several():
    frame = expected_running_time.data(
        TWO, options_of(expected_running_time, cost="evaluations")
    ).set_index(["method", "within"])
    row = frame.loc["good", 0.05]
    assert (row["value"], row["problems"], row["reached"], row["runs"], row["successes"]) == (
        10,
        2,
        2,
        6,
        4,
    ), "the lower of 500 and 10"
    assert frame.loc[("bad", 0.05), "reached"] == 1
    assert frame.loc[("bad", 0.01), "value"] == math.inf
    of_p = TWO._replace(runs=TWO.runs[TWO.runs["condition"] == "p"])
    row = (
        expected_running_time.data(of_p, options_of(expected_running_time, cost="evaluations"))
        .set_index(["method", "within"])
        .loc["good", 0.05]
    )
    assert (row["value"], row["runs"], row["successes"]) == (500, 4, 2)
    assert row["low95"] <= 250 <= 500 < row["high95"]


def test_intervals_cover_what_many_runs_give():
    """Of experiments with 100 runs, which succeed 3 times in 10, about 95 in 100 intervals hold 1 /
    0.3.
    """
    rng, held = np.random.default_rng(1), 0
    for _ in range(200):
        done = rng.random(100) < 0.3
        low, high = expected_running_time._interval([(np.ones(100), done)], np.array([1.0]), rng)
        held += low <= 1 / 0.3 <= high
    assert 180 <= held <= 199


def test_ranks_over_problems_are_those_of_the_median_run():
    rows = [
        (f"p{k}", name, over, 1)
        for k in range(5)
        for name, overs in {"a": (1.1, 3, 1.1), "b": (1.2, 1.2, 1), "c": (None, None, 1)}.items()
        for over in overs
    ]
    frame = critical_difference.data(
        results(rows), options_of(critical_difference, metric="certified_length", unit="problem")
    )
    ranks = frame[frame["part"] == "rank"].set_index("method")["value"]
    assert ranks.to_dict() == {"a": 1, "b": 2, "c": 3}
    assert frame["units"].unique().tolist() == [5]
