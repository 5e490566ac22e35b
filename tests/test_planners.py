"""What the planners of the studies have in common: problems without a search, units, the first
generation, and settings that do not fit together.
"""

import math

import numpy as np
import pytest
from fields import on_map
from studies import planned, study

from bezierplan.planners import load_planner, read_settings
from bezierplan.planners.parts.settings import UNITS

# A block between the corners.
CELLS = [*["." * 20] * 8, *["." * 6 + "#" * 8 + "." * 6] * 4, *["." * 20] * 8]
CURVES = [("song2016", "smooth"), ("ma2020", "bca"), ("ma2020", "bca_q"), ("ma2020", "as_printed")]
GRAPHS = [
    *(("elhoseny2017", method) for method in ("mga", "ga", "prm", "abc_ep")),
    *(("ma2020", method) for method in ("aco", "aco_ga", "asfa_ga", "ga", "ga_strong")),
    ("meledje", "proposed"),
]


@pytest.mark.parametrize("method", CURVES + GRAPHS, ids="-".join)
def test_start_equal_to_target_is_answered_without_a_search(method):
    found = planned(*method, on_map("....", "....", target=(0.5, 0.5)))
    assert found.claimed_feasible
    assert found.objective == pytest.approx(0, abs=1e-9)
    assert len(found.history) == 1
    assert np.unique(found.path.points, axis=0).tolist() == [[0.5, 0.5]]


@pytest.mark.parametrize("method", GRAPHS, ids="-".join)
@pytest.mark.parametrize("lines", [("...#.", "...##", "....."), (".#.", "###", ".#.")])
def test_a_sealed_target_is_a_plan_without_a_path(method, lines):
    found = planned(*method, on_map(*lines))
    assert (found.path, found.objective, found.claimed_feasible) == (None, math.inf, False)
    assert found.history.min() == math.inf


@pytest.mark.parametrize("method", CURVES, ids="-".join)
def test_a_curve_to_a_sealed_target_is_said_to_collide(method):
    assert not planned(*method, on_map("...#.", "...##", "....."), generations=9).claimed_feasible


@pytest.mark.parametrize("method", CURVES[:2] + GRAPHS, ids="-".join)
def test_a_map_in_other_units_is_searched_alike(method):
    """Settings that are lengths are in the same units."""
    own = study(method[0])
    declared = read_settings(load_planner(own.planner(method[1])))
    lengths = {
        key: 10 * value
        for key, value in own.resolve_settings(method[1]).items()
        if declared[key].about.unit == UNITS
    }
    one, other = (
        planned(*method, on_map(*CELLS)),
        planned(*method, on_map(*CELLS, cell=10), **lengths),
    )
    assert other.history == pytest.approx(10 * one.history)
    assert other.path.points == pytest.approx(10 * one.path.points)


@pytest.mark.parametrize("method", CURVES[:2] + GRAPHS[1:2] + GRAPHS[7:], ids="-".join)
def test_no_generation_leaves_the_best_of_the_first(method):
    few, more = (planned(*method, on_map(*CELLS), 3, generations=count) for count in (0, 5))
    assert few.history.tolist() == [few.objective] == more.history[:1].tolist()


@pytest.mark.parametrize(
    ("key", "method", "changes", "fault"),
    [
        ("elhoseny2017", "mga", {"population": 61}, "population: 61; parents are crossed in pairs"),
        ("elhoseny2017", "mga", {"first_points": 60}, "first_points: 60; at most 59"),
        ("song2016", "smooth", {"genes": 0}, "genes: 0"),
        ("song2016", "smooth", {"spacing": "arc_length"}, "spacing"),
        ("song2016", "smooth_quadratic", {"samples": 6}, "samples: 6"),
        ("tharwat2018", "ferguson", {"control_points": 3}, "3.*a multiple of 2 more, not 5"),
        ("tharwat2018", "cpso2_singer", {"chaotic_map": "constant"}, "random; a constant map"),
        ("ma2020", "bca", {"population": 21}, "population: 21"),
        ("ma2020", "bca", {"curve": "piecewise_quadratic", "control_points": 0}, "points: 0"),
        ("ma2020", "ga", {"population": 7}, "population: 7; .*even"),
    ],
)
def test_settings_that_do_not_fit_together_are_named(key, method, changes, fault):
    own = study(key)
    with pytest.raises(ValueError, match=fault):
        load_planner(own.planner(method)).check(own.resolve_settings(method) | changes)
