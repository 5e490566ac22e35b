"""A chunk of runs: rows in the order of conditions and repeats whatever order they were made in,
stable times, and the limit of a run.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from bezierplan.commands.digest import row_text
from bezierplan.running import execution, kernel_cache, watchdog
from bezierplan.running.chunk import Chunk
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem

PROBLEM = Problem(
    "disc",
    Circles((0.0, 10.0, 0.0, 10.0), np.array([[5.0, 8.0]]), np.array([1.0]), "m"),
    (1.0, 5.0),
    (9.0, 5.0),
)
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


def chunk(folder, **changed):
    (folder / "bend.py").write_text(PLANNER)
    return Chunk(
        study="study",
        experiment="bends",
        method="bend",
        planner=str(folder / "bend.py"),
        settings={},
        problems={"disc": {"workspace": "field"}},
        vary={"bend": [0.0, 1.0, 2.0]},
        presets={},
        seeds="own",
        repeats=[4, 10],
    )._replace(**changed)


def test_rows_stand_in_order_and_do_not_depend_on_it(tmp_path, monkeypatch):
    given = chunk(tmp_path)
    runs, times = execution.run_chunk({"disc": PROBLEM}, given)
    assert runs["id"].to_pylist() == [
        f"study/bends/disc,bend={bend}/bend/{repeat}"
        for bend in (0.0, 1.0, 2.0)
        for repeat in range(4, 10)
    ]
    assert times["id"].to_pylist() == runs["id"].to_pylist()
    monkeypatch.setattr(
        execution,
        "_order",
        lambda job, conditions, repeats: [(k, n) for k in range(conditions) for n in repeats],
    )
    again, _ = execution.run_chunk({"disc": PROBLEM}, given)
    assert list(map(row_text, again.to_pylist())) == list(map(row_text, runs.to_pylist()))


def test_a_job_that_waits_for_a_kernel_checks_a_free_path_and_one_that_collides(
    tmp_path, monkeypatch
):
    """In each type of region, so that the kernels of the check are there for its own paths."""
    blocked = PROBLEM._replace(
        workspace=Circles((0.0, 10.0, 0.0, 10.0), np.array([[5.0, 5.0]]), np.array([1.0]), "m")
    )
    checks = []

    def run(*_):
        checks.extend(each()[1].feasible for each in kernel_cache.meanwhile)
        raise RuntimeError("that is enough")

    monkeypatch.setattr(execution, "run", run)
    monkeypatch.setattr(kernel_cache, "meanwhile", [])
    given = chunk(
        tmp_path,
        planner="straight_line",
        problems={"disc": {"workspace": "field"}, "other": {"workspace": "w"}},
    )
    with pytest.raises(watchdog.PlannerFailure, match="that is enough"):
        execution.run_chunk({"disc": blocked, "other": blocked}, given)
    assert checks == [False, True]


def test_conditions_take_turns(tmp_path):
    order = execution._order(chunk(tmp_path), 3, range(4, 10))
    assert sorted(order) == [(k, repeat) for k in range(3) for repeat in range(4, 10)]
    assert order == execution._order(chunk(tmp_path), 3, range(4, 10))
    assert order != execution._order(chunk(tmp_path, method="other"), 3, range(4, 10))
    assert len({k for k, _ in order[:6]}) > 1
    # No condition is always first.
    assert {
        execution._order(chunk(tmp_path, method=f"m{n}"), 3, range(4, 10))[0][0] for n in range(20)
    } == {0, 1, 2}


def test_deterministic_planner_is_run_once_a_condition(tmp_path):
    given = chunk(tmp_path)
    (tmp_path / "bend.py").write_text(
        PLANNER.replace("made = []", "deterministic = True\nmade = []").replace(
            "rng.random()", "1.0"
        )
    )
    runs, times = execution.run_chunk({"disc": PROBLEM}, given)
    assert runs["repeat"].to_pylist() == [*range(4, 10)] * 3
    assert len(set(times["cpu_s"].to_pylist())) <= 3
    assert runs["objective"].to_pylist() == [
        objective for objective in (5.0, 6.0, 7.0) for _ in range(6)
    ]


def warm_up(seconds):
    """How many runs are thrown away that take so many seconds one after the other, the last for
    ever.
    """
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
import ctypes, os, signal, subprocess, sys, threading, time
from bezierplan.running.chunk import Chunk
from bezierplan.running import log, watchdog
watchdog._ENDING = 0.5
watchdog.supervise("job", lambda line: log.report("log", line))
with watchdog.watching({limit}) as watch:
    for name in ("first", "second"):
        watch("run " + name)
        if name == "second":
            {work}
        watch("")
        time.sleep({pause})
print("end")
watchdog.settle({status})
"""


