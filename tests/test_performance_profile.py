"""Performance profiles, paths near the exact shortest one and mean ranks over problems: small
tables whose answers can be counted.
"""

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from panels import options_of

from bezierplan.analysis import metrics
from bezierplan.analysis.results import Results
from bezierplan.figures.panels import critical_difference, performance_profile


def results(rows) -> Results:
    """Runs (problem, method, length over the bound or None for a path that is not certified),
    numbered within each method.
    """
    runs = pd.DataFrame(rows, columns=["condition", "method", "over"])
    runs["repeat"] = runs.groupby(["condition", "method"]).cumcount()
    runs["id"] = runs["condition"] + "/" + runs["method"] + "/" + runs["repeat"].map(str)
    runs["feasible"] = runs["over"].notna()
    # A path that is not certified can be as short as it likes.
    runs = runs.assign(
        bound=10.0,
        length=10 * runs["over"].fillna(0.5),
        experiment="e",
        problem=runs["condition"],
    )
    return Results(runs, {}, pd.DataFrame())


TWO = results(
    [
        *[("p", "good", over) for over in (1.005, 1.03, None, 1.2)],
        *[("p", "bad", over) for over in (None, 1.5)],
        *[("q", "good", 1.0)] * 2,
        *[("q", "bad", 1.04)] * 2,
    ]
)


def test_a_path_that_is_not_certified_solves_nothing_however_short():
    runs = TWO.runs
    near = {percent: metrics.values(runs, f"within_{percent}pct", {}).sum() for percent in (1, 5)}
    assert near == {1: 3, 5: 6}
    lengths = metrics.values(runs, "certified_length", {})
    assert np.isinf(lengths[~runs["feasible"]]).all()
    assert (lengths[runs["feasible"]] == runs["length"][runs["feasible"]]).all()


def test_a_profile_counts_the_median_run():
    """On p the lower medians are 10.3 and 15, on q 10 and 10.4."""
    frame = performance_profile.data(TWO, options_of(performance_profile))
    steps = {
        method: list(zip(own["ratio"], own["share"])) for method, own in frame.groupby("method")
    }
    assert steps["good"] == [(1.0, 1.0)]
    assert steps["bad"] == [pytest.approx((1.04, 0.5)), pytest.approx((15 / 10.3, 1.0))]
    assert frame["solved"].unique().tolist() == frame["problems"].unique().tolist() == [2]


def test_a_profile_leaves_out_what_a_method_never_solves():
    never = [
        *[("p", name, None) for name in ("good", "bad")],
        ("q", "good", 1.0),
        ("q", "bad", None),
    ]
    frame = performance_profile.data(results(never), options_of(performance_profile))
    assert frame.set_index("method")[["ratio", "share", "reached", "solved"]].to_dict("index") == {
        "good": {"ratio": 1.0, "share": 0.5, "reached": 1, "solved": 1},
        "bad": {"ratio": 1.0, "share": 0.0, "reached": 0, "solved": 1},
    }, "no method solves p"


@given(
    st.lists(
        st.lists(st.one_of(st.just(math.inf), st.floats(0.01, 100)), min_size=3, max_size=3),
        min_size=1,
        max_size=8,
    )
)
def test_the_best_of_each_solved_problem_has_the_ratio_1(rows):
    found = performance_profile.ratios(pd.DataFrame(rows, columns=list("abc"))).to_numpy()
    values = np.array(rows)
    solved = np.isfinite(values).any(axis=1)
    assert (found[solved].min(axis=1) == 1).all()
    assert np.isinf(found[~solved]).all()
    assert (np.isinf(found) == np.isinf(values)).all()


def test_methods_need_shared_problems():
    part = TWO._replace(
        runs=TWO.runs[(TWO.runs["method"] == "good") | (TWO.runs["condition"] == "p")]
    )
    with pytest.raises(ValueError, match="bad has no run under q"):
        performance_profile.data(part, options_of(performance_profile))


def test_ranks_over_problems_are_those_of_the_median_run():
    rows = [
        (f"p{k}", name, over)
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
