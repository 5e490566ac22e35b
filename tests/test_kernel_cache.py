"""Kernels that several processes need at the same time: one process compiles them, and nothing that
happens to it stops the others.
"""

import fcntl
import os
import signal
import subprocess
import sys
import time
from functools import partial

import pytest
import starts
from starts import appear

from bezierplan.machine import kernel_cache

MODULE = """
from bezierplan.kernels import compile_kernel

@compile_kernel
def inner(x):
    return x + 1

@compile_kernel
def outer(x):
    return inner(x) * 2

@compile_kernel
def constant(x):
    return inner(1) + inner(x)

@compile_kernel
def wrong(x):
    return x + "a"
"""

START = """
import os, sys, time
from functools import partial
from pathlib import Path
from bezierplan.machine import kernel_cache
kernel_cache.FOLDERS = [Path("kernels").resolve()]
import kernels_of_mine as mine
from bezierplan.running.jobs.forks import compile_first
from numba.core import event
compile_first()
Path(f"ready-{os.getpid()}").touch()
while not Path("go").exists():
    time.sleep(0.001)
"""
CALL = """
answer = mine.outer(20)
print(answer, *(sum(kernel.stats.cache_misses.values()) for kernel in (mine.outer, mine.inner)))
"""
REPORT = """
class Report(event.Listener):
    def on_start(self, started):
        Path("{name}").touch()
        time.sleep({seconds})
    def on_end(self, ended):
        pass
event.register("numba:compile", Report())
"""


@pytest.fixture
def start(tmp_path):
    """Starts processes, which run some code once the file `go` is there, in a folder with a module
    of kernels and without compiled ones.
    """
    (tmp_path / "kernels_of_mine.py").write_text(MODULE)
    started = []

    def start_one(code):
        environment = os.environ | {"PYTHONPATH": f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}"}
        started.append(
            subprocess.Popen(
                [sys.executable, "-c", START + code],
                cwd=tmp_path,
                env=environment,
                stdout=subprocess.PIPE,
                text=True,
            )
        )
        appear(tmp_path / f"ready-{started[-1].pid}")
        return started[-1]

    yield start_one
    for process in started:
        process.kill()
        process.communicate()


def test_one_of_two_processes_compiles(start, tmp_path):
    both = [start(CALL), start(CALL)]
    (tmp_path / "go").touch()
    answers = [process.communicate(timeout=120)[0].split() for process in both]
    # Who loads the outer kernel never asks for the inner one.
    assert sorted(answers) == [["42", "0", "0"], ["42", "1", "1"]]


def test_a_constant_compiles_nothing_twice(start, tmp_path):
    """numba alone would compile the inner kernel for any integer and for this one."""
    process = start("print(mine.constant(20), len(mine.inner.signatures))")
    (tmp_path / "go").touch()
    assert process.communicate(timeout=120)[0].split() == ["23", "1"]


def test_a_process_that_is_killed_while_it_compiles_holds_up_nobody(start, tmp_path):
    killed = start(REPORT.format(name="compiling", seconds=600) + CALL)
    (tmp_path / "go").touch()
    appear(tmp_path / "compiling")
    other = start(REPORT.format(name="compiling too", seconds=0) + CALL)
    time.sleep(2)
    assert not (tmp_path / "compiling too").exists()
    os.kill(killed.pid, signal.SIGKILL)
    assert other.communicate(timeout=120)[0].split() == ["42", "1", "1"]


def test_a_kernel_that_cannot_be_compiled_leaves_no_lock(start, tmp_path):
    failing = start(
        "try:\n    mine.wrong(1)\nexcept Exception as e:\n    print(type(e).__name__, "
        "flush=True)\ntime.sleep(600)"
    )
    (tmp_path / "go").touch()
    assert failing.stdout.readline() == "TypingError\n"
    assert start(CALL).communicate(timeout=120)[0].split() == ["42", "1", "1"]


