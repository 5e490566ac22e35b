"""Starts of Python; and of Snakemake for tests that need many: forks of a process that has imported
it, for imports take two thirds of the time of a dry run. Modules of this package are not among
them: each start takes those of its own tree.
"""

import cProfile
import importlib
import multiprocessing
import os
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from subprocess import CompletedProcess
from unittest.mock import patch

_MODULES = [
    *(
        "snakemake.cli",
        "snakemake.dag",
        "snakemake.executors.dryrun",
        "snakemake.scheduling.greedy",
        "snakemake_logger_plugin_rich",
    ),
    *(
        "docutils.core",
        "jinja2",
        "numba",
        "pandas",
        "pydantic",
        "requests",
        "rich.progress",
        "smart_open",
        "yaml",
    ),
]
# pyarrow, which pandas imports, would start a thread: see `bezierplan.running.jobs.forks`, which is
# not imported, for a tree has its own.
_ONE_THREAD = {"JE_ARROW_MALLOC_CONF": "background_thread:false"}
# On Linux and macOS; elsewhere each start imports anew, with the same result.
_METHOD = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
_STARTS = multiprocessing.get_context(_METHOD)
if _METHOD == "forkserver":
    _STARTS.set_forkserver_preload(_MODULES)


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
        with patch.dict(os.environ, _ONE_THREAD):
            start.start()
        start.join()
        output, errors = (file.read_text() for file in printed)
    return CompletedProcess(words, start.exitcode, output, errors)


def _run(
    folder: Path,
    words: tuple[str, ...],
    printed: list[Path],
    calls: Path | None,
    constants: dict[str, object],
) -> None:
    from snakemake.cli import main

    os.chdir(folder)
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
