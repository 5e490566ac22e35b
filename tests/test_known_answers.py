"""Known answers: for each kind of claim and measure, runs whose answer is known in closed
form, on both sides of a margin.
"""

import math
from pathlib import Path as File
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
    comparisons_of,
    judged,
    marks,
    sample,
    table,
)

from bezierplan.analysis import measures
from bezierplan.analysis.claims import effects
from bezierplan.analysis.statistics import LEAST_RUNS
from bezierplan.planners import warm_swarm
from bezierplan.running import drives
from bezierplan.running.simulation import motion_check
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.robot import DrivePlan, Ride
from bezierplan.schema import checked
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Path, Problem
from bezierplan.workspaces.worlds import MovingCircles

# --------------------------------------------------------------------------------------------------
# Claims


def mark(check: dict, runs: pd.DataFrame, **material) -> str:
    """The mark of a claim's only comparison, by itself."""
    return marks(check, runs, **material)[0]


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


@pytest.mark.parametrize(("failed", "repeats", "held"), [(0, 1, 70), (200, 2, 70), (200, 8, 99.2)])
def test_a_sentence_about_few_runs_holds_in_as_many_as_our_runs_say(failed, repeats, held):
    """In the paper as many fail as of ours: of two runs one counts, of eight four do."""
    values = np.r_[np.where(np.arange(200) < 140, 1.0, 3.0), np.full(failed, math.nan)]
    runs = table({"a": values, "b": np.full(len(values), 2.0)})
    check = LOWER | {"statistic": "min"}
    row = comparisons_of(check, runs, repeats={"tried": repeats}).iloc[0]
    assert float(row["reason"].split()[2]) == pytest.approx(held, abs=3 if held < 90 else 0.6)


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
    said = comparisons_of(LOWER | {"margin": 0.1}, apart(-1.0, n=n)).iloc[0]
    assert (said["mark"] == "+", "fewer than" in said["reason"]) == (n == 6, n == 5)


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
    """By more than print may round."""
    runs = pd.DataFrame({"problem": ["a", "b"], "reference": [0.991, 0.989], "bound": 1.0})
    assert measures.read_reference(runs[:1]).tolist() == [0.991]
    with pytest.raises(ValueError, match=r"^problem b: reference 0\.989 lies below"):
        measures.read_reference(runs)


# --------------------------------------------------------------------------------------------------
# Drives

DRIVEN = checked.read(File(__file__).parent / "data" / "drives.yaml")["columns"]


def test_times_of_plans_after_the_first():
    """Mean, 95th percentile, and largest."""
    plans = [SimpleNamespace(seconds=seconds) for seconds in (9.0, 0.1, 0.1, 0.5, 0.6)]
    found = drives.replan_times(SimpleNamespace(plans=plans))
    assert found == pytest.approx((0.325, 0.585, 0.6))


@pytest.mark.parametrize("radius", DRIVEN)
def test_columns_of_a_drive_in_closed_form(radius):
    """It drives 6, waits a step and a half, plans again, and drives 10 at the pace of 2, past a
    circle 3 beside its way.
    """
    field, at = (0.0, 20.0, 0.0, 20.0), np.array([[7.0, 13.0]])
    world = MovingCircles(field, field, at, 0 * at, np.array([radius]), "circles", 2.0, 60, "m")
    points = np.array([[0.0, 10.0], [6.0, 10.0], [6.0, 10.0], [16.0, 10.0]])
    plans = [DrivePlan(0.0, None, 16.5, 0.1, 5), DrivePlan(4.5, None, 10.5, 0.1, 7)]
    ride = Ride(Motion(points, np.array([0.0, 3.0, 4.5, 9.5])), True, 1.5, plans)
    problem = Problem("one", world.workspace(0), (0.0, 10.0), (16.0, 10.0))
    row, trace = drives.judge_drive(ride, True, problem, world)
    assert {key: row[key] for key in DRIVEN[radius]} == pytest.approx(DRIVEN[radius], nan_ok=True)
    assert (row["history"], row["path_points"]) == ([16.5, 16.5], [0, 10, 6, 10, 16, 10])
    assert trace["x"].tolist() == [0, 2, 4, 6, 6, 7, 9, 11, 13, 15, 16]
    assert trace["plan_time"] == [0.0, 4.5]
    late = drives.judge_drive(ride._replace(arrived=False), True, problem, world)[0]
    assert (late["feasible"], late["objective"]) == (False, math.inf)


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
