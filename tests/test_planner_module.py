"""Planners of a reader's own, with modules of the reader's own beside them."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bezierplan import __main__
from bezierplan.planners import planner_module
from bezierplan.running import interface, watchdog
from bezierplan.schema import checked

ROOT = Path(__file__).parents[1]
PLANNER = """
import json

import shared
from parts import steps


def plan(problem, rng, *, tries: int):
    return json.dumps(shared.VALUE + steps.VALUE)
"""


def folder_with(folder, value):
    (folder / "parts").mkdir(parents=True)
    (folder / "walk.py").write_text(PLANNER)
    (folder / "shared.py").write_text(f"VALUE = {value}\n")
    (folder / "json.py").write_text("raise RuntimeError('no library')\n")
    (folder / "parts" / "__init__.py").write_text("")
    (folder / "parts" / "steps.py").write_text("from .more import VALUE\n")
    (folder / "parts" / "more.py").write_text(f"VALUE = 10 * {value}\n")
    return str(folder / "walk.py")


def test_planners_find_the_modules_beside_them_and_no_others(tmp_path):
    first, second = (planner_module(folder_with(tmp_path / str(value), value)) for value in (1, 2))
    assert [each.plan(None, None, tries=1) for each in (first, second, first)] == ["11", "22", "11"]


ENDS = {
    "import os; os._exit(0)": "when it is imported: its process ended itself with exit status 0, "
    "before it was done",
    "import sys; sys.exit(0)": "line 1: sys.exit: 0",
    "raise KeyboardInterrupt": "line 1: KeyboardInterrupt",
    "raise type('Own', (BaseException,), {})('no')": "line 1: Own: no",
    "import os; os.kill(os.getpid(), 9)": "when it is imported: "
    "its process was ended by signal SIGKILL",
    "import ctypes; ctypes.string_at(0)": "when it is imported: "
    "its process was ended by signal SIGSEGV",
    "while True: pass": "when it is imported: not done within the time limit of 1 s; it is ended",
    "import os, time; os.fork() or time.sleep(600)": f"when it is imported: {watchdog.LEFT}",
    "import os, time; os.fork() and os._exit(3) or time.sleep(600)": "when it is imported: its "
    "process ended itself "
    "with exit status 3",
    "raise ValueError('\\x1b[31m' + 'a' * 10**6)": r"line 1: ValueError: \x1b[31maaa",
}
SOUND = "def plan(problem, rng, *, tries: int):\n    return None\n"
linux = pytest.mark.skipif(
    sys.platform != "linux", reason="elsewhere no process that has loaded libraries is forked"
)


@linux
@pytest.mark.parametrize("end", ENDS)
def test_file_that_ends_or_stalls_when_it_is_imported_is_told_in_one_line(
    end, tmp_path, monkeypatch
):
    monkeypatch.setattr(interface, "LIMIT", 1.0)
    file = tmp_path / "ends.py"
    file.write_text(f"{end}\n{SOUND}")
    with pytest.raises(checked.Fault) as fault:
        interface.loaded(str(file), "place")
    line = str(fault.value)
    assert line.startswith(f"place: {ENDS[end]}")
    assert line.isprintable()
    assert len(line) < 1000


@linux
@pytest.mark.parametrize("end", [*list(ENDS)[:1], *list(ENDS)[2:8]])
def test_check_that_ends_or_stalls_is_told_in_one_line(end, tmp_path, monkeypatch):
    monkeypatch.setattr(interface, "LIMIT", 1.0)
    file = tmp_path / "checks.py"
    file.write_text(f"{SOUND}def check(settings):\n    {end}\n")
    module = interface.loaded(str(file), "place")
    with pytest.raises(checked.Fault, match=r"^place: (check of its planner|line)"):
        interface.asked(module.check, "place", {})


def test_sound_planner_is_loaded_and_asked(tmp_path):
    file = tmp_path / "sound.py"
    file.write_text(
        f"{SOUND}def check(settings):\n    if settings['tries'] > 3: raise ValueError('tries: 4; "
        "expected at most 3')\n"
    )
    module = interface.loaded(str(file), "place")
    interface.asked(module.check, "place", {"tries": 3})
    with pytest.raises(checked.Fault, match=r"^place: tries: 4; expected at most 3$"):
        interface.asked(module.check, "place", {"tries": 4})


COMMANDS = {
    "check-planner": ["check-planner", "ends.py", "--settings", "{tries: 1}"],
    "plan": [
        "plan",
        "room.txt",
        "--start",
        "0.5,0.5",
        "--target",
        "1.5,0.5",
        "--method",
        "ends.py",
        "--settings",
        "{tries: 1}",
    ],
}


@pytest.mark.parametrize(
    ("word", "said"),
    [("plna", "'plna': unknown; did you mean plan? known: "), ("plot", "'plot': unknown; known: ")],
)
def test_unknown_command_is_told_with_those_that_are_known(word, said, capsys):
    with pytest.raises(SystemExit) as ended:
        __main__.main([word])
    assert ended.value.code == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("command", __main__.EXAMPLES)
def test_help_shows_examples(command, capsys):
    with pytest.raises(SystemExit):
        __main__.main([command, "--help"])
    assert all(example in capsys.readouterr().out for example in __main__.EXAMPLES[command][:1])


@linux
@pytest.mark.parametrize(
    ("command", "place"), [("plan", "import"), ("plan", "plan"), ("check-planner", "plan")]
)
def test_command_whose_planner_exits_says_so(command, place, tmp_path):
    (tmp_path / "room.txt").write_text("..\n")
    source = (
        f"import os\nos._exit(0)\n{SOUND}"
        if place == "import"
        else SOUND.replace("return None", "import os; os._exit(0)")
    )
    (tmp_path / "ends.py").write_text(source)
    words = [sys.executable, "-m", "bezierplan", *COMMANDS[command]]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == (2 if command == "plan" else 1)
    (line,) = done.stderr.splitlines()
    assert "ends.py" in line
    assert line.endswith("its process ended itself with exit status 0, before it was done")


@pytest.mark.parametrize(
    "words",
    [
        ["list", "--studies", "./none"],
        ["replay", "song2016/none"],
        ["digest", "none"],
        ["check-planner", "none"],
        ["plan", "none.txt"],
        ["verify", "none", "--outcome"],
        ["outcome", "none"],
    ],
)
def test_wrong_input_ends_every_command_with_status_2(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        __main__.main(words)
    assert ended.value.code == 2
    assert capsys.readouterr().err


LIBRARIES = {
    "a kernel that numba keeps": """
