"""Planners of a reader's own, with modules of the reader's own beside them."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from commands import call
from starts import appear

from bezierplan import __main__
from bezierplan.machine.modules import load_module
from bezierplan.planners import load_planner

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
    first, second = (load_planner(folder_with(tmp_path / str(value), value)) for value in (1, 2))
    assert [each.plan(None, None, tries=1) for each in (first, second, first)] == ["11", "22", "11"]


def test_a_quick_edit_beside_a_planner_is_never_missed(tmp_path):
    """Python takes a compiled file for that of a source with the same second and size."""
    planner = folder_with(tmp_path / "walk", 1)
    shared = Path(planner).with_name("shared.py")
    at = shared.stat().st_mtime_ns
    plans = []
    for value in (1, 2):
        shared.write_text(f"VALUE = {value}\n")
        os.utime(shared, ns=(at, at))
        load_module.cache_clear()
        plans.append(load_module(planner).plan(None, None, tries=1))
    assert plans == ["11", "12"]


SOUND = "def plan(problem, rng, *, tries: int):\n    return None\n"
PLAN = ["plan", "room.txt", "--start", "0.5,0.5", "--target", "1.5,0.5"]
TRIES = ["--settings", "{tries: 1}"]


@pytest.mark.parametrize("ends", ["import", "plan"])
def test_command_whose_planner_exits_says_so(ends, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("room.txt").write_text("..\n")
    source = (
        f"import os\nos._exit(0)\n{SOUND}"
        if ends == "import"
        else SOUND.replace("return None", "import os; os._exit(0)")
    )
    Path("ends.py").write_text(source)
    for words, status in (
        ([*PLAN, "--method", "ends.py", *TRIES], 2),
        (["check-planner", "ends.py", *TRIES], 2 if ends == "import" else 1),
    ):
        ended, printed, told = call(capsys, *words)
        line = (told or printed)[0]
        assert ended == status
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
        ["verify", "none"],
    ],
)
def test_wrong_input_ends_every_command_with_status_2(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    status, _, told = call(capsys, *words)
    assert status == 2
    assert told


LIBRARIES = """
from __future__ import annotations
import multiprocessing, pickle
from dataclasses import dataclass
import numba
import numpy as np
from bezierplan.planners import Path, Plan

@numba.njit(cache=True)
def doubled(x):
    return 2.0 * x

@dataclass
class Node:
    cost: float

def plan(problem, rng):
    assert doubled(1.0) == 2.0
    assert type(pickle.loads(pickle.dumps(Node(1.0)))) is Node
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.map(doubled, [1, 2]) == [2, 4]
    pool.join()
    path = Path("polyline", np.array([problem.start, problem.target]))
    return Plan(path, 1.0, True, 1, np.array([1.0]), "one", {})
"""


def test_a_planner_may_use_libraries_each_time(tmp_path):
    """A kernel that numba keeps, what it pickles, its own functions in other processes: in one
    process after the other, since numba keeps a kernel for the next.
    """
    (tmp_path / "room.txt").write_text("..\n")
    (tmp_path / "uses.py").write_text(LIBRARIES)
    words = [sys.executable, "-m", "bezierplan", *PLAN, "--method", "uses.py"]
    for _ in range(2):
        done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("before", ["", "import sys; del sys.modules[__name__]\n"])
def test_a_file_that_fails_leaves_no_module(before, tmp_path):
    file = tmp_path / "fails.py"
    file.write_text(f"{before}1 / 0\n")
    with pytest.raises(ZeroDivisionError):
        load_planner(str(file))
    assert "study_fails" not in sys.modules


def test_a_planner_s_file_hides_no_library(tmp_path):
    file = tmp_path / "json.py"
    file.write_text(SOUND)
    load_planner(str(file))
    import json

    assert json.dumps([1]) == "[1]"


def test_an_interrupt_ends_the_workflow_that_a_command_has_started(tmp_path, monkeypatch):
    """And its jobs, though only the command is interrupted."""
    monkeypatch.chdir(tmp_path)
    __main__.main(["new", "mine"])
    slow = f"    from pathlib import Path\n    import time\n    Path({str(tmp_path / 'begun')!r})"
    planner = tmp_path / "mine" / "walk.py"
    lines = planner.read_text().splitlines()
    after = next(n for n, line in enumerate(lines) if line.startswith("def plan")) + 2
    lines[after:after] = [f"{slow}.touch()", "    time.sleep(600)"]
    planner.write_text("\n".join(lines))
    workflow = subprocess.Popen(
        [sys.executable, "-m", "bezierplan", "run", "mine", "--cores", "1"],
        # A shell's job in the background would leave it ignored.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    appear(tmp_path / "begun")
    workflow.send_signal(signal.SIGINT)
    told, _ = workflow.communicate(timeout=60)
    assert (workflow.returncode, told.splitlines()[-1]) == (
        130,
        "python -m bezierplan: interrupted",
    )
    # All that could still write has ended, for it would hold the pipe, and so has the lock.
    assert not any((tmp_path / ".snakemake" / "locks").glob("*"))
