"""A planner's file is executed in a process of its own: what it does to memory, to streams or to
libraries does not reach its judge, and its answers come back bit by bit.
"""

import math
import os
import sys

import numpy as np
import pytest

from bezierplan.planners import Path, Plan
from bezierplan.running import apart, execution, interface, watchdog
from bezierplan.running.chunk import Chunk
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem

pytestmark = pytest.mark.skipif(
    sys.platform != "linux", reason="elsewhere a fork may crash, and planners share a process"
)


FOREIGN = True


def asked(plan, *given, fault=str):
    with apart.asking(FOREIGN, "it", plan, fault) as ask:
        return ask("run one", *given)


@pytest.mark.parametrize(
    "path",
    [
        None,
        Path("polyline", np.array([[0.1, 1 / 3], [math.pi, 5e-324], [1e4 + 0.1, -0.0]])),
        Path("bezier", np.array([[0.0, 0.0], [1.0, 2.0], [3.0, 0.0]])),
    ],
)
def test_an_answer_comes_back_bit_by_bit(path):
    history = np.array([math.inf, 0.1 + 0.2, -0.0])
    extra = {"turns": 3, "share": 1.0, "missing": math.nan, "kept": True, "large": 2**62 + 1}
    sent = Plan(path, 1 / 3, path is not None, 7, history, "limit", extra)
    came = asked(lambda: sent)
    assert repr(came._replace(path=None, history=None)) == repr(
        sent._replace(path=None, history=None)
    )
    assert came.history.tobytes() == history.tobytes()
    if path is None:
        assert came.path is None
    else:
        assert came.path.curve == path.curve
        assert came.path.points.tobytes() == path.points.tobytes()
        assert came.path.points.dtype == float


def test_what_is_asked_comes_to_the_planner():
    def plan(problem, number):
        return Plan.of_one(None, problem.workspace.radii.sum() + number, "told")

    world = Circles((0.0, 9.0, 0.0, 9.0), np.array([[4.0, 4.0]]), np.array([1.5]), "m")
    problem = Problem("one", world, (1.0, 1.0), (8.0, 8.0))
    assert asked(plan, problem, 2).objective == 3.5


def test_a_planner_keeps_what_it_holds_between_questions_and_its_judge_does_not_see_it():
    held = [0]

    def plan():
        held[0] += 1
        return Plan.of_one(None, held[0], "told")

    with apart.asking(FOREIGN, "it", plan) as ask:
        assert [ask("run one").objective for _ in range(3)] == [1.0, 2.0, 3.0]
    assert held == [0]


def test_a_planner_of_this_package_is_executed_here():
    held = []
    with apart.asking(not FOREIGN, "it", held.append) as ask:
        ask("run one", 1)
    assert held == [1]


def test_the_clock_counts_what_a_planner_spends():
    def plan():
        sum(range(3_000_000))
        return Plan.of_one(None, 1.0, "told")

    with apart.asking(FOREIGN, "it", plan) as ask:
        before = apart.clock()
        ask("run one")
        cpu, wall = apart.clock() - before
    assert 0.005 < cpu < 1.05 * wall + 0.01


def raises():
    raise ZeroDivisionError("no")


def ends():
    os._exit(3)


def replaces():
    np.isfinite = math.isfinite
    return Plan.of_one(None, 1.0, "told")


def lies():
    return Plan.of_one(None, "long", "told")


FAULTS = {
    raises: "run one: ZeroDivisionError: no",
    ends: "run one: its process ended itself with exit status 3, before it was done",
    replaces: "it: replaces numpy.isfinite; a planner leaves other modules as they are",
    lies: "run one: its answer: objective: expected a number, and not nan",
}


@pytest.mark.parametrize("plan", FAULTS)
def test_what_goes_wrong_is_told(plan):
    before = watchdog.children()
    with pytest.raises(watchdog.PlannerFailure) as failure:
        asked(plan)
    assert str(failure.value) == FAULTS[plan]
    assert np.isfinite is not math.isfinite
    assert not watchdog.children() - before


def test_the_place_of_an_exception_is_kept_for_the_log():
    with pytest.raises(watchdog.PlannerFailure) as failure:
        asked(raises)
    assert 'raise ZeroDivisionError("no")' in "".join(failure.value.__notes__)


