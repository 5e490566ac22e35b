"""Statistics, bootstrap intervals, and prediction intervals: closed forms, and how often they are
right on known distributions.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezierplan.analysis import statistics
from bezierplan.analysis.statistics import (
    LEAST_RUNS,
    STATISTICS,
    compute_interval,
    compute_prediction_interval,
    compute_statistic,
    draw_predictions,
    resample,
    scale_statistic,
)
from bezierplan.workspaces.seeds import generator

samples = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=30).map(np.array)


@pytest.fixture(scope="module", autouse=True)
def few_draws():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(statistics, "DRAWS", 1000)
        yield


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("mean", 4.0),
        ("unstated", 3.0),
        ("std", math.sqrt(50 / 4)),
        ("iqr", 2.0),
        ("range", 9.0),
        ("min", 1.0),
        ("max", 10.0),
    ],
)
def test_worked_example(name, expected):
    assert compute_statistic(name, np.array([10.0, 1.0, 3.0, 4.0, 2.0])) == pytest.approx(expected)


@pytest.mark.parametrize("name", STATISTICS)
def test_no_values_give_no_number(name):
    assert math.isnan(compute_statistic(name, np.array([])))


def test_one_value_has_no_standard_deviation():
    assert math.isnan(compute_statistic("std", np.array([2.0])))


@given(samples)
def test_quantiles_are_those_of_numpy(values):
    for name, share in [("quartile1", 0.25), ("median", 0.5), ("quartile3", 0.75)]:
        assert compute_statistic(name, values) == pytest.approx(
            np.quantile(values, share), rel=1e-12, abs=1e-9
        )


@pytest.mark.parametrize("name", STATISTICS)
def test_rows_are_taken_one_by_one(name):
    values = np.random.default_rng(0).random((4, 7))
    assert STATISTICS[name](values) == pytest.approx(
        [compute_statistic(name, row) for row in values]
    )


@pytest.mark.parametrize(("count", "tolerance"), [(100, 0.1), (1000, 0.01)])
def test_both_ends_of_the_interval_of_a_mean_are_1_96_standard_errors_away(count, tolerance):
    values = np.random.default_rng(9).normal(5, 2, count)
    ends = np.array(compute_interval("mean", values, generator("both ends"))) - values.mean()
    error = values.std(ddof=1) / math.sqrt(count)
    assert ends / error == pytest.approx([-1.96, 1.96], rel=tolerance)


@pytest.mark.parametrize("name", sorted(set(STATISTICS) - set(statistics.WITHOUT_INTERVAL)))
def test_interval_of_many_values_is_nearly_that_of_the_bootstrap(name, monkeypatch):
    values = np.random.default_rng(7).gamma(4, size=400)
    values = (values > 3).astype(float) if name in ("count", "share") else values
    low, high = compute_interval(name, values, generator("many"))
    monkeypatch.setattr(statistics, "MOST_RESAMPLED", 1000)
    assert (low, high) == pytest.approx(
        compute_interval(name, values, generator("many")), abs=0.2 * (high - low)
    )
    assert low < compute_statistic(name, values) < high


def test_interval_of_many_values_with_infinite_ones_is_resampled():
    values = np.append(np.random.default_rng(8).normal(size=400), math.inf)
    assert all(map(math.isfinite, compute_interval("median", values, generator("infinite"))))


@pytest.mark.parametrize(
    ("name", "count"), [("mean", 0), ("mean", 1), ("min", 10), ("max", 10), ("range", 10)]
)
def test_interval_is_empty_where_it_would_say_nothing(name, count):
    assert all(
        math.isnan(end) for end in compute_interval(name, np.arange(float(count)), generator("a"))
    )


@given(
    st.floats(-1e6, 1e6),
    st.integers(1, 30),
    st.integers(1, 30),
    st.sampled_from(sorted(STATISTICS)),
)
def test_draws_from_equal_values_are_the_statistic_of_as_many(value, runs, size, name):
    drawn = resample(name, np.full(runs, value), size, generator("equal"))
    assert drawn.shape == (statistics.DRAWS,)
    assert np.array_equal(
        drawn,
        np.full(statistics.DRAWS, compute_statistic(name, np.full(size, value))),
        equal_nan=True,
    )


OURS = np.random.default_rng(3).normal(100, 5, size=60)


def inside(published, low_high):
    return low_high[0] <= published <= low_high[1]


@pytest.mark.parametrize(("factor", "fits"), [(0.4, False), (1.0, True), (2.5, False)])
def test_standard_deviation_far_off_is_refused(factor, fits):
    printed = factor * compute_statistic("std", OURS)
    assert inside(printed, compute_prediction_interval("std", OURS, 30, generator("far"))) == fits


@pytest.mark.parametrize("values", [np.array([]), OURS[: LEAST_RUNS - 1]])
def test_too_few_runs_have_no_range(values):
    assert np.isnan(compute_prediction_interval("mean", values, 10, generator("few"))).all()


def _drawn(name: str, size: int, rng: np.random.Generator) -> np.ndarray:
    """Truths for counts and shares, else skewed numbers."""
    return (
        (rng.random(size) < 0.85).astype(float)
        if name in ("count", "share")
        else rng.gamma(5, size=size)
    )


@pytest.mark.parametrize(
    ("name", "shape", "most"),
    [
        *((name, "", 0.08) for name in ("mean", "median", "min", "max", "count", "share")),
        # Draws from resamples would refuse up to a quarter of a normal sample's, more of others'.
        *(("std", "normal", 0.08), ("std", "", 0.12), ("std", "exponential", 0.2)),
    ],
)
@pytest.mark.parametrize(("ours", "theirs"), [(10, 10), (30, 30), (10, 40), (200, 10)])
def test_prediction_refuses_few_true_numbers(name, shape, most, ours, theirs):
    rng = np.random.default_rng(9)
    refused = 0
    for repeat in range(400):
        values, others = (
            getattr(rng, shape)(size=size) if shape else _drawn(name, size, rng)
            for size in (ours, theirs)
        )
        found = compute_prediction_interval(name, values, theirs, generator(f"true {repeat}"))
        refused += not inside(compute_statistic(name, others), found)
    assert refused / 400 <= most


def test_predicted_mean_has_the_error_of_both_samples():
    values = np.random.default_rng(1).normal(size=50)
    drawn = draw_predictions("mean", values, 20, generator("both"))
    assert drawn.shape == (statistics.DRAWS,)
    assert drawn.std() == pytest.approx(values.std() * math.sqrt(1 / 20 + 1 / 50), rel=0.08)


def test_counts_and_extremes_are_scaled_to_the_size_of_the_experiment():
    events = np.array([1.0, 0.0] * 20)
    assert scale_statistic("count", events, 40, 10) == 5.0
    assert scale_statistic("count", events, 80, 10) == 2.5, "runs without a value are runs as well"
    values = np.arange(1.0, 1001.0)
    # The median of the least of n uniform values is 1 - 2 ** (-1 / n).
    assert scale_statistic("min", values, 1000, 10) == pytest.approx(1000 * (1 - 2**-0.1), abs=2)
    assert scale_statistic("max", values, 1000, 10) == pytest.approx(1000 * 2**-0.1, abs=2)


@pytest.mark.parametrize("name", ["mean", "median", "std", "share"])
def test_other_statistics_are_not_scaled(name):
    values = np.arange(1.0, 12.0)
    assert scale_statistic(name, values, 11, 3) == compute_statistic(name, values)


def test_what_our_values_do_not_determine_is_not_scaled():
    values = np.arange(1.0, 6.0)
    assert scale_statistic("min", values, 5, 100) == 1.0
    assert scale_statistic("min", values, 5, None) == 1.0
    assert math.isnan(scale_statistic("count", np.empty(0), 5, 3))


def test_predictions_within_groups_are_right_as_often_as_stated():
    """A layout's own mean is normal, its runs are normal around it: 95 % of new experiments lie
    within the prediction interval.
    """
    rng = generator("groups")
    held = []
    for _ in range(500):
        groups = [rng.normal(centre, 1.0, 10) for centre in rng.normal(0.0, 2.0, 50)]
        new = rng.normal(rng.normal(0.0, 2.0), 1.0, 10).mean()
        held.append(
            inside(
                new,
                compute_prediction_interval("mean", np.concatenate(groups), 10, rng, groups=groups),
            )
        )
    assert 0.92 <= np.mean(held) <= 0.98


def test_a_quantiles_influence_is_a_worked_example():
    """Of 0 to 100, the 95 % interval of the median has its ends 0.098 away in share and 9.8 in
    value. Cubed, because the slope of squares around their middle is the same over every interval.
    """
    values = np.arange(101.0) ** 3
    reach = 1.96 * 0.5 / math.sqrt(101)
    low, high = np.quantile(values, [0.5 - reach, 0.5 + reach])
    slope = (high - low) / (2 * reach)
    found = statistics.compute_influence("median", values)
    assert found[[0, 50, 51, 100]] == pytest.approx(
        [-0.5 * slope, -0.5 * slope, 0.5 * slope, 0.5 * slope]
    )


def test_a_predicted_share_is_drawn_from_jeffreys_posterior():
    """Of 0 true values in 3, the mean share is that of Beta(0.5, 3.5): 1 in 8; a uniform prior
    would say 1 in 5.
    """
    found = draw_predictions("share", np.zeros(3, dtype=bool), 1000, generator("prior"))
    assert found.mean() == pytest.approx(0.125, abs=0.02)
