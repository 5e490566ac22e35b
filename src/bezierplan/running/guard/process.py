"""Run planners that are not in this package in separate processes: a run is a file in and a file
out.

A command (`worker`) reads its work from a file and appends lines to another one: the name of each
run that begins, and each answer, as plain values. Nothing else comes back. The process has its own
process group, an empty working folder, a fixed hash seed and limits.
"""

import json
import logging
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from bezierplan.machine import opened_files
from bezierplan.places import PACKAGE
from bezierplan.running.guard import plain_values, worker
from bezierplan.running.jobs.watchdog import PlannerFailure, describe_end

logger = logging.getLogger(__name__)

MOST_PRINTED = 20_000
"""Most bytes of a planner's own output that the log keeps."""

STARTS = 60.0
"""Seconds that a process may take to import a planner's file, and at least until its first run
begins: a study's time limit may be shorter than Python and numba take to start on a busy machine.
"""

# Longest pause, in seconds, between two looks at whether a process is done.
_LOOK = 0.05


def run_isolated(
    work: worker.Work,
    tasks: Sequence[worker.Task],
    again: Sequence[worker.Task],
    name: str,
    limit: float | None = None,
    hashing: int = 0,
) -> Iterator[worker.Reply]:
    """Run tasks in a separate process, as `worker.run_tasks` does; yield replies with plain values.

    The last task of `again` runs first, in a process with another seed of `hash`. hashing: the seed
    of `hash` for the others. Raises PlannerFailure as `run_function` does.
    """
    if again:
        for each in run_isolated(work, again[-1:], (), name, limit, hashing + 1):
            yield each._replace(number=-1)
    work = work._replace(planner=str(Path(work.planner).resolve()))
    todo = partial(worker.yield_plain_answers, work=work, tasks=tasks, again=again)
    for each in run_function(todo, name, limit, hashing):
        reply = worker.Reply(*each)
        yield reply._replace(result=plain_values.unpack(reply.result))


def run_function(
    work: Callable[[Callable[[str], None]], Iterator[Any]],
    name: str,
    limit: float | None,
    hashing: int = 0,
) -> list[Any]:
    """Call a function in a separate process, and return what it yields.

    work: the function. It gets another one to call with the name of each run that begins, and
    yields plain values. name: how messages begin before the first run. limit: seconds for each run;
    until the first begins, at least `STARTS`. hashing: seed of `hash`. Raises PlannerFailure,
    naming the run, if the function raises an exception, or the process crashes, ends itself, takes
    too long or leaves others behind.
    """
    with tempfile.TemporaryDirectory(prefix="bezierplan-") as folder:
        job, lines, printed, empty = (
            Path(folder, part) for part in ("job.pickle", "answers.json", "printed.txt", "empty")
        )
        # Protocol 5 keeps read-only arrays read-only.
        job.write_bytes(pickle.dumps((name, work), protocol=5))
        lines.touch()
        empty.mkdir()
        # This package first, then what the PYTHONPATH of this environment has.
        python_path = [str(PACKAGE.parent), os.environ.get("PYTHONPATH", "")]
        own = {"PYTHONPATH": os.pathsep.join(filter(None, python_path))}
        # Into a file: nobody would empty a pipe, and a planner that prints much would stall.
        with printed.open("wb") as output:
            process = subprocess.Popen(
                [sys.executable, "-m", worker.__name__, job, lines],
                cwd=empty,
                env=os.environ | own | {"PYTHONHASHSEED": str(hashing)},
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
            try:
                ended = _await_end(process, lines, limit)
            finally:
                with suppress(ProcessLookupError, PermissionError):
                    # The whole group, so nothing that the planner has started goes on.
                    os.killpg(process.pid, signal.SIGKILL)
                process.wait()
        _log(printed, name)
        return _read(lines, name, ended)


def _await_end(process: subprocess.Popen, lines: Path, limit: float | None) -> str:
    """Wait for the end of a process, and describe it.

    limit: seconds from one line to the next, after which the process is ended.
    """
    size, since, pause = -1, 0.0, 0.001
    # No system call waits for the end of a process and for a line of a file at once.
    while process.poll() is None:
        if (now := lines.stat().st_size) != size:
            size, since = now, time.monotonic()
        elif limit is not None:
            allowed = limit if size else max(limit, STARTS)
            if time.monotonic() - since > allowed:
                return f"not done within the time limit of {allowed:g} s; it is ended"
        # The pause grows, so that a short run is noticed at once.
        time.sleep(pause)
        pause = min(2 * pause, _LOOK)
    return describe_end(process.returncode)


def _log(printed: Path, name: str) -> None:
    """Log the first part of what a process has printed."""
    with printed.open("rb") as output:
        text = output.read(MOST_PRINTED).decode(errors="replace")
    if text.strip():
        more = printed.stat().st_size - MOST_PRINTED
        logger.warning(
            "%s prints:\n%s%s", name, text.rstrip(), f"... ({more} bytes more)" if more > 0 else ""
        )


def _read(lines: Path, name: str, end: str) -> list[Any]:
    """Return the answers among the lines of a process. Raises PlannerFailure, with a line for each
    run that fails.
    """
    replies, failures = [], {}
    # What follows the last line break was cut off.
    for line in lines.read_text(encoding="utf-8").split("\n")[:-1]:
        ((kind, value),) = json.loads(line).items()
        if kind == "begins":
            name = value
        elif kind == "answer":
            replies.append(value)
        elif kind == "fails":
            failures.setdefault(*value)
        else:
            opened_files.SEEN.update(value)
            break
    else:
        # Without its last line, the process did not come to its end.
        failures[f"{name}: {end}"] = ""
    if not failures:
        return replies
    failure = PlannerFailure("\n".join(failures))
    failure.add_note("\n".join(failures.values()))
    raise failure
