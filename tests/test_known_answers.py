"""Known answers: for each kind of claim, number and measure, runs whose answer is known in closed
form, on both sides of a margin.
"""

import math
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from studies import study
from test_claims import (
    ALL,
    LOWER,
    SHARE,
    TREND,
    WITHIN,
    judge,
    judged,
    sample,
    table,
)

from bezierplan.analysis import measures
from bezierplan.analysis.claims import effects
from bezierplan.analysis.numbers import comparison
from bezierplan.analysis.statistics import LEAST_RUNS
from bezierplan.planners import warm_swarm
from bezierplan.running import drives
from bezierplan.running.simulation import motion_check
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Path, Problem
from bezierplan.workspaces.worlds import MovingCircles

# --------------------------------------------------------------------------------------------------
# Claims


def mark(check: dict, runs: pd.DataFrame, **material) -> str:
    """The mark of a claim's only comparison, by itself."""
    return judge({"checks": [check]}, runs, **material)[1].iloc[0]["mark"]


def apart(difference: float, n: int = 40, std: float = 0.002, at: float = 0.0) -> pd.DataFrame:
    """Runs of a, whose values are those of b and a difference."""
    b = at + sample("b", std=std, n=n)
    return table({"a": b + difference, "b": b})


@pytest.mark.parametrize("statistic", ["rank", "mean", "median"])
@pytest.mark.parametrize("paired", [True, False])
@pytest.mark.parametrize(
    ("difference", "expected"),
    [(-0.31, "+"), (-0.2995, "?"), (-0.29, "0"), (0.29, "0"), (0.2995, "?"), (0.31, "-")],
)
def test_a_difference_counts_from_the_margin_on(statistic, paired, difference, expected):
    check = LOWER | {"statistic": statistic, "margin": 0.3, "paired": paired}
    if paired and expected == "?":
        expected = "0"  # pairs have no spread, so that the interval lies within the margin
    assert mark(check, apart(difference)) == expected


def test_a_sentence_about_single_runs_holds_in_as_many_as_our_runs_say():
    runs = table({"a": np.where(np.arange(200) < 140, 1.0, 3.0), "b": np.full(200, 2.0)})
    _, checks = judge({"checks": [LOWER | {"statistic": "min"}]}, runs, repeats={"tried": 1})
    row = checks.iloc[0]
    assert row["mark"] == "?"
    assert float(row["reason"].split()[2]) == pytest.approx(70, abs=3)


@pytest.mark.parametrize(
    ("printed", "size", "expected"),
    [(10.5, 10, True), (10.6, 10, False), (-0.5, 10, True), (-0.6, 10, False), (1e6, None, True)],
)
def test_a_count_can_be_none_to_all_of_the_runs_but_for_its_rounding(printed, size, expected):
    row = {"least": 5.0, "most": 6.0, "statistic": "count", "decimals": 0}
    assert comparison.is_possible(row | {"value_published": printed}, size) == expected


@pytest.mark.parametrize(
    ("difference", "expected"), [(-1.01, "+"), (-0.99, "-"), (0.99, "-"), (-2.0, "+")]
)
def test_a_claimed_least_effect_is_met_from_itself_on(difference, expected):
    assert mark(LOWER | {"least": 1, "margin": 1e-3}, apart(difference)) == expected


@pytest.mark.parametrize(
    ("share", "expected"), [(-0.11, "+"), (-0.09, "0"), (0.09, "0"), (0.11, "-")]
)
def test_a_relative_difference_is_a_share_of_the_other_group_s_value(share, expected):
    check = LOWER | {"scale": "relative", "margin": 0.1, "statistic": "mean"}
    assert mark(check, apart(200 * share, at=200)) == expected


def steady(slope: float, n: int) -> pd.DataFrame:
    """Runs that rise with x by the same slope in each unit: by 45 times it from the lowest to the
    highest x.
    """
    own = sample("units", n=n)
    return pd.concat(
        [table({"plain": 100 + slope * x + own}, particles=x) for x in (5, 10, 20, 30, 50)]
    )


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(
    ("change", "n", "expected"), [(5.01, 40, "+"), (4.99, 40, "?"), (4.99, 60, "0"), (5.01, 5, "?")]
)
def test_a_trend_counts_from_the_margin_on(direction, change, n, expected):
    """Identical units show that a change is less only if they are 59 or more."""
    expected = {"+": "-"}.get(expected, expected) if direction < 0 else expected
    assert mark(TREND, steady(direction * change / 45, n)) == expected
    row = judged(TREND, steady(direction * change / 45, n))
    assert (
        np.isnan(row["effect"])
        if n < LEAST_RUNS
        else row["effect"] == pytest.approx(direction * change)
    )


@pytest.mark.parametrize(
    ("difference", "expected"), [(0.99, "+"), (1.01, "-"), (-0.99, "+"), (-1.01, "-")]
)
@pytest.mark.parametrize("target", [0.0, -3.0])
def test_groups_are_alike_within_the_margin_of_the_target(difference, target, expected):
    check = WITHIN | {"target": target, "margin": 1.0}
    assert mark(check, apart(target + difference)) == expected