def watched(folder, work, limit=2.0, pause=0.0, status=0):
    source = WATCHED.format(limit=limit, work=work, pause=pause, status=status)
    return subprocess.run(
        [sys.executable, "-c", source],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


@pytest.mark.parametrize(
    ("work", "told"),
    [
        # The sum holds Python's lock for minutes: neither a thread nor a signal handler of the
        # process would come to its turn.
        ("sum(range(10**11))", "not done within the time limit of 2 s; it is ended"),
        ("os._exit(0)", "its process ended itself with exit status 0, before it was done"),
        ("os._exit(7)", "its process ended itself with exit status 7, before it was done"),
        (
            "os.kill(os.getpid(), signal.SIGKILL)",
            "its process was ended by signal SIGKILL, "
            "by itself, by another program, or for want of memory",
        ),
        ("ctypes.string_at(0)", "its process was ended by signal SIGSEGV"),
        ("os.abort()", "its process was ended by signal SIGABRT"),
        # A child holds whatever a fork inherits.
        (
            "os.fork() and os._exit(3) or time.sleep(600)",
            "its process ended itself with exit status 3, before it was done",
        ),
        (
            "os.closerange(3, 99); time.sleep(600)",
            "not done within the time limit of 2 s; it is ended",
        ),
    ],
)
def test_whatever_ends_a_run_is_told_in_one_line_that_names_it(work, told, tmp_path):
    done = watched(tmp_path, work)
    assert (done.returncode, done.stdout, done.stderr) == (
        1,
        "",
        f"run second: {told} (log: log)\n",
    )
    assert (tmp_path / "log").read_text() == f"CRITICAL run second: {told} (log: log)\n"


def test_pauses_between_runs_and_short_runs_are_not_ended(tmp_path):
    done = watched(tmp_path, "time.sleep(0.1)", limit=1.0, pause=1.3)
    assert (done.returncode, done.stdout, done.stderr) == (0, "end\n", "")


@pytest.mark.parametrize(
    "work",
    [
        "import atexit; atexit.register(os._exit, 0)",
        "threading.Thread(target=time.sleep, args=(600,)).start()",
    ],
)
def test_what_a_planner_leaves_does_not_change_the_exit_status(work, tmp_path):
    assert watched(tmp_path, work, status=1).returncode == 1


@pytest.mark.skipif(
    sys.platform != "linux", reason="only Linux gives a process the children of its children"
)
@pytest.mark.parametrize(
    "work",
    [
        "subprocess.Popen(['sleep', '600'], start_new_session=True)",
        # A daemon: its parent has ended, so nobody knows whose child it was.
        "subprocess.run([sys.executable, '-c', 'import subprocess; subprocess.Popen([\"sleep\", "
        '"600"], start_new_session=True)\'])',
    ],
)
def test_processes_left_behind_end_with_the_job(work, tmp_path):
    done = watched(tmp_path, f"{work}; print(*watchdog.children(), flush=True)")
    (left,) = done.stdout.splitlines()[0].split()
    assert not Path(f"/proc/{left}").exists()


def test_without_supervision_nothing_is_told():
    with watchdog.watching(None) as watch:
        watch("run")
    watchdog.settle()


FAULTS = {
    "import sys; sys.exit('bye')": "sys.exit: bye",
    "raise KeyboardInterrupt": "KeyboardInterrupt",
    "raise type('Own', (BaseException,), {})('no')": "Own: no",
    "raise ValueError('a\\x1b[31m\\r\\0b' + 'c' * 10**6)": r"ValueError: a\x1b[31m\r\x00bccc",
    "import subprocess; subprocess.Popen(['sleep', '600'], start_new_session=True)": watchdog.LEFT,
    "import os, time; os.fork() or time.sleep(600)": watchdog.LEFT,
    "import multiprocessing as m, time; m.get_context('fork').Process(target=time.sleep, "
    "args=(600,)).start()": watchdog.LEFT,
}


@pytest.mark.parametrize("fault", FAULTS)
def test_run_that_goes_wrong_is_named_in_one_short_line(fault, tmp_path):
    given = chunk(tmp_path)
    file = tmp_path / "bend.py"
    file.write_text(PLANNER.replace("    made.append", f"    {fault}\n    made.append"))
    assert fault in file.read_text()
    before = watchdog.children()
    with pytest.raises(RuntimeError, match=r"^run ") as told:
        execution.run_chunk({"disc": PROBLEM}, given)
    line = str(told.value)
    assert f": planner {file}: {FAULTS[fault]}" in line
    assert line.isprintable()
    assert len(line) < 1000
    assert not watchdog.children() - before


UNREPEATABLE = {
    "an own generator": "rng = np.random.default_rng()",
    "the global generator": "bend = bend + np.random.random()",
    "the clock": "import time; bend = bend + time.time() % 1",
    "an address": "global made; bend = bend + id(made := [*made, object()]) % 1009 / 1009",
    "an earlier run": "bend = bend + len(made) / 100",
}


@pytest.mark.parametrize("fault", UNREPEATABLE)
def test_run_that_cannot_be_repeated_is_refused(fault, tmp_path):
    given = chunk(tmp_path)
    file = tmp_path / "bend.py"
    file.write_text(
        PLANNER.replace("    made.append", f"    {UNREPEATABLE[fault]}\n    made.append")
    )
    with pytest.raises(
        RuntimeError, match=r"with the same generator its run has another (objective|length)"
    ):
        execution.run_chunk({"disc": PROBLEM}, given)


def test_planner_that_is_not_deterministic_as_it_says_is_refused(tmp_path):
    given = chunk(tmp_path)
    (tmp_path / "bend.py").write_text(
        PLANNER.replace("made = []", "deterministic = True\nmade = []")
    )
    with pytest.raises(
        RuntimeError,
        match="deterministic = True, but with another generator its run has another objective",
    ):
        execution.run_chunk({"disc": PROBLEM}, given)