def test_what_a_planner_has_changed_is_looked_for_where_it_was_executed():
    world = [1]

    def plan():
        world.clear()
        return Plan.of_one(None, 1.0, "told")

    with pytest.raises(watchdog.PlannerFailure, match=r"^it: world: is another"):
        asked(plan, fault=lambda: "" if world else "world: is another")
    assert world == [1]


def test_an_exception_of_the_judge_ends_the_process():
    def judged():
        with apart.asking(FOREIGN, "it", lambda: Plan.of_one(None, 1.0, "told")) as ask:
            raise ZeroDivisionError(ask("run one").stop)

    before = watchdog.children()
    with pytest.raises(ZeroDivisionError, match="told"):
        judged()
    assert not watchdog.children() - before


# What a planner does that would change the verdict on its path, which crosses a disc, or end its
# judge, if that shared its process.
DISTURBANCES = {
    "the judge's memory": """
    frame = sys._getframe()
    while "blocked" not in frame.f_locals:
        frame = frame.f_back
    (region,) = frame.f_locals["blocked"].values()
    ctypes.memset(region.radii.ctypes.data, 0, region.radii.nbytes)""",
    "errors of numpy": "np.seterr(all='raise')",
    "the recursion limit": "sys.setrecursionlimit(90)",
    "standard streams": "sys.stdout = sys.stderr = None",
    "open files": "os.closerange(0, 3)",
    "warnings": "warnings.simplefilter('error')",
    "the folder": "os.chdir('/')",
    "another library": "pa.array = pa.table = None",
    "tracing": "sys.setprofile(lambda *_: None)",
    "collected memory": "gc.freeze(); gc.disable()",
}
CROSSING = """
import ctypes, gc, os, sys, warnings

import numpy as np
import pyarrow as pa
from bezierplan.planners import Path, Plan
from bezierplan.running import rows

deterministic = True


def plan(problem, rng):
    {work}
    path = Path("polyline", np.array([problem.start, problem.target]))
    return Plan(path, 8.0, True, 1, np.array([8.0]), "one", {{}})
"""
DISC = Problem(
    "disc",
    Circles((0.0, 10.0, 0.0, 10.0), np.array([[5.0, 5.5]]), np.array([1.0]), "m"),
    (1.0, 5.0),
    (9.0, 5.0),
)


def rows_of(folder, work):
    file = folder / "crossing.py"
    file.write_text(CROSSING.format(work=work))
    chunk = Chunk(
        study="s",
        experiment="e",
        method="m",
        planner=str(file),
        settings={},
        problems={"disc": {"workspace": "field"}},
        vary={},
        presets={},
        seeds="own",
        repeats=[0, 2],
    )
    return execution.run_chunk({"disc": DISC}, chunk)[0].drop_columns(["planner"]).to_pylist()


@pytest.mark.parametrize("disturbance", DISTURBANCES)
def test_what_a_planner_disturbs_does_not_reach_the_table(disturbance, tmp_path):
    (tmp_path / "honest").mkdir()
    honest = rows_of(tmp_path / "honest", "pass")
    assert [row["feasible"] for row in honest] == [False, False]
    assert repr(rows_of(tmp_path, DISTURBANCES[disturbance])) == repr(honest)


def test_a_part_of_another_module_that_a_planner_replaces_is_told(tmp_path):
    with pytest.raises(
        watchdog.PlannerFailure, match=r"replaces bezierplan\.running\.rows\.table;"
    ):
        rows_of(tmp_path, "rows.table = None")


def test_a_file_is_not_executed_in_the_judge_s_process(tmp_path):
    (tmp_path / "crossing.py").write_text("")
    rows_of(tmp_path, "pass")
    assert not [name for name in sys.modules if "crossing" in name]
    file = str(tmp_path / "crossing.py")
    assert interface.traits(file) == interface.Traits([], True)


@pytest.mark.parametrize(
    ("source", "told"),
    [
        ("raise KeyError('no')", r"line 1: KeyError: 'no'"),
        ("import os; os._exit(0)", "when it is imported: its process ended itself with exit"),
    ],
)
def test_a_file_that_cannot_be_executed_is_told(source, told, tmp_path):
    file = tmp_path / "broken.py"
    file.write_text(source)
    with pytest.raises(watchdog.PlannerFailure, match=f"^planner {file}: {told}"):
        interface.traits(str(file))
