"""A chunk of runs: rows in the order of conditions and repeats whatever order they were made in, stable times, and the limit of a run."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest

from bezierplan.commands.digest import row_text
from bezierplan.running import execution, watchdog
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem

PROBLEM = Problem("disc", Circles((0.0, 10.0, 0.0, 10.0), np.array([[5.0, 8.0]]), np.array([1.0]), "m"), (1.0, 5.0), (9.0, 5.0))
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


def job(folder, **changed):
    (folder / "bend.py").write_text(PLANNER)
    return {
        "study": "study",
        "experiment": "bends",
        "method": "bend",
        "planner": str(folder / "bend.py"),
        "settings": {},
        "problems": {"disc": {"workspace": "field"}},
        "vary": {"bend": [0.0, 1.0, 2.0]},
        "presets": {},
        "seeds": "own",
        "repeats": [4, 10],
    } | changed


def test_rows_stand_in_order_and_do_not_depend_on_it(tmp_path, monkeypatch):
    given = job(tmp_path)
    runs, times = execution.run_chunk({"disc": PROBLEM}, given)
    assert runs["id"].to_pylist() == [f"study/bends/disc,bend={bend}/bend/{repeat}" for bend in (0.0, 1.0, 2.0) for repeat in range(4, 10)]
    assert times["id"].to_pylist() == runs["id"].to_pylist()
    monkeypatch.setattr(execution, "_order", lambda job, conditions, repeats: [(k, n) for k in range(conditions) for n in repeats])
    again, _ = execution.run_chunk({"disc": PROBLEM}, given)
    assert list(map(row_text, again.to_pylist())) == list(map(row_text, runs.to_pylist()))


def test_conditions_take_turns(tmp_path):
    order = execution._order(job(tmp_path), 3, range(4, 10))
    assert sorted(order) == [(k, repeat) for k in range(3) for repeat in range(4, 10)]
    assert order == execution._order(job(tmp_path), 3, range(4, 10))
    assert order != execution._order(job(tmp_path, method="other"), 3, range(4, 10))
    assert len({k for k, _ in order[:6]}) > 1
    # No condition is always first.
    assert {execution._order(job(tmp_path, method=f"m{n}"), 3, range(4, 10))[0][0] for n in range(20)} == {0, 1, 2}


def test_deterministic_planner_is_run_once_a_condition(tmp_path):
    given = job(tmp_path)
    (tmp_path / "bend.py").write_text(PLANNER.replace("made = []", "deterministic = True\nmade = []").replace("rng.random()", "1.0"))
    runs, times = execution.run_chunk({"disc": PROBLEM}, given)
    assert runs["repeat"].to_pylist() == [*range(4, 10)] * 3
    assert len(set(times["cpu_s"].to_pylist())) <= 3
    assert runs["objective"].to_pylist() == [objective for objective in (5.0, 6.0, 7.0) for _ in range(6)]


def warm_up(seconds):
    """How many runs are thrown away that take so many seconds one after the other, the last for ever."""
    taken = []

    def once():
        taken.append(seconds[min(len(taken), len(seconds) - 1)])
        return None, taken[-1], taken[-1]

    execution._warm_up(once)
    return len(taken)


@pytest.mark.parametrize(
    ("seconds", "runs"),
    [
        ([0.001], 3),
        ([0.5, 0.001], 4),
        ([0.00096, 0.00078, 0.00036, 0.0003, 0.0003], 6),
        ([1.5], 1),
        ([0.5, 0.15, 0.1, 0.05], 3),
    ],
)
def test_runs_are_thrown_away_until_times_are_stable(seconds, runs):
    assert warm_up(seconds) == runs


WATCHED = """
    import logging, time
    logging.basicConfig(filename="log", level=logging.INFO)
    from bezierplan.running import watchdog
    with watchdog.watching({limit}) as watch:
        for name in ("first", "second"):
            watch("run " + name)
            {work}
            watch("")
            time.sleep({pause})
    print("end")
"""


def watched(folder, work, limit=1.0, pause=0.0):
    source = textwrap.dedent(WATCHED).format(limit=limit, work=work, pause=pause)
    return subprocess.run([sys.executable, "-c", source], cwd=folder, capture_output=True, text=True, check=False, timeout=60)


def test_what_keeps_the_interpreter_to_itself_is_ended_too(tmp_path):
    """The sum holds Python's lock for minutes: neither a thread nor a signal handler of the process would come to its turn."""
    done = watched(tmp_path, 'sum(range(10**11)) if name == "second" else None')
    told = "run second: not done within the time limit of 1 s; the job is ended\n"
    assert (done.returncode, done.stdout, done.stderr) == (-9, "", told)
    assert (tmp_path / "log").read_text().endswith(told)


def test_pauses_between_runs_and_short_runs_are_not_ended(tmp_path):
    done = watched(tmp_path, "time.sleep(0.1)", pause=1.3)
    assert (done.returncode, done.stdout, done.stderr) == (0, "end\n", "")


def test_without_a_limit_nothing_is_watched():
    with watchdog.watching(None) as watch:
        watch("run")
