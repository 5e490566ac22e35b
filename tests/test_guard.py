"""Planners of a reader's own in a process of their own: whatever they do ends in one line that
names planner and run, and nothing of it reaches the judge.
"""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from chunks import BENDS, DISC
from starts import appear

from bezierplan.analysis.stored_runs import format_row
from bezierplan.planners import load_planner
from bezierplan.running import execution
from bezierplan.running.guard import interface, process, worker
from bezierplan.running.jobs import watchdog
from bezierplan.schema import checked

PLANNER = """
import ctypes, multiprocessing, os, subprocess, sys, time
import numpy as np
from bezierplan.planners import Path, Plan


def plan(problem, rng, *, bend: float):
    middle = [5.0, 5.0 + bend * rng.random()]
    answer = Plan(Path("polyline", np.array([problem.start, middle, problem.target])), middle[1],
                  True, 1, np.array([middle[1]]), "one", {"tries": 1})
    WORK
    return answer


def track(problem, rng, *, bend: float):
    return [plan(problem, rng, bend=bend).path.points]
"""


def chunk(folder, work=""):
    file = folder / "bend.py"
    file.write_text(PLANNER.replace("WORK", work or "pass"))
    settings = {"bend": 1.0}
    return BENDS._replace(planner=str(file), settings=settings, time_limit=3.0)


DEEDS = {
    "os._exit(0)": "its process ended itself with exit status 0, before it was done",
    "sys.exit('bye')": "sys.exit: bye",
    "ctypes.string_at(0)": "its process was ended by signal SIGSEGV",
    # The sum holds Python's lock for minutes.
    "sum(range(10**11))": "not done within the time limit of 3 s; it is ended",
    "subprocess.Popen(['sleep', '4321.25'], start_new_session=True)": watchdog.LEFT,
    "problem.workspace.radii[:] *= 0.5": "ValueError: output array is read-only",
    "raise ValueError('a\\x1b[31m\\r\\0b' + 'c' * 10**6)": r"ValueError: a\x1b[31m \x00bccc",
    "answer = answer._replace(history=[1.0])": "its answer: history: expected an array of numbers",
}


@pytest.mark.parametrize("deed", DEEDS)
def test_what_a_planner_does_is_told_in_one_short_line_that_names_the_run(
    deed, tmp_path, planners_are_read_here
):
    given = chunk(tmp_path, deed)
    with pytest.raises(watchdog.PlannerFailure) as told:
        execution.run(given, given.conditions()[0], 0, DISC)
    line = str(told.value)
    assert line.startswith("run study/bends/disc/bend/0: ")
    said = re.sub(r"line \d+ of \w+\.py: ", "", line)
    assert f": planner {given.planner}: {DEEDS[deed]}" in said
    assert line.isprintable()
    assert len(line) < 1000
    running = [file.read_bytes() for file in Path("/proc").glob("[0-9]*/cmdline") if file.exists()]
    assert not any(b"4321.25" in words for words in running)


def test_runs_are_those_of_this_process_and_print_into_the_log(tmp_path, monkeypatch, caplog):
    """With other processes that end, and much more than a log should hold."""
    given = chunk(tmp_path)
    here = load_planner(given.planner)
    guarded = chunk(
        tmp_path,
        "with multiprocessing.get_context('fork').Pool(1) as pool:\n        pool.map(abs, [1])\n"
        "    pool.join()\n    print('a' * 10**6)",
    )
    runs, times = execution.run_chunk({"disc": DISC}, guarded)
    assert min(times["cpu_s"].to_pylist()) > 0
    assert "aaa... (" in caplog.text
    # A process for each of two seeds of `hash`.
    assert len(caplog.text) < 3 * process.MOST_PRINTED
    monkeypatch.setattr(worker, "load_planner", lambda planner: here)
    monkeypatch.setattr(execution, "is_file", lambda planner: False)
    again, _ = execution.run_chunk({"disc": DISC}, given)
    assert list(map(format_row, again.to_pylist())) == list(map(format_row, runs.to_pylist()))


def test_a_track_comes_from_the_same_process(tmp_path):
    given = chunk(tmp_path)
    run = given, given.conditions()[0], 1, DISC
    (points,) = execution.run(*run, function="track")
    assert np.array_equal(points, execution.run(*run).path.points)


SOUND = "def plan(problem, rng, *, tries: int):\n    return None\n"
ENDS = {
    "import os; os._exit(0)": "when it is imported: its process ended itself with exit status 0, "
    "before it was done",
    "raise type('Own', (BaseException,), {})('no')": "line 1 of ends.py: Own: no",
    "while True: pass": "when it is imported: not done within the time limit of 3 s; it is ended",
}


@pytest.mark.parametrize("end", ENDS)
def test_file_that_ends_or_stalls_when_it_is_imported_is_told_in_one_line(
    end, tmp_path, monkeypatch
):
    monkeypatch.setattr(process, "STARTS", 3.0)
    file = tmp_path / "ends.py"
    file.write_text(f"{end}\n{SOUND}")
    with pytest.raises(checked.Fault) as fault:
        interface.load_planner_module(str(file), "place")
    assert str(fault.value) == f"place: {ENDS[end]}"
    assert file.stem not in sys.modules


def test_a_check_reports_what_it_raises_and_gets_a_copy(tmp_path):
    settings = {"tries": 4}

    def check(given):
        given["tries"] += 1
        if given["tries"] > 4:
            raise ValueError("tries: 5;\nexpected at most 4")

    with pytest.raises(checked.Fault, match=r"^place: tries: 5; expected at most 4$"):
        interface.ask(check, "place", settings)
    assert settings == {"tries": 4}
    with pytest.raises(checked.Fault, match=r"^place: exit of its planner fails \(sys.exit: 3\)$"):
        interface.ask(sys.exit, "place", 3)


SLOW = """
import time
from pathlib import Path

def plan(problem, rng):
    Path(BEGUN).touch()
    time.sleep(600)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_command_and_its_planner(number, tmp_path):
    (tmp_path / "room.txt").write_text("..\n")
    begun = tmp_path / "begun"
    (tmp_path / "slow.py").write_text(SLOW.replace("BEGUN", repr(str(begun))))
    places = ["--start", "0.5,0.5", "--target", "1.5,0.5", "--method", "slow.py"]
    command = subprocess.Popen(
        [sys.executable, "-m", "bezierplan", "plan", "room.txt", *places],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # A shell's job in the background would leave it ignored.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    appear(begun)
    os.kill(command.pid, number)
    _, told = command.communicate(timeout=60)
    interrupted = number == signal.SIGINT
    assert command.returncode == (128 + number if interrupted else -number)
    assert told == ("python -m bezierplan: interrupted\n" if interrupted else "")


def test_a_file_that_can_be_imported_only_once_is_told_with_its_place(tmp_path):
    file = tmp_path / "once.py"
    file.write_text(f"open({str(tmp_path / 'mark')!r}, 'x')\ndef plan(problem, rng): ...\n")
    with pytest.raises(checked.Fault, match=r"^place: .*FileExistsError: [^\n]+$"):
        interface.load_planner_module(str(file), "place")
