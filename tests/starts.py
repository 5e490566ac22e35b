"""Starts of Python; and for tests that need many, of Snakemake: forks of a process that has
imported all that a workflow needs, for imports take most of the time of a small one. The processes
that the workflow starts, that of its jobs and those of planners, are forks as well.
"""

import cProfile
import importlib
import inspect
import logging
import multiprocessing
import os
import runpy
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from functools import partial
from multiprocessing import resource_tracker
from pathlib import Path
from subprocess import CompletedProcess
from typing import Any, NoReturn
from unittest.mock import patch

# pyarrow, which pandas imports, would start a thread: see `bezierplan.running.jobs.forks`.
_SERVER = {
    "JE_ARROW_MALLOC_CONF": "background_thread:false",
    "PYTHONPATH": f"{os.environ['PYTHONPATH']}{os.pathsep}{Path(__file__).parent}",
}
_STARTS = multiprocessing.get_context("forkserver")
_STARTS.set_forkserver_preload(["preloaded"])


def python(code: str, folder: Path, *homes: Path, **variables: str) -> str:
    """What some code prints in a process of its own, which works in a folder. homes: where it finds
    modules before others. variables: of its environment.
    """
    path = os.pathsep.join(map(str, [*homes, os.environ["PYTHONPATH"]]))
    ended = subprocess.run(
        [sys.executable, "-c", code],
        cwd=folder,
        env=os.environ | variables | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def appear(file: Path, seconds: float = 120) -> None:
    """Wait for a file that another process makes."""
    until = time.monotonic() + seconds
    while not file.exists():
        assert time.monotonic() < until, file
        time.sleep(0.01)


class Fork(subprocess.Popen):
    """A process that is a fork of this one if a workflow starts it for its jobs or for a planner.
    Then its `hash` has the seed of this one: `test_contract` and `test_verify` have planners that
    depend on it.
    """

    MODULES = ("bezierplan.running.jobs.forks", "bezierplan.running.guard.worker")

    def _execute_child(self, *given: Any) -> None:
        how = inspect.signature(super()._execute_child).bind(*given).arguments
        _, *words = map(os.fspath, how["args"])
        if words[:1] != ["-m"] or words[1] not in self.MODULES:
            super()._execute_child(*given)
            return
        self.pid = os.fork()
        if not self.pid:
            _execute(words[1:], how)
        pipes = ("p2cread", "p2cwrite", "c2pread", "c2pwrite", "errread", "errwrite")
        self._close_pipe_fds(*(how[name] for name in pipes))


def _execute(words: list[str], how: dict[str, Any]) -> NoReturn:
    """Execute a module with some words in this process, as an interpreter of its own would; how:
    what `subprocess.Popen` was asked for.
    """
    status = 1
    try:
        for number, name in enumerate(("p2cread", "c2pwrite", "errwrite")):
            if how[name] != -1:
                os.dup2(how[name], number)
        os.closerange(3, os.sysconf("SC_OPEN_MAX"))
        if how["start_new_session"]:
            os.setsid()
        os.chdir(how["cwd"] or ".")
        resource_tracker._resource_tracker.__init__()  # it has lost the process that it talks to
        # What this process has read is nothing that the other one has.
        importlib.import_module("bezierplan.machine.opened_files").SEEN.clear()
        os.environ.clear()
        os.environ.update(how["env"])
        sys.path[:0] = os.environ["PYTHONPATH"].split(os.pathsep)
        sys.argv = words
        signal.signal(signal.SIGINT, signal.default_int_handler)
        for number in (signal.SIGTERM, signal.SIGCHLD):
            signal.signal(number, signal.SIG_DFL)
        sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w", 1)
        for logger in (logging.root, logging.getLogger("bezierplan.under_way")):
            logger.handlers.clear()
        warnings.simplefilter("ignore", RuntimeWarning)  # the module was imported before
        runpy.run_module(words[0], run_name="__main__", alter_sys=True)
        status = 0
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        os._exit(status)


def snakemake(
    folder: Path,
    *words: str,
    calls: Path | None = None,
    constants: dict[str, object] | None = None,
) -> CompletedProcess:
    """Run `python -m snakemake` with some words in a folder; its exit code and what it printed, as
    text. Its calls of functions are counted in a file, if one is given, as cProfile writes it.
    constants: those of this tree's modules that get another value beforehand, by dotted name.
    """
    with tempfile.TemporaryDirectory() as kept:
        printed = [Path(kept, name) for name in ("output", "errors")]
        start = _STARTS.Process(target=_run, args=(folder, words, printed, calls, constants or {}))
        with patch.dict(os.environ, _SERVER):
            start.start()
        start.join()
        output, errors = (file.read_text() for file in printed)
    return CompletedProcess(words, start.exitcode, output, errors)


def make(folder: Path, study: str, *words: str, **options: Any) -> CompletedProcess:
    """Run this tree's workflow for a study in a folder, as `snakemake` does."""
    workflow = ("-s", Path(__file__).parents[1] / "Snakefile", "--workflow-profile", "none")
    chosen = ("--cores", "2", "--config", f"studies=[{folder / study}]")
    return snakemake(folder, *workflow, *words, *chosen, **options)


def _run(
    folder: Path,
    words: tuple[str, ...],
    printed: list[Path],
    calls: Path | None,
    constants: dict[str, object],
) -> None:
    from snakemake.cli import main

    os.chdir(folder)
    workflow, *_ = [*(each for each in map(str, words) if each.endswith("Snakefile")), "Snakefile"]
    tree = Path(workflow).resolve().parent
    if tree != Path(__file__).parents[1] and (tree / "src").exists():  # a copy has its own modules
        for name in [name for name in sys.modules if name.partition(".")[0] == "bezierplan"]:
            del sys.modules[name]
    subprocess.Popen = Fork
    sys.argv = ["snakemake", *map(str, words)]  # which the workflow reads
    for number, file in enumerate(printed, start=1):
        os.dup2(os.open(file, os.O_WRONLY | os.O_CREAT), number)
    for name, value in constants.items():
        module, _, constant = name.rpartition(".")
        setattr(importlib.import_module(module), constant, value)
    command = partial(main, sys.argv[1:])
    if calls is None:
        command()
    else:
        profile = cProfile.Profile()
        try:
            profile.runcall(command)
        finally:
            profile.dump_stats(calls)
