"""Planners that are not in this package, each in a process of its own: a run is a file in and a
file out.

A command (`worker`) reads what to do from a file and appends lines to another one: the name of each
run that begins, and each answer, as plain values. Nothing else comes back. The process has its own
process group, an empty working folder, a fixed hash seed and limits; the time that it took is what
the operating system says.
"""

import json
import logging
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from bezierplan.places import PACKAGE
from bezierplan.planners import is_file
from bezierplan.running.guard import plain, worker
from bezierplan.running.jobs.watchdog import PlannerFailure, how_ended
from bezierplan.workspaces.worlds import to_json

logger = logging.getLogger(__name__)

MOST_PRINTED = 20_000
"""Characters of what a planner prints that come into the log."""

# Longest pause, in seconds, between two looks at whether a process is done.
_LOOK = 0.05
_STARTS = 60
"""Seconds that a process of runs has at least to start."""


def isolated_replies(
    work: worker.Work,
    tasks: Sequence[worker.Task],
    again: Sequence[worker.Task],
    name: str,
    limit: float | None = None,
    hashing: int = 0,
) -> Iterator[worker.Reply]:
    """`worker.replies` in a process of its own, with plain values; before them that of the last of
    `again` in a process with another seed of `hash`. hashing: that seed. Raises
    PlannerFailure as `answers` does.
    """
    if again:
        for each in isolated_replies(work, again[-1:], (), name, limit, hashing + 1):
            yield each._replace(number=-1)
    parts = work._asdict() | {
        "planner": str(Path(work.planner).resolve()) if is_file(work.planner) else work.planner,
        "problems": worker.packed_problems(work.problems),
        "worlds": {key: to_json(world) for key, world in (work.worlds or {}).items()},
        "tasks": tasks,
        "again": again,
    }
    for number, found, cpu, wall, drew in answers(
        "guard.worker.plain_answers", parts, name, limit, hashing, _STARTS
    ):
        with plain_values(name):
            yield worker.Reply(
                number, plain.unpacked(found), seconds(cpu), seconds(wall), bool(drew)
            )


def answers(
    work: str,
    arguments: dict[str, Any],
    name: str,
    limit: float | None = None,
    hashing: int = 0,
    starts: float = 0.0,
) -> list[Any]:
    """What a function answers in a process of its own.

    work: the function, as module and name in `bezierplan.running`; of a function to call with the
    name of each run that begins, and of `arguments`, it yields plain values. name: what messages
    begin with before that. limit: seconds for each run. hashing: seed of `hash`. starts:
    seconds that the process has at least until the first run begins, whatever the limit. Raises
    PlannerFailure, naming the run, if the function raises an exception, the process crashes, ends
    itself, takes too long or leaves others behind.
    """
    with tempfile.TemporaryDirectory(prefix="bezierplan-") as folder:
        job, lines, printed, empty = (
            Path(folder, part) for part in ("job.json", "answers.json", "printed.txt", "empty")
        )
        job.write_text(json.dumps({"work": work, "given": arguments, "name": name}))
        lines.touch()
        empty.mkdir()
        with printed.open("wb") as output:
            process = subprocess.Popen(
                [sys.executable, "-m", worker.__name__, job, lines],
                cwd=empty,
                env=os.environ | {"PYTHONHASHSEED": str(hashing), "PYTHONPATH": _path()},
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
            try:
                ended, took = _awaited(process, lines, limit, starts)
            finally:
                with suppress(ProcessLookupError, PermissionError):
                    os.killpg(process.pid, signal.SIGKILL)
                process.wait()
        _log(printed, name)
        return _read(lines, name, ended, took)


def _path() -> str:
    """Where the process finds this package, and what this one's environment names."""
    return os.pathsep.join(filter(None, [str(PACKAGE.parent), os.environ.get("PYTHONPATH", "")]))


def _awaited(
    process: subprocess.Popen, lines: Path, limit: float | None, starts: float
) -> tuple[str, float]:
    """How a process has ended, and its CPU seconds; it may take as long as `limit` from one line to
    the next, and at least `starts` until the first.
    """
    size, since, pause = -1, 0.0, 0.001
    while True:
        ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        if ended:
            process.returncode = os.waitstatus_to_exitcode(status)
            return how_ended(status), usage.ru_utime + usage.ru_stime
        if (now := lines.stat().st_size) != size:
            size, since = now, time.monotonic()
        elif limit is not None:
            allowed = limit if size else max(limit, starts)
            if time.monotonic() - since > allowed:
                return f"not done within the time limit of {allowed:g} s; it is ended", math.nan
        time.sleep(pause)
        pause = min(2 * pause, _LOOK)


def _log(printed: Path, name: str) -> None:
    """Show the first part of what a process has printed."""
    with printed.open("rb") as output:
        text = output.read(MOST_PRINTED).decode(errors="replace")
    if text.strip():
        more = printed.stat().st_size - MOST_PRINTED
        logger.warning(
            "%s prints:\n%s%s", name, text.rstrip(), f"... ({more} bytes more)" if more > 0 else ""
        )


def _read(lines: Path, name: str, end: str, took: float) -> list[Any]:
    """The answers among the lines of a process. Raises PlannerFailure."""
    answers_read, done = [], False
    with plain_values(name):
        # What follows the last line break was cut off.
        for line in lines.read_text(encoding="utf-8").split("\n")[:-1]:
            (kind, value), *_ = json.loads(line).items()
            if kind == "begins":
                name = str(value)
            elif kind == "answer":
                answers_read.append(value)
            elif kind == "fails":
                failure = PlannerFailure(str(value[0]))
                failure.add_note(str(value[1]))
                raise failure
            elif kind == "took":
                done = True
                by_clock = seconds(value)
    if not done:
        raise PlannerFailure(f"{name}: {end}")
    # A process's own account may differ from the operating system's by a tenth, or by a second.
    if not math.isclose(by_clock, took, rel_tol=0.1, abs_tol=1.0):
        raise PlannerFailure(
            f"{name}: its process took {took:.3g} CPU seconds, by its own clock {by_clock:.3g}; "
            "a planner leaves clocks alone"
        )
    return answers_read


@contextmanager
def plain_values(name: str) -> Iterator[None]:
    """A block that reads lines of a process. Raises PlannerFailure for one that is none of ours."""
    try:
        yield
    except (ValueError, TypeError, LookupError, AttributeError):
        raise PlannerFailure(f"{name}: its process does not answer with plain values") from None


def seconds(value: Any) -> float:
    """A number of seconds. Raises ValueError for what is none."""
    if not (isinstance(value, float) and 0 <= value < math.inf):
        raise ValueError(f"{value!r} are no seconds")
    return value
