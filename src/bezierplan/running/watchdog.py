"""Work in a process that another one watches, so that nothing it does can end, stall or outlive the
job in silence.

Code of planners can do anything: exit, crash, loop in a compiled kernel that never yields to
Python, or leave processes behind. So a process that may meet such code goes on in a child
(`supervise`) and itself only waits: it knows how the child ends, what was under way, and for how
long, and it kills whatever the child leaves. A pipe tells it which run has begun, which costs a run
two short writes.
"""

import contextlib
import ctypes
import math
import os
import select
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

from bezierplan.schema.words import told

PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36
# Seconds between two looks at whether the child is there: while its end of the pipe is open, which
# another process may hold, and after.
_LOOK, _CLOSED = 1.0, 0.005
# How often the kernel's list of children is read until it shows one that is known to be there.
_LOOKS = 20
# Seconds that a process has for ending after its work is done: threads that a planner left running
# would keep an interpreter for ever.
_ENDING = 10.0
# Seconds for which what a planner leaves is killed, though it starts anew.
_KILLING = 1.0
# What a child tells last: that its end, good or bad, needs no more words.
_SETTLED = "settled"

_pipe: int | None = None
"""The end of the pipe that this process writes to; None if nobody watches it."""


def end_with_parent() -> None:
    """Have the kernel end this process when its parent ends, so that no job keeps writing after its
    workflow is killed (Linux only).
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def forked() -> int:
    """Fork this process: its number, and 0 in the child, which ends with this process, leaves the
    user's interrupt to it, and becomes the parent of whatever its own children leave.
    """
    flush()
    child = os.fork()
    if child == 0:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        end_with_parent()
        _adopt()
    return child


def supervise(name: str, report: Callable[[str], None]) -> None:
    """Return in a child of this process; the process itself waits for it and ends as it does.

    report: called, in this process, with a line that begins with what was under way, or with `name`
    if nothing was: if the child ends before it is settled (`settle`), or takes longer than it may
    (`watching`). Then the status is 1. Processes that the child leaves are killed.
    """
    global _pipe
    flush()
    heard, ours = os.pipe()
    child = os.fork()
    if child:
        os.close(ours)
        _wait(child, heard, name, report)
    os.close(heard)
    _pipe = ours
    signal.signal(signal.SIGINT, _interrupt)
    end_with_parent()
    _adopt()


class Interrupted(KeyboardInterrupt):
    """The user's interrupt, which a KeyboardInterrupt of a planner is not."""


def _interrupt(*_: Any) -> NoReturn:
    # The process that watches passes on what a terminal has sent to both.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    raise Interrupted


def settle(status: int = 0) -> None:
    """Tell that this process ends as it should, or has said why it does not, and with which exit
    status: what a planner has left, such as a thread or an exit handler, may end it with another.
    """
    _tell(f"{_SETTLED} {status}")


@contextmanager
def watching(limit: float | None) -> Iterator[Callable[[str], None]]:
    """Yield a function to call with the name of a run when it begins, and with an empty text when
    it ends.

    A run longer than `limit` seconds ends this process, if it is supervised; None is no limit.
    """
    yield lambda begun: _tell(f"{math.inf if limit is None else limit} {begun}" if begun else "")


class PlannerFailure(RuntimeError):
    """What a planner does that no result may come from; the message names planner and run."""


@contextmanager
def executing(name: str, watch: Callable[[str], None]) -> Iterator[None]:
    """A block that executes code of a planner, of which `name` tells the planner and what it does.

    watch: as yielded by `watching`. Raises PlannerFailure, beginning with the name, for any
    exception and for processes that the block leaves behind, which are ended.
    """
    before = children()
    watch(name)
    try:
        with contextlib.chdir("."):  # one that leaves this folder would take files along
            yield
    except (Interrupted, PlannerFailure):
        raise
    # Code of unknown origin may raise anything, SystemExit and KeyboardInterrupt included.
    except BaseException as error:
        end_children(before)
        raise PlannerFailure(f"{name}: {told(error)}") from error
    finally:
        watch("")
    if children() - before:
        end_children(before)
        raise PlannerFailure(f"{name}: {LEFT}")


def children() -> frozenset[int]:
    """The processes that this one has started, or inherited as the last one responsible, and that
    have not ended (on Linux; elsewhere none is known).

    The process in which Python's multiprocessing keeps track of shared memory is none of them: it
    ends by itself.
    """
    if sys.platform != "linux":
        return frozenset()
    try:
        ended = os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:  # the usual case: a thousand of these calls take a millisecond
        return frozenset()
    tracker = getattr(
        getattr(sys.modules.get("multiprocessing.resource_tracker"), "_resource_tracker", None),
        "_pid",
        None,
    )
    found = _listed()
    for _ in range(_LOOKS):
        if found or ended:
            break
        time.sleep(_CLOSED)  # there is one, but the list may lack it while others end
        found = _listed()
    return frozenset(child for child in found if child != tracker and not is_dead(child))


def _listed() -> set[int]:
    """The processes that the kernel lists as children of this one."""
    listed: set[int] = set()
    for file in Path("/proc/self/task").glob("*/children"):
        with contextlib.suppress(OSError):  # a thread may have ended by now
            listed |= set(map(int, file.read_text().split()))
    return listed


def end_children(spared: frozenset[int] = frozenset()) -> None:
    """Kill the processes that this one has started, and theirs, but for some; for a while, since a
    thread may start further ones.
    """
    until = time.monotonic() + _KILLING
    while (left := children() - spared) and time.monotonic() < until:
        for child in left:
            with contextlib.suppress(ProcessLookupError, ChildProcessError):
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)