def test_a_process_that_holds_a_lock_does_not_wait_for_ever(tmp_path, monkeypatch):
    monkeypatch.setattr(kernel_cache, "PATIENCE", 0.2)
    above, below, held = tmp_path / "above", tmp_path / "below", []
    below.mkdir()
    with open(below / "lock", "w") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        alone = partial(kernel_cache._lock_alone, locks=held)
        with alone(above), alone(below), alone(above):
            assert held == [above, below]
    assert held == []


def test_a_file_system_without_locks(tmp_path, monkeypatch):
    def refuse(*_):
        raise OSError("no locks available")

    held = []
    monkeypatch.setattr(fcntl, "flock", refuse)
    with kernel_cache._lock_alone(tmp_path, held):
        assert held == [tmp_path]


# A kernel of another library, which keeps it beside its source; and what the process has of numba's
# own before and after a plan.
FOREIGN = """
import numba
@numba.njit(cache=True)
def twice(x):
    return 2 * x
"""
BESIDE = """
import os
from numba.core import caching, config, dispatcher
def state():
    classes = (caching.Cache, caching.CacheImpl, caching.IndexDataCacheFile, dispatcher.Dispatcher)
    variables = {name: value for name, value in os.environ.items() if name.startswith("NUMBA")}
    settings = config.CACHE_DIR, config.CACHE_LOCATOR_CLASSES
    return [vars(each).copy() for each in classes], variables, settings
before = state()
import bezierplan
from bezierplan.__main__ import main
import foreign
(room := __import__("pathlib").Path("room.txt")).write_text("....\\n.##.\\n....\\n")
main(["plan", "room.txt", "--start", "0.5,0.5", "--target", "3.5,2.5"])
twice = foreign.twice
print(twice(21), twice._cache.cache_path, sum(twice.stats.cache_hits.values()), state() == before)
"""


def test_kernels_of_other_libraries_are_left_alone(tmp_path):
    """They are kept where numba keeps them, by numba's own methods, and no variable of the
    environment is set.
    """
    (tmp_path / "foreign.py").write_text(FOREIGN)
    for hits in ("0", "1"):
        assert starts.python(BESIDE, tmp_path, tmp_path).splitlines()[-1].split() == [
            "42",
            str(tmp_path / "__pycache__"),
            hits,
            "True",
        ]
    assert list((tmp_path / "__pycache__").glob("foreign.twice*.nbc"))


def test_old_kernels_leave_room_for_new_ones(tmp_path):
    for age in range(3):
        state = tmp_path / str(age)
        state.mkdir()
        (state / "kernel").write_bytes(bytes(100))
        os.utime(state, (time.time() - 90_000 * age,) * 2)
    for most, left in ((250, "01"), (50, "0")):
        kernel_cache.remove_old(tmp_path, most)
        assert {state.name for state in tmp_path.iterdir()} == {*left}


def test_kernels_are_compiled_where_none_can_be_kept(tmp_path):
    (tmp_path / "kernels_of_mine.py").write_text(MODULE)
    (tmp_path / "a file").touch()
    code = (
        "from pathlib import Path\nfrom bezierplan.machine import kernel_cache\n"
        "kernel_cache.FOLDERS = [Path('a file')]\n"
    )
    code += "import kernels_of_mine\nprint(kernels_of_mine.outer(20))"
    assert starts.python(code, tmp_path, tmp_path) == "42\n"


def test_numpy_takes_code_for_the_family_of_processors_as_kernels_do():
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    assert not [
        name
        for name in __cpu_dispatch__
        if __cpu_features__[name] and (name.startswith("AVX512") or name == "X86_V4")
    ]
    is_v3 = os.environ["NUMBA_CPU_NAME"] == "x86-64-v3"
    assert os.environ.get("OPENBLAS_CORETYPE") == ("Haswell" if is_v3 else None)


def test_a_command_begins_without_numpy():
    """What numpy reads when it is imported must be set before."""
    source = "import sys, bezierplan.__main__; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", source], check=False).returncode == 0
