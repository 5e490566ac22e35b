"""A planner's answer is checked before a row is written: every lie is refused by name, and no extra column takes another's place."""

import numpy as np
import pytest

from bezierplan.geometry.region import region
from bezierplan.planners import Plan
from bezierplan.running import answer, execution, problems
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Path, Problem

PROBLEM = Problem("disc", Circles((0.0, 10.0, 0.0, 10.0), np.array([[5.0, 8.0]]), np.array([1.0]), "m"), (1.0, 5.0), (9.0, 5.0))
LINE = np.array([PROBLEM.start, PROBLEM.target])
PLAN = Plan(Path("polyline", LINE), 8.0, True, 1, np.array([8.0]), "one", {"tries": 1})
JOB = {
    "study": "s",
    "experiment": "e",
    "method": "m",
    "planner": "chaotic_pso",
    "settings": {"inertia": 1.0},
    "problems": {"disc": {"workspace": "field"}},
    "vary": {"profile": ["a"]},
    "presets": {"profile": {"a": {}}},
    "seeds": "own",
    "repeats": [0, 1],
}
CONDITION = execution.Condition("disc", {"profile": "a"})


def path(points, curve="polyline"):
    return PLAN._replace(path=Path(curve, points))


# A lie: the plan, and the field that is named.
LIES = {
    "None": (None, "is a NoneType; expected a Plan"),
    "a tuple": (tuple(PLAN), "is a tuple; expected a Plan"),
    "begins elsewhere": (path(LINE * [[1 + 1e-12, 1], [1, 1]]), "path: start: "),
    "ends elsewhere": (path(LINE - [[0, 0], [1, 0]]), "path: target: (8.0, 5.0); expected exactly (9.0, 5.0)"),
    "backwards": (path(LINE[::-1]), "path: start: "),
    "points not numbers": (path(LINE * np.nan), "path: points: expected finite numbers"),
    "points infinite": (path(LINE * np.inf), "path: points: expected finite numbers"),
    "points flat": (path(LINE.ravel()), "path: points: expected an array of floats, (n, 2)"),
    "points in space": (path(np.ones((3, 3))), "path: points: expected an array of floats, (n, 2)"),
    "points as a list": (path(LINE.tolist()), "path: points: expected an array of floats, (n, 2)"),
    "points of text": (path(LINE.astype(str)), "path: points: expected an array of floats, (n, 2)"),
    "no points": (path(np.empty((0, 2))), "path: a curve of kind polyline needs at least 2 control points, not 0"),
    "too few points": (path(LINE, "piecewise_cubic"), "path: a curve of kind piecewise_cubic needs at least 4 control points"),
    "odd points": (path(LINE[[0, 0, 1, 1, 1]], "ferguson"), "path: a curve of kind ferguson needs an even number"),
    "unknown curve": (path(LINE, "nurbs"), "path: unknown curve 'nurbs'"),
    "curve no text": (path(LINE, ["polyline"]), "path: curve: is a list"),
    "degree too high": (path(np.vstack([LINE[:1]] * 99 + [LINE[1:]]), "bezier"), "path: pieces have the shape"),
    "too far out": (path(np.vstack([LINE[:1], [[1e9, 0]], LINE[1:]])), "path: a path has a coordinate that is not finite or beyond"),
    "path no Path": (PLAN._replace(path=("polyline", LINE)), "path: expected None or a Path"),
    "claim without a path": (PLAN._replace(path=None), "claimed_feasible: true without a path"),
    "claim a word": (PLAN._replace(claimed_feasible="yes"), "claimed_feasible: expected true or false"),
    "objective text": (PLAN._replace(objective="8"), "objective: expected a number"),
    "objective nan": (PLAN._replace(objective=np.nan), "objective: expected a number, and not nan"),
    "objective None": (PLAN._replace(objective=None), "objective: expected a number"),
    "objective an array": (PLAN._replace(objective=np.array([8.0])), "objective: expected a number"),
    "evaluations broken": (PLAN._replace(evaluations=1.5), "evaluations: expected a whole number"),
    "evaluations negative": (PLAN._replace(evaluations=-1), "evaluations: expected a whole number, at least 0"),
    "evaluations a truth": (PLAN._replace(evaluations=True), "evaluations: expected a whole number"),
    "history empty": (PLAN._replace(history=np.array([])), "history: expected an array"),
    "history None": (PLAN._replace(history=None), "history: expected an array"),
    "history a table": (PLAN._replace(history=np.ones((2, 2))), "history: expected an array"),
    "history with a gap": (PLAN._replace(history=np.array([np.nan, 8.0])), "history: expected an array of numbers without nan"),
    "stop None": (PLAN._replace(stop=None), "stop: expected a word"),
    "extra None": (PLAN._replace(extra=None), "extra: expected names with numbers or truths"),
    "extra a list": (PLAN._replace(extra={"tries": [1]}), "extra: expected names with numbers or truths"),
    "extra numbered": (PLAN._replace(extra={1: 1}), "extra: expected names with numbers or truths"),
    "extra no name": (PLAN._replace(extra={"a b\n": 1}), "extra: 'a b\\n': expected a name"),
    "extra a setting": (PLAN._replace(extra={"inertia": 1}), "extra: inertia: a column or setting has this name already"),
    "extra what is varied": (PLAN._replace(extra={"profile": 1}), "extra: profile: a column or setting has this name already"),
}


def row(plan):
    return execution.row(JOB, CONDITION, 0, plan, PROBLEM, region(PROBLEM.workspace))


@pytest.mark.parametrize("lie", LIES)
def test_lie_is_refused_by_run_and_field(lie):
    plan, told = LIES[lie]
    with pytest.raises(RuntimeError) as caught:
        row(plan)
    message = str(caught.value)
    assert message.startswith(f"run s/e/disc,profile=a/m/0: the answer of planner chaotic_pso: {told}")
    assert "\n" not in message


@pytest.mark.parametrize("name", sorted(execution.TAKEN))
def test_no_column_is_overwritten(name):
    with pytest.raises(RuntimeError, match=f"extra: {name}: a column or setting has this name already"):
        row(PLAN._replace(extra={name: True}))


def test_names_that_are_taken_are_those_that_are_joined():
    bounds = problems.bounds_of({"disc": PROBLEM}).column_names
    assert set(bounds) <= execution.TAKEN
    assert {"cpu_s", "wall_s"} <= execution.TAKEN


def test_honest_answers_pass():
    assert not answer.fault(PLAN, PROBLEM, execution.TAKEN)
    found = row(PLAN)
    assert found["feasible"]
    assert found["tries"] == 1
    nothing = row(PLAN._replace(path=None, objective=np.inf, claimed_feasible=np.False_, history=np.array([np.inf])))
    assert not nothing["feasible"]
    curve = np.array([PROBLEM.start, (1.0, 2.0), PROBLEM.target, (1.0, 2.0)])
    assert row(path(curve, "ferguson"))["path_curve"] == "ferguson"
