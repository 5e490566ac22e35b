"""Methods on each problem: largest curvature, families, and the rounded path beside them."""

import math

import numpy as np
import pandas as pd
import pytest

import bezierplan as bp
from bezierplan.analysis.columns import COLUMNS_OF
from bezierplan.analysis.numbers import methods
from bezierplan.analysis.results import Results
from bezierplan.geometry.tightest_turn import largest_curvature
from bezierplan.study.experiments import FamilyEntry
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Path, Problem

FIELD = Circles((-10.0, 10.0, -10.0, 10.0), np.array([[0.0, 0.5]]), np.array([2.0]), "m")
BLOCKED = Problem("blocked", FIELD, (-8.0, 0.0), (8.0, 0.0))
FREE = Problem("free", FIELD, (-8.0, -8.0), (8.0, -8.0))
ROUND = [-8.0, 0.0, 0.0, -6.0, 8.0, 0.0]
CORNER = ("polyline", [-8.0, 0.0, 0.0, -4.0, 8.0, 0.0])


def test_the_largest_curvature_of_a_parabola_is_that_of_its_vertex():
    # y = a x**2 over [-2, 5]: 2 a at x = 0.
    for a in (0.1, 3.0, 40.0):
        points = np.array([[-2.0, 4 * a], [1.5, -10 * a], [5.0, 25 * a]])
        assert largest_curvature(Path("bezier", points)) == pytest.approx(2 * a, rel=1e-6)


def test_an_arc_shorter_than_a_step_of_samples_counts():
    # The shorter arc is 1e-5 of its legs.
    for radius in (0.07, 5e-4):
        k = 4 / 3 * math.tan(math.pi / 8)
        arc = radius * np.array([[0.0, 0.0], [k, 0.0], [1.0, 1 - k], [1.0, 1.0]])
        end = (radius, 50.0)
        legs = [np.linspace((-50.0, 0.0), arc[0], 4)[:-1], arc, np.linspace(arc[3], end, 4)[1:]]
        chain = Path("cubic_chain", np.concatenate(legs))
        assert largest_curvature(chain) == pytest.approx(1 / radius, rel=0.02)


def run(problem, method, path, length, feasible=True):
    own = {"problem": problem.name, "condition": problem.name, "method": method, "length": length}
    own |= {"bound": bp.plan(problem, "shortest_path").length, "feasible": feasible}
    own |= {"id": f"{method}/{problem.name}", "cpu_s": 0.002, "evaluations": 7, "planner": method}
    return own | {"path_curve": path[0], "path_points": np.array(path[1])}


@pytest.fixture(scope="module")
def rows():
    curve = "bezier", ROUND
    line = "polyline", [-8.0, -8.0, 8.0, -8.0]
    runs = [
        *(run(BLOCKED, "curved", curve, length) for length in (17.5, 18.0, 20.0)),
        run(BLOCKED, "curved", curve, 1.0, feasible=False),
        run(BLOCKED, "cornered", CORNER, 18.0),
        run(FREE, "curved", line, 16.0),
    ]
    problems = {each.name: each for each in (BLOCKED, FREE)}
    results = Results(pd.DataFrame(runs), problems, pd.DataFrame())
    families = {
        "in the way": FamilyEntry(experiment="field", straight="blocked"),
        "one": FamilyEntry(experiment="field", problems=["free"]),
    }
    return methods.measure_studies({"mine": "curved"}, {"mine": families}, {"mine/field": results})


def test_a_row_for_each_method_and_problem(rows):
    assert [*rows] == COLUMNS_OF["methods"]
    curved, cornered, straight = rows.to_dict("records")
    assert (curved["family"], straight["family"]) == ("in the way", "one")
    assert (curved["straight"], straight["straight"]) == (False, True)
    assert (curved["runs"], curved["free"], curved["round"], curved["cornered"]) == (4, 0.75, 3, 0)
    bound = bp.plan(BLOCKED, "shortest_path").length
    assert curved["excess"] == pytest.approx(18.0 / bound - 1)
    assert curved["excess_low"] <= curved["excess"] <= curved["excess_high"]
    assert (curved["cpu_ms"], curved["evaluations"]) == (pytest.approx(2.0), 7)
    # The path rounded to the curve's own tightest turn, planned apart.
    radius = 1 / largest_curvature(Path("bezier", np.reshape(ROUND, (-1, 2))))
    gentle = bp.plan(BLOCKED, turning_radius=radius)
    assert curved["rounded"] == pytest.approx(gentle.length / bound - 1)
    assert curved["rounded_curvature"] <= 1.03 * curved["curvature"]
    assert (cornered["round"], cornered["cornered"]) == (0, 1)
    assert math.isnan(cornered["curvature"])
    assert math.isnan(cornered["rounded"])
    assert (straight["curvature"], straight["excess"], straight["rounded"]) == (0, 0, 0)


def test_families_stand_worst_first_and_say_where_a_method_adds_something(rows):
    table = methods.group_by_family(rows)
    assert table["method"].tolist()[0] == "curved"
    assert table["free"].tolist() == [0.75, 1.0, 1.0]
    assert table["adds"].sum() == 0
    shorter = rows.assign(excess=rows["rounded"] - 0.01)
    smoother = rows.assign(rounded_curvature=rows["curvature"] * 1.1)
    assert methods.group_by_family(shorter)["adds"].sum() == 2
    equal = rows.assign(excess=rows["rounded"] - 1e-7)
    assert methods.group_by_family(equal)["adds"].sum() == 0, "rounding decides nothing"
    assert methods.group_by_family(smoother)["adds"].sum() == 1
    text = methods.format_table(table, {"mine/curved": "Curves"})
    assert text["scenarios"].tolist() == table["family"].tolist()
    assert text["free paths"].tolist() == ["75 %", "100 %", "100 %"]
    assert text.index[0] == "Curves"


def test_a_family_of_problems_in_closed_form():
    """Of four problems the second is shorter than the rounded path by more than rounding, the third
    turns less tightly by more than 3 %, and the last has no path without corners.
    """
    rows = pd.DataFrame(
        {
            **dict.fromkeys(["study", "family", "method"], "one"),
            "runs": [10, 30, 20, 20],
            "free": [0.4, 0.8, 0.5, 0.6],
            "cpu_ms": [1, 3, 2, 9],
            "round": [1, 2, 3, 0],
            "cornered": [3, 22, 7, 12],
            "excess": [0.1, 0.4, 0.2, 0.3],
            "rounded": [0.1 + 0.9e-6, 0.4 + 1.1e-6, 0.2, math.nan],
            "curvature": 1.0,
            "rounded_curvature": [1.02, 1.02, 1.04, math.nan],
            "proposed": True,
        }
    )
    table = methods.group_by_family(rows)
    expected = {
        "problems": 4,
        "runs": 80,
        "free": 50 / 80,
        "worst": 0.4,
        "round": 6,
        "cornered": 44,
        "excess": 0.25,
        "rounded": 0.2,
        "cpu_ms": 2.5,
        "both": 3,
        "adds": 2,
    }
    assert table.loc[0, [*expected]].to_dict() == pytest.approx(expected, rel=1e-5)
    text = methods.format_table(table, {}).iloc[0].to_list()
    assert text[1:] == ["62.5 %, worst 40 %", "44 of 50", "25 %", "20 %", "2 of 3", "2.5 ms"]