def flush() -> None:
    """Print what a fork would print again. A process may have been started without streams."""
    for stream in filter(None, (sys.stdout, sys.stderr)):
        stream.flush()


def verdict(name: str, judge: Callable[[], str], limit: float) -> str:
    """What a function says that is called in a process of its own, which cannot harm this one; or,
    beginning with `name`, how the process ended instead. limit: seconds that it may take. What it
    prints is lost. On Linux; elsewhere it is called in this process.
    """
    if sys.platform != "linux":  # a fork of a process that has loaded libraries of macOS may crash
        return judge()
    heard, ours = os.pipe()
    flush()
    supervisor = os.fork()
    if supervisor == 0:
        _judge(name, judge, limit, lambda line: os.write(ours, line.encode()))
    os.close(ours)
    try:
        with os.fdopen(heard, "rb") as stream:
            said = stream.read().decode()
    except BaseException:
        os.kill(supervisor, signal.SIGKILL)
        raise
    finally:
        os.waitpid(supervisor, 0)
    return said


def _judge(
    name: str, judge: Callable[[], str], limit: float, say: Callable[[str], object]
) -> NoReturn:
    try:
        end_with_parent()
        supervise(name, say)
        with open(os.devnull, "r+b") as nothing:
            for stream in range(3):
                os.dup2(nothing.fileno(), stream)
        with watching(limit) as watch:
            watch(name)
            said = judge()
        say(f"{name}: {LEFT}" if children() else said)
        settle()
    finally:
        os._exit(0)


LEFT = "leaves a process behind, which is ended; end or join what it starts"
"""What is said of one that leaves a process behind."""


def _tell(text: str) -> None:
    if _pipe is not None:
        with contextlib.suppress(OSError):  # a planner may have closed it
            os.write(_pipe, f"{text}\n".encode())


def _forget() -> None:
    """A fork is not watched; if it held the pipe, the watched process's end would go unnoticed."""
    global _pipe
    if _pipe is not None:
        os.close(_pipe)
        _pipe = None


os.register_at_fork(after_in_child=_forget)


def _adopt() -> None:
    """Become the parent of all processes below this one whose own parent ends (Linux only)."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)


def _wait(child: int, heard: int, name: str, report: Callable[[str], None]) -> NoReturn:
    """Wait for a child, report what it does not say itself, and end as it does. What interrupts or
    terminates this process is passed on to the child.
    """
    passed_on: list[int] = []

    def pass_on(number: int, _: Any) -> None:
        passed_on.append(number)
        with contextlib.suppress(ProcessLookupError):
            os.kill(child, number)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, pass_on)
    _adopt()
    code = 1
    try:
        line, code = _heard(child, heard, name)
        end_children()
        if line and passed_on:  # what ended it is known
            code = 128 + passed_on[-1]
        elif line:
            report(line)
    finally:
        os._exit(code)


def _heard(child: int, heard: int, name: str) -> tuple[str, int]:
    """What is to be reported of a child that has ended, or is ended here, and the exit status."""
    pipes, rest, last, limit, until, ended, status = [heard], b"", "", math.inf, math.inf, 0, 0
    settled = False
    while True:
        if not ended:
            ended, status = os.waitpid(child, os.WNOHANG)
        pause = 0.0 if ended else min(_LOOK if pipes else _CLOSED, until - time.monotonic())
        if select.select(pipes, [], [], max(0.0, pause))[0]:
            told = os.read(heard, 1 << 16)
            pipes = pipes if told else []
            *lines, rest = (rest + told).split(b"\n")
            if lines:
                last = lines[-1].decode()
                settled = last.startswith(_SETTLED)
                limit = _ENDING if settled else float(last.split(" ", 1)[0] or math.inf)
                until = time.monotonic() + limit
            continue
        intended = int(last.split(" ", 1)[1]) if settled else 0
        under_way = last.split(" ", 1)[1] if last and not settled else name
        if ended:
            return (
                ("", status_code(status) or intended)
                if settled
                else (f"{under_way}: {how_ended(status)}", 1)
            )
        if time.monotonic() >= until:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return (
                ("", intended)
                if settled
                else (f"{under_way}: not done within the time limit of {limit:g} s; it is ended", 1)
            )


def awaited(child: int) -> str:
    """How a child ends, in words, once it does. It stays to be waited for, so that no other process
    gets its number.
    """
    ended = os.waitid(os.P_PID, child, os.WEXITED | os.WNOWAIT)
    exited = ended.si_code == os.CLD_EXITED
    return how_ended(ended.si_status << 8 if exited else ended.si_status)


def how_ended(status: int) -> str:
    """How a process ended before its work was done, from what the operating system says of it."""
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        name = signal.Signals(number).name if number in set(signal.Signals) else f"number {number}"
        cause = (
            ", by itself, by another program, or for want of memory"
            if number == signal.SIGKILL
            else ""
        )
        return f"its process was ended by signal {name}{cause}"
    return (
        f"its process ended itself with exit status {os.waitstatus_to_exitcode(status)}, "
        "before it was done"
    )


def status_code(status: int) -> int:
    """The exit status of a process that ends as another one did."""
    code = os.waitstatus_to_exitcode(status)
    return code if code >= 0 else 128 - code


def is_dead(process: int) -> bool:
    """Whether a process has ended (Linux only)."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] in "ZX"
    except OSError:
        return True
