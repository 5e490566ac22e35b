"""A planner's answer is checked before a row is written: every lie is refused by name, and no extra
column takes another's place.
"""

import json
import math

import numpy as np
import pytest
from chunks import BENDS, DISC

from bezierplan.geometry.region import build_region
from bezierplan.planners import Plan
from bezierplan.running import answer, execution, planning, problems
from bezierplan.running.chunk import Condition
from bezierplan.running.columns import TAKEN
from bezierplan.running.guard import plain_values
from bezierplan.workspaces.problem import Path

LINE = np.array([DISC.start, DISC.target])
PLAN = Plan(Path("polyline", LINE), 8.0, True, 1, np.array([8.0]), "one", {"tries": 1})
CHUNK = BENDS._replace(
    planner="chaotic_pso",
    settings={"inertia": 1.0},
    vary={"profile": ["a"]},
)
CONDITION = Condition("disc", {"profile": "a"})


def path(points, curve="polyline"):
    return {"path": Path(curve, points)}


# A lie: fields of the plan, or what is none, and the field that is named.
LIES = {
    "None": (None, "is a NoneType; expected a Plan"),
    "a tuple": (tuple(PLAN), "is a tuple; expected a Plan"),
    "begins elsewhere": (path(LINE * [[1 + 1e-12, 1], [1, 1]]), "path: start: "),
    "ends elsewhere": (
        path(LINE - [[0, 0], [1, 0]]),
        "path: target: (8.0, 5.0); expected exactly (9.0, 5.0)",
    ),
    "begins above": (path(LINE + np.array([[0, 1e-12], [0, 0]])), "path: start: "),
    "ends above": (path(LINE + np.array([[0, 0], [0, 1e-12]])), "path: target: "),
    "points not numbers": (path(LINE * np.nan), "path: points: expected finite numbers"),
    "points infinite": (path(LINE * np.inf), "path: points: expected finite numbers"),
    "points flat": (path(LINE.ravel()), "path: points: expected an array of floats, (n, 2)"),
    "points in space": (path(np.ones((3, 3))), "path: points: expected an array of floats, (n, 2)"),
    "points as a list": (path(LINE.tolist()), "path: points: expected an array of floats, (n, 2)"),
    "no points": (
        path(np.empty((0, 2))),
        "path: a curve of kind polyline needs at least 2 control points, not 0",
    ),
    "too few points": (
        path(LINE, "piecewise_cubic"),
        "path: a curve of kind piecewise_cubic needs at least 4 control points",
    ),
    "odd points": (
        path(LINE[[0, 0, 1, 1, 1]], "ferguson"),
        "path: a curve of kind ferguson needs at least 4 control points, or by a multiple of 2 "
        "more, not 5",
    ),
    "unknown curve": (path(LINE, "nurbs"), "path: curve: 'nurbs'; expected one of "),
    "curve no text": (path(LINE, ["polyline"]), "path: curve: ['polyline']; expected one of"),
    "degree too high": (
        path(np.vstack([LINE[:1]] * 99 + [LINE[1:]]), "bezier"),
        "path: points: 100; expected at most 61 of a bezier",
    ),
    "too long a chain": (
        path(np.vstack([LINE[:1]] * 10_001)),
        "path: points: 10001; expected at most 10000 of a polyline",
    ),
    "too far out": (
        path(np.vstack([LINE[:1], [[1e9, 0]], LINE[1:]])),
        "path: a path has a coordinate that is not finite or beyond",
    ),
    "path no Path": ({"path": ("polyline", LINE)}, "path: expected None or a Path"),
    "claim without a path": ({"path": None}, "claimed_feasible: true without a path"),
    "claim a word": (
        {"claimed_feasible": "yes"},
        "claimed_feasible: expected true or false",
    ),
    "objective text": ({"objective": "8"}, "objective: expected a number"),
    "objective nan": ({"objective": np.nan}, "objective: expected a number, and not nan"),
    "evaluations broken": ({"evaluations": 1.5}, "evaluations: expected a whole number"),
    "evaluations negative": (
        {"evaluations": -1},
        "evaluations: expected a whole number, at least 0",
    ),
    "evaluations huge": ({"evaluations": 2**70}, "evaluations: expected a whole number"),
    "history empty": ({"history": np.array([])}, "history: expected an array"),
    "history a table": ({"history": np.ones((2, 2))}, "history: expected an array"),
    "history with a gap": (
        {"history": np.array([np.nan, 8.0])},
        "history: expected an array of numbers without nan",
    ),
    "history that rises": (
        {"history": np.array([7.0, 8.0])},
        "history: rises; expected the best objective so far",
    ),
    "history of another path": (
        {"history": np.array([9.0, 7.0])},
        "objective: 8.0; expected the last of history, 7.0, or keeps_best = False",
    ),
    "stop of two lines": ({"stop": "a\nb"}, "stop: expected a word"),
    "stop None": ({"stop": None}, "stop: expected a word"),
    "extra None": ({"extra": None}, "extra: expected names with numbers or truths"),
    "extra a list": (
        {"extra": {"tries": [1]}},
        "extra: tries: expected a number, a whole one of at most 2**53, or a truth",
    ),
    "extra huge": (
        {"extra": {"tries": 2**70}},
        "extra: tries: expected a number, a whole one of at most 2**53, or a truth",
    ),
    "extra of a wide name": (
        {"extra": {"\uff46easible": 1}},
        "extra: '\\uff46easible': expected a name",
    ),
    "extra a drive's": (
        {"extra": {"arrival": 1.0}},
        "extra: arrival: a column or setting has this name already",
    ),
    "extra numbered": ({"extra": {1: 1}}, "extra: 1: expected a name"),
    "extra no name": ({"extra": {"a b\n": 1}}, "extra: 'a b\\n': expected a name"),
    "extra a setting": (
        {"extra": {"inertia": 1}},
        "extra: inertia: a column or setting has this name already",
    ),
    "extra what is varied": (
        {"extra": {"profile": 1}},
        "extra: profile: a column or setting has this name already",
    ),
}