@pytest.mark.parametrize("side", [1, -1])
def test_a_difference_just_beyond_the_margin_needs_runs_that_scatter_less(side):
    """Its standard error is a ninth of the margin, then a hundredth."""
    check = WITHIN | {"target": 0.0, "margin": 1.0}
    assert mark(check, apart(side * 1.1, std=0.5)) == "?"
    assert mark(check, apart(side * 1.1, std=0.05)) == "-"


def events(k: int, n: int) -> pd.DataFrame:
    """Runs of which k have the event."""
    return table({"a": np.where(np.arange(n) < k, -1.0, 1.0)})


@pytest.mark.parametrize(("k", "expected"), [(13, "-"), (14, "?"), (26, "?"), (27, "+")])
def test_a_share_of_a_half_by_the_binomial_distribution(k, expected):
    row = judged(SHARE, events(k, 40))
    tail = sum(math.comb(40, each) for each in range(max(k, 40 - k), 41)) / 2**40
    assert row["p"] == pytest.approx(2 * tail)
    assert mark(SHARE, events(k, 40)) == expected
    opposite = {"+": "-", "-": "+"}.get(expected, expected)
    assert mark(SHARE | {"direction": "at_most"}, events(k, 40)) == opposite


# All of n are known to hold in more than 0.025 ** (1 / n) of all runs; ten in ten then have more
# than that to the tenth as their chance. None of n, in less than 1 - 0.025 ** (1 / n).
@pytest.mark.parametrize(
    ("k", "n", "repeats", "expected"),
    [
        *((13, 13, 10, "+"), (12, 12, 10, "?"), (0, 3, 10, "-"), (0, 2, 10, "?")),
        *((59, 59, None, "+"), (58, 58, None, "?"), (58, 59, None, "-")),
    ],
)
def test_as_printed_by_the_chance_of_the_paper_s_runs(k, n, repeats, expected):
    """Without their number, by a counterexample."""
    known = {"tried": repeats} if repeats else {}
    check = ALL | {"threshold": "as printed"}
    assert mark(check, events(k, n), repeats=known) == expected


@pytest.mark.parametrize(
    ("event", "expected"), [("below", "-"), ("at_most", "+"), ("above", "-"), ("at_least", "+")]
)
def test_an_event_at_its_limit(event, expected):
    assert mark(SHARE | {"event": {event: 1}}, table({"a": np.ones(40)})) == expected


@pytest.mark.parametrize(
    ("share", "expected"), [(0.95, "+"), (0.949, "?"), (0.5, "?"), (0.051, "?"), (0.05, "-")]
)
def test_a_sentence_about_extremes_holds_in_19_of_20_draws(share, expected):
    assert effects.mark_share(share) == expected


def test_p_and_interval_of_draws():
    draws = np.repeat([-1.0, 0.0, 1.0], [2, 1, 97])
    assert effects.compute_p(draws) == pytest.approx(2 * 3 / 100)
    assert effects.compute_p(-draws) == pytest.approx(2 * 3 / 100)
    assert effects.compute_p(np.array([-1.0, 0.0, 1.0])) == 1.0
    assert effects.compute_interval_of_draws(np.arange(1001.0)) == (25.0, 975.0)


@pytest.mark.parametrize(
    ("low", "high", "n", "negligible"),
    [
        *((-1.0, 1.0, 6, True), (-1.0, 1.01, 6, False), (-1.01, 1.0, 6, False)),
        *((0.5, 0.5, 59, True), (0.5, 0.5, 58, False)),
    ],
)
def test_an_interval_is_negligible_within_the_margin(low, high, n, negligible):
    assert effects.is_negligible(low, high, 1.0, n) == negligible
    assert effects.is_negligible(low + 3, high + 3, 1.0, n, 3.0) == negligible


@pytest.mark.parametrize("n", [LEAST_RUNS - 1, LEAST_RUNS])
def test_six_units_are_enough(n):
    said = judge({"checks": [LOWER | {"margin": 0.1}]}, apart(-1.0, n=n))[1].iloc[0]
    assert (said["mark"] == "+", "fewer than" in said["reason"]) == (n == 6, n == 5)


# --------------------------------------------------------------------------------------------------
# Numbers


@pytest.mark.parametrize(
    ("statistic", "published", "possible"),
    [
        *(("count", 20, True), ("count", 21, False), ("count", -1, False)),
        *(("share", 1.0, True), ("share", 1.1, False), ("share", -0.1, False)),
        *(("std", 0.0, True), ("std", -0.1, False), ("std", 99.0, True)),
        *(("mean", 5.0, True), ("mean", 4.96, True), ("mean", 4.94, False), ("mean", 9.06, False)),
    ],
)
def test_a_printed_number_is_possible_within_the_range_of_its_statistic(
    statistic, published, possible
):
    """Of twenty runs with values from 5 to 9; the mean is printed with one decimal."""
    row = {"statistic": statistic, "value_published": published, "least": 5.0, "most": 9.0}
    row |= {"decimals": 1 if statistic == "mean" else 6, "bound": 0.0, "metric": "objective"}
    assert comparison.is_possible(row, 20) == possible