import numba

@numba.njit(cache=True)
def doubled(x):
    return 2.0 * x

def work():
    return doubled(1.0) == 2.0
""",
    "annotations as text of a dataclass": """
from __future__ import annotations
from dataclasses import dataclass

@dataclass
class Node:
    cost: float

def work():
    return Node(1.0).cost == 1.0
""",
    "its own functions in other processes": """
import multiprocessing

def doubled(x):
    return 2 * x

def work():
    with multiprocessing.get_context("fork").Pool(1) as pool:
        return pool.map(doubled, [1, 2]) == [2, 4]
""",
    "what it pickles": """
import pickle

class Node:
    pass

def work():
    return type(pickle.loads(pickle.dumps(Node()))) is Node
""",
    "the clock's zone": """
import time

def work():
    time.tzset()
    return time.strptime("2026", "%Y").tm_year == 2026
""",
}
USING = """
import numpy as np
from bezierplan.planners import Path, Plan

def plan(problem, rng):
    assert work()
    path = Path("polyline", np.array([problem.start, problem.target]))
    return Plan(path, 1.0, True, 1, np.array([1.0]), "one", {})
"""


@linux
@pytest.mark.parametrize("library", LIBRARIES)
def test_a_planner_may_use_libraries_each_time(library, tmp_path):
    """In one process after the other, since numba keeps a kernel for the next."""
    (tmp_path / "room.txt").write_text("..\n")
    (tmp_path / "uses.py").write_text(LIBRARIES[library] + USING)
    words = [sys.executable, "-m", "bezierplan", *COMMANDS["plan"][:-4], "--method", "uses.py"]
    for _ in range(2):
        done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("before", ["", "import sys; del sys.modules[__name__]\n"])
def test_a_file_that_fails_leaves_no_module(before, tmp_path):
    file = tmp_path / "fails.py"
    file.write_text(f"{before}1 / 0\n")
    with pytest.raises(ZeroDivisionError):
        planner_module(str(file))
    assert "planner_fails" not in sys.modules


def test_a_planner_s_file_hides_no_library(tmp_path):
    file = tmp_path / "json.py"
    file.write_text(SOUND)
    planner_module(str(file))
    import json

    assert json.dumps([1]) == "[1]"


POOL = """
import multiprocessing
import numpy as np
from bezierplan.planners import Plan