def row(plan, **changed):
    plan = plan._replace(**changed) if changed else plan
    return execution.build_row(CHUNK, CONDITION, 0, plan, True, DISC, build_region(DISC.workspace))


@pytest.mark.parametrize("lie", LIES)
def test_lie_is_refused_by_run_and_field(lie):
    given, told = LIES[lie]
    with pytest.raises(RuntimeError) as caught:
        row(PLAN, **given) if isinstance(given, dict) else row(given)
    message = str(caught.value)
    assert message.startswith(
        f"run study/bends/disc,profile=a/bend/0: planner chaotic_pso: its answer: {told}"
    )
    assert "\n" not in message


def test_names_that_are_taken_are_those_that_are_joined():
    bounds = problems.compute_bounds({"disc": DISC}, {}).column_names
    assert set(bounds) <= TAKEN
    assert {"cpu_s", "wall_s", "least_arrival", "replan_mean_s"} <= TAKEN


def test_honest_answers_pass():
    found = row(PLAN)
    assert found["feasible"]
    assert found["tries"] == 1
    none, least = np.False_, np.array([np.inf])
    nothing = row(PLAN, path=None, objective=np.inf, claimed_feasible=none, history=least)
    assert not nothing["feasible"]
    curve = np.array([DISC.start, (1.0, 2.0), DISC.target, (1.0, 2.0)])
    assert row(PLAN, **path(curve, "ferguson"))["path_curve"] == "ferguson"


def test_the_row_holds_what_was_judged():
    """A planner that changes its arrays later changes nothing."""
    points, history = LINE.copy(), np.array([8.0])
    kept = answer.accept_answer(PLAN._replace(**path(points), history=history), DISC, TAKEN)
    points[:], history[:] = 0.0, -1.0
    assert kept.path.points.tolist() == LINE.tolist()
    assert kept.history.tolist() == [8.0]


@pytest.mark.parametrize("plan", [PLAN, PLAN._replace(path=None, claimed_feasible=False)])
def test_text_holds_all_bits_of_a_plan(plan):
    given = answer.convert_answer(
        plan._replace(objective=0.1 + 0.2, history=np.array([np.inf, -0.0]))
    )
    again = plain_values.unpack(json.loads(json.dumps(plain_values.pack(given))))
    assert repr(again) == repr(given)


def test_a_region_shares_no_memory_with_its_workspace():
    circles = DISC.workspace
    made = build_region(circles)
    assert not np.shares_memory(made.centres, circles.centres)
    assert not np.shares_memory(made.radii, circles.radii)


@pytest.mark.parametrize(("largest", "field"), [(2**63 - 1, "evaluations"), (2**53, "tries")])
def test_whole_numbers_are_accepted_up_to_the_largest(largest, field):
    """Those of columns are, because numbers beyond would lose digits."""

    def convert(number):
        extra, count = ({}, number) if field == "evaluations" else ({"tries": number}, 1)
        answer.convert_answer(PLAN._replace(extra=extra, evaluations=count))

    for accepted in (largest, 0, *([-largest] if field == "tries" else [])):
        convert(accepted)
    for refused in (largest + 1, -1 if field == "evaluations" else -largest - 1):
        with pytest.raises(answer.Unfit):
            convert(refused)


@pytest.mark.parametrize(("turn", "corners"), [(2e-8, 1), (-2e-8, 1), (0.5e-8, 0), (3.0, 1)])
def test_a_path_through_way_points_is_that_of_all_legs(turn, corners):
    """A turn at the way point is one more; the least radius is that of the tightest leg."""
    x, y = math.cos(turn), math.sin(turn)
    ends = LINE, LINE[1] + np.array([[0.0, 0.0], [x, y]])
    extras = [{"turns": 1, "corners": 0, "least_radius": radius} for radius in (2.0, 3.0)]
    legs = [
        PLAN._replace(path=Path("polyline", points), objective=length, evaluations=3, extra=extra)
        for points, length, extra in zip(ends, (8.0, 1.0), extras)
    ]
    joined = planning.join_answers(legs)
    assert joined.path.points.tolist() == [*LINE.tolist(), ends[1][1].tolist()]
    assert (joined.objective, joined.evaluations, joined.history.tolist()) == (9.0, 6, [9.0])
    assert joined.extra == {"turns": 2 + corners, "corners": corners, "least_radius": 2.0}
    assert planning.join_answers(legs[:1]) is legs[0]
    nothing = legs[1]._replace(path=None)
    assert planning.join_answers([legs[0], nothing]) is nothing


@pytest.mark.parametrize(("radius", "kept"), [(2.0 - 1e-9, True), (2.0 - 3e-9, False)])
def test_a_radius_is_kept_up_to_rounding(radius, kept):
    assert planning.is_radius_kept(2.0, radius) == kept


@pytest.mark.parametrize("claims", [(True, True), (True, False), (False, True)])
def test_a_path_through_way_points_is_claimed_free_if_each_leg_is(claims):
    legs = [PLAN._replace(claimed_feasible=claim) for claim in claims]
    assert planning.join_answers(legs).claimed_feasible == all(claims)