@pytest.mark.parametrize(
    ("found", "ours", "decimals", "shown", "below", "above"),
    [
        ((14.6, 31.4), 20.0, 0, (15, 31), 14, 32),
        ((14.5, 31.5), 20.0, 0, (14, 32), 13, 33),  # what lies half a unit away belongs to it
        ((10.0, 10.0), 10.0, 3, (9.99, 10.01), 9.989, 10.011),  # 0.1 % of ours to each side
        ((32.3848, 32.3848), 32.3848, 4, (32.3524, 32.4172), 32.35, 32.42),
        ((-math.inf, 3.0), 2.0, 1, (-math.inf, 3.0), -math.inf, 3.1),
    ],
)
def test_a_printed_number_has_a_position(found, ours, decimals, shown, below, above):
    low, high = comparison.round_range(found, ours, decimals)
    assert (low, high) == pytest.approx(shown)
    assert comparison.find_position(above, low, high) == "above"
    assert (
        comparison.find_position(low, low, high)
        == comparison.find_position(high, low, high)
        == "inside"
    )
    assert below == low or comparison.find_position(below, low, high) == "below"
    assert comparison.find_position(ours, math.nan, math.nan) == comparison.NO_RANGE


# --------------------------------------------------------------------------------------------------
# Measures


def test_near_the_shortest_within_a_quarter():
    runs = pd.DataFrame(
        {"length": [12.5, 12.6, 10.0], "bound": 10.0, "feasible": [True, True, False]}
    )
    assert measures.is_near_shortest(0.25, runs, {}).tolist() == [True, False, False]


@pytest.mark.parametrize(("turn", "corners"), [(2e-6, 1), (0.5e-6, 0), (math.pi / 2, 1)])
def test_a_corner_turns_by_more_than_a_millionth(turn, corners):
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1 + math.cos(turn), math.sin(turn)]])
    path = Path("polyline", points)
    assert measures.corners(path) == corners
    assert measures.turning(path) == pytest.approx(turn)


def test_a_reference_below_the_exact_length_is_told_with_its_problem():
    runs = pd.DataFrame({"problem": ["a", "b"], "reference": [2.0, 0.9], "bound": [1.0, 1.0]})
    assert measures.read_reference(runs[:1]).tolist() == [2.0]
    with pytest.raises(ValueError, match=r"^problem b: reference 0\.9 lies below"):
        measures.read_reference(runs)


# --------------------------------------------------------------------------------------------------
# Drives


def test_times_of_plans_after_the_first():
    """Mean, 95th percentile, and largest."""
    plans = [SimpleNamespace(seconds=seconds) for seconds in (9.0, 0.1, 0.1, 0.5, 0.6)]
    found = drives.replan_times(SimpleNamespace(plans=plans))
    assert found == pytest.approx((0.325, 0.585, 0.6))


@pytest.mark.parametrize("beyond", [0.25, 1e-3, 2e-9])
@pytest.mark.parametrize("turned", range(4))
def test_a_drive_out_of_the_field_is_as_deep_as_it_is_far_out(beyond, turned):
    field = (0.0, 20.0, 0.0, 20.0)
    nothing = np.zeros((0, 2))
    world = MovingCircles(field, field, nothing, nothing, np.zeros(0), "circles", 1.0, 60, "m")
    points = np.array([[1.0, 9.0], [20.0 + beyond, 9.0], [1.0, 9.0]])
    for _ in range(turned):
        points = np.stack([20.0 - points[:, 1], points[:, 0]], axis=1)
    verdict = motion_check.check(Motion(points, np.array([0.0, 19.0 + beyond, 40.0])), world)
    assert verdict.depth == pytest.approx(beyond, rel=1e-5)
    assert verdict.collision_at == pytest.approx(19.0 + beyond)


def test_a_warm_start_begins_at_the_known_path():
    """Whatever random numbers the rest of the swarm has."""
    settings = study("tharwat2018").resolve_settings("swarm_warm")
    world = Circles((0.0, 20.0, 0.0, 20.0), np.array([[10.0, 10.0]]), np.array([2.0]), "m")
    problem = Problem("one", world, (2.0, 10.0), (18.0, 10.0))
    first, known = warm_swarm.resume(problem, np.random.default_rng(1), None, **settings)
    assert first.claimed_feasible
    for seed in range(5):
        again, _ = warm_swarm.resume(problem, np.random.default_rng(seed), known, **settings)
        assert again.history[0] <= first.objective + 1e-9
    cold = warm_swarm.plan(problem, np.random.default_rng(2), **settings)
    assert cold.history[0] > first.objective
