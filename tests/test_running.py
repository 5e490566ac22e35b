"""A chunk of runs: conditions that take turns, repeats that count as one, and stable times."""

import time
from types import ModuleType

import pytest
from chunks import BENDS, DISC

from bezierplan.running import execution
from bezierplan.running.guard import interface, worker

PLANNER = """
import numpy as np
from bezierplan.planners import Path, Plan

made = []

def plan(problem, rng, *, bend: float):
    made.append(bend)
    middle = [5.0, 5.0 + bend * rng.random()]
    path = Path("polyline", np.array([problem.start, middle, problem.target]))
    return Plan(path, middle[1], True, 1, np.array([middle[1]]), "one", {})
"""


def chunk(**changed):
    return BENDS._replace(vary={"bend": [0.0, 1.0, 2.0]}, repeats=[4, 10], **changed)


@pytest.fixture
def planner(monkeypatch):
    """A function that puts a planner into the package, with another text in one place and one at
    the beginning, and gives a chunk of its runs.
    """

    def put(text="    made.append", before=""):
        module = ModuleType("bend")
        exec(before + PLANNER.replace("    made.append", text), vars(module))
        for user in (worker, interface):
            monkeypatch.setattr(user, "load_planner", lambda name: module)
        return chunk()

    return put


def test_conditions_take_turns():
    order = execution._order(chunk(), 3, range(4, 10))
    assert sorted(order) == [(k, repeat) for k in range(3) for repeat in range(4, 10)]
    assert order == execution._order(chunk(), 3, range(4, 10))
    assert order != execution._order(chunk(method="other"), 3, range(4, 10))
    assert len({k for k, _ in order[:6]}) > 1
    # No condition is always first.
    assert {execution._order(chunk(method=f"m{n}"), 3, range(4, 10))[0][0] for n in range(20)} == {
        0,
        1,
        2,
    }


OWN = "rng = np.random.default_rng({})"
# What a planner takes as its generator, whether the given one goes on, and how many of six repeats
# differ.
DRAWS = {
    "the given one": ("made", True, 6),
    "one that it makes": ("rng = rng.spawn(1)[0]", True, 6),
    "none": ("rng = SimpleNamespace(random=lambda: 0.5)", False, 1),
    "one of its own": (OWN.format(42), False, 1),
    "the given one with a state of its own": (
        "rng.bit_generator.state = np.random.PCG64(1).state",
        False,
        1,
    ),
    "one of its own after one draw": (f"rng.random(); {OWN.format(42)}", True, 1),
    "a copy": ("rng = copy.deepcopy(rng)", False, 6),
    "a jump": ("rng = np.random.Generator(rng.bit_generator.jumped())", False, 6),
    "one by its seed": (OWN.format("rng.bit_generator.seed_seq.generate_state(1)"), False, 6),
    "one by its state": (OWN.format("rng.bit_generator.state['state']['state']"), False, 6),
}


@pytest.mark.parametrize("case", DRAWS)
def test_repeats_count_as_one_where_they_are_equal_and_nothing_was_drawn(planner, capsys, case):
    line, drew, different = DRAWS[case]
    before = "import copy\nfrom types import SimpleNamespace\n"
    given = planner(f"    {line}\n    made.append", before)._replace(vary={"bend": [1.0]})
    runs, _ = execution.run_chunk({"disc": DISC}, given)
    assert set(runs["drew"].to_pylist()) == {drew}
    assert len({*map(str, runs["path_points"].to_pylist())}) == different
    told = f"run study/bends/*/bend: planner bend: {worker.ALIKE[drew]}\n"
    assert capsys.readouterr().err == (told if different == 1 else "")


def test_a_planner_that_draws_nothing_and_says_so_is_not_told_of_it(planner, capsys):
    given = planner("    rng = np.random.default_rng(1)\n    made.append", "deterministic = True\n")
    execution.run_chunk({"disc": DISC}, given)
    assert capsys.readouterr().err == ""


def test_a_planner_that_finds_nothing_in_any_repeat_has_runs(planner, capsys):
    given = planner(
        "    rng.random()\n    return Plan(None, np.inf, False, 1, np.array([np.inf]), '', {})\n"
        "    made.append"
    )
    runs, _ = execution.run_chunk({"disc": DISC}, given)
    assert runs["feasible"].to_pylist() == [False] * 18
    assert capsys.readouterr().err == ""


def warm_up(seconds):
    """How many runs are thrown away that take so many seconds one after the other, the last for
    ever.
    """
    taken = []

    def once():
        taken.append(seconds[min(len(taken), len(seconds) - 1)])
        return worker.Reply(-1, None, taken[-1], taken[-1], True)

    worker.warm_up(once)
    return len(taken)


@pytest.mark.parametrize(
    ("seconds", "runs"),
    [
        ([0.001], 3),
        ([0.001, 0.00105, 0.001], 3),
        ([0.5, 0.001], 4),
        ([0.00096, 0.00078, 0.00036, 0.0003, 0.0003], 6),
        ([1.5], 1),
        ([0.5, 0.15, 0.1, 0.05], 3),
    ],
)
def test_runs_are_thrown_away_until_times_are_stable(seconds, runs):
    assert warm_up(seconds) == runs


def test_times_are_those_of_the_clock():
    found, cpu, wall = worker.time_call(lambda: time.sleep(0.1))
    assert found is None
    assert 0.1 <= wall < 1.0
    assert 0 <= cpu < 0.1


UNREPEATABLE = {
    "an own generator": "rng = np.random.default_rng()",
    "the global generator": "bend = bend + np.random.random()",
    "the clock": "import time; bend = bend + time.time() % 1",
    "an address": "global made; bend = bend + id(made := [*made, object()]) % 1009 / 1009",
    "an earlier run": "bend = bend + len(made) / 100",
}


@pytest.mark.parametrize("fault", UNREPEATABLE)
def test_run_that_cannot_be_repeated_is_refused(fault, planner):
    given = planner(f"    {UNREPEATABLE[fault]}\n    made.append")
    with pytest.raises(
        RuntimeError, match=r"with the same generator its run has another (objective|length)"
    ):
        execution.run_chunk({"disc": DISC}, given)


def test_planner_that_is_not_deterministic_as_it_says_is_refused(planner):
    given = planner("    made.append", "deterministic = True\n")
    with pytest.raises(
        RuntimeError,
        match="deterministic = True, but with another generator its run has another objective",
    ):
        execution.run_chunk({"disc": DISC}, given)
