"""Planners of a reader's own, with modules of the reader's own beside them."""

import subprocess
import sys

import pytest

from bezierplan import __main__
from bezierplan.planners import planner_module
from bezierplan.running import interface, watchdog
from bezierplan.schema import checked

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
        "--planner",
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
        ["forecast", "none"],
        ["check-planner", "none"],
        ["plan", "none.txt"],
        ["verify-outcome", "none"],
        ["outcome", "none"],
    ],
)
def test_wrong_input_ends_every_command_with_status_2(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        __main__.main(words)
    assert ended.value.code == 2
    assert capsys.readouterr().err