pool = None

def plan(problem, rng):
    global pool
    if pool is None:
        pool = multiprocessing.get_context("fork").Pool(1)
    pool.map(abs, [1])
    return Plan.of_one(None, np.inf, "none")
"""


@linux
def test_contract_tests_end_at_a_planner_that_keeps_processes(tmp_path):
    """Its pool starts those anew that are ended, and would wait for them for ever."""
    (tmp_path / "keeps.py").write_text(POOL)
    words = [sys.executable, "-m", "bezierplan", "check-planner", "keeps.py"]
    done = subprocess.run(
        words, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 1
    assert "leaves a process behind" in done.stdout


SLOW = """
import time
from pathlib import Path

def plan(problem, rng):
    Path("begun").touch()
    time.sleep(600)
"""


@linux
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("send", [os.kill, os.killpg])
def test_a_signal_ends_a_command_and_its_planner(number, send, tmp_path):
    """Sent to the command alone, as schedulers do, or to all of its processes, as terminals do."""
    (tmp_path / "room.txt").write_text("..\n")
    (tmp_path / "slow.py").write_text(SLOW)
    words = [sys.executable, "-m", "bezierplan", *COMMANDS["plan"][:-4], "--method", "slow.py"]
    command = subprocess.Popen(
        words, cwd=tmp_path, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    until = time.monotonic() + 60
    while not (tmp_path / "begun").exists() and time.monotonic() < until:
        time.sleep(0.05)
    send(command.pid, number)
    _, told = command.communicate(timeout=60)
    interrupted = number == signal.SIGINT
    assert command.returncode == 128 + number
    assert told == ("python -m bezierplan: interrupted\n" if interrupted else "")


@linux
def test_an_interrupt_ends_the_workflow_that_a_command_has_started(tmp_path):
    """And its jobs, though only the command is interrupted."""
    environment = os.environ | {"PYTHONPATH": str(ROOT / "src")}
    command = [sys.executable, "-m", "bezierplan"]
    subprocess.run([*command, "new", "mine"], cwd=tmp_path, env=environment, check=True)
    slow = f"    from pathlib import Path\n    import time\n    Path({str(tmp_path / 'begun')!r})"
    planner = tmp_path / "mine" / "walk.py"
    lines = planner.read_text().splitlines()
    after = next(n for n, line in enumerate(lines) if line.startswith("def plan")) + 2
    lines[after:after] = [f"{slow}.touch()", "    time.sleep(600)"]
    planner.write_text("\n".join(lines))
    workflow = subprocess.Popen(
        [*command, "run", "mine", "--cores", "1"],
        cwd=tmp_path,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    until = time.monotonic() + 120
    while not (tmp_path / "begun").exists() and time.monotonic() < until:
        time.sleep(0.1)
    workflow.send_signal(signal.SIGINT)
    told, _ = workflow.communicate(timeout=60)
    assert (workflow.returncode, told.splitlines()[-1]) == (
        130,
        "python -m bezierplan: interrupted",
    )
    # All that could still write has ended, for it would hold the pipe, and so has the lock.
    assert not any((tmp_path / ".snakemake" / "locks").glob("*"))
