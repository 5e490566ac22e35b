"""Where the time of a workflow goes: what each job notes of its CPU time, and Snakemake of its own.

A job writes one line into its log at its end, Snakemake one file at the end of a start. Nothing
else depends on either.
"""

import importlib
import json
import os
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

WORD = "effort"
"""The word in a log before a job's note."""
SESSION = Path(".snakemake/effort.json")

# Seconds within which the last fork, which has told that it is done, has ended.
_LAST_FORK = 2.0

spent: Counter[str] = Counter()
"""CPU seconds of this process `importing`, `loading kernels` and `compiling`, and seconds of the
clock `waiting` for kernels that another one compiles.
"""
_busy: list[str] = []


class Session(NamedTuple):
    """A start of Snakemake: when it started and ended, on how many cores, and the CPU seconds of
    its own process, of the one that is forked for jobs, and of these forks from their first to
    their last moment.
    """

    started: float
    ended: float
    cores: int
    snakemake: float
    forked: float
    forks: float = 0.0


@contextmanager
def spending(kind: str) -> Iterator[None]:
    """Add the CPU time of a block to a kind, unless it is part of another such block."""
    if _busy:
        yield
        return
    _busy.append(kind)
    start = time.process_time()
    try:
        yield
    finally:
        spent[kind] += time.process_time() - start
        _busy.pop()


def _timed(load: Callable[[Any], Any]) -> Callable[[Any], Any]:
    def timed(spec: Any) -> Any:
        with spending("importing"):
            return load(spec)

    return timed


def begin() -> None:
    """Start to note what this process spends, imports included. What a parent spent before this
    process was forked is the parent's.
    """
    spent.clear()
    # There is no public hook around the loading of a module; without this one the time counts as
    # the job's own.
    bootstrap = importlib._bootstrap
    if hasattr(bootstrap, "_load_unlocked"):
        bootstrap._load_unlocked = _timed(bootstrap._load_unlocked)


def line() -> str:
    """What this process notes of its CPU time so far, that of its children included: one line."""
    children = os.times()
    cpu = time.process_time() + children.children_user + children.children_system
    return f"{WORD} {json.dumps({'cpu': cpu, **spent})}"


def of_job(log: Path) -> dict[str, float] | None:
    """What a job noted in its log; None if it noted nothing."""
    try:
        lines = log.read_text(encoding="utf-8").splitlines()
    except OSError:
        return None
    noted = [text.split(f" {WORD} ", 1)[1] for text in lines if f" {WORD} " in text]
    return json.loads(noted[-1]) if noted else None


def keep(cores: int, forked: int | None) -> None:
    """Note the effort of Snakemake, in whose process this is called, at its end. forked: number of
    the process that is forked, if any.

    A note that cannot be made is left out, for the workflow has ended well.
    """
    import psutil

    snakemake, parent, forks, ended = psutil.Process(), 0.0, 0.0, time.time()
    with suppress(psutil.Error):  # that process may have been killed
        if forked:
            process = psutil.Process(forked)
            while process.children() and time.time() < ended + _LAST_FORK:
                time.sleep(0.01)
            times = process.cpu_times()
            parent, forks = times.user + times.system, times.children_user + times.children_system
    times = snakemake.cpu_times()
    with suppress(OSError):
        SESSION.write_text(
            json.dumps(
                Session(
                    snakemake.create_time(), ended, cores, times.user + times.system, parent, forks
                )._asdict()
            )
        )


def last(folder: Path) -> Session:
    """The last start of Snakemake in a folder that ended well. Raises FileNotFoundError."""
    return Session(**json.loads((folder / SESSION).read_text()))
