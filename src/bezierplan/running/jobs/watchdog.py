"""How processes that execute planners end, and the messages about it."""

import ctypes
import logging
import resource
import signal
import sys
import time

PR_SET_PDEATHSIG = 1

UNDER_WAY = logging.getLogger("bezierplan.under_way")
"""Gets the time limit and the name of each run that a job begins; `forks` listens."""
# Otherwise the log of a job would have a line for each run.
UNDER_WAY.propagate = False
UNDER_WAY.setLevel(logging.INFO)

LEFT = "leaves a process behind, which is ended; end or join what it starts"
"""Message about a planner that leaves a process behind."""


class PlannerFailure(RuntimeError):
    """A planner's fault, from which no result may come. The message names planner and run."""


def begin(limit: float | None, name: str) -> None:
    """Tell whoever watches this process what begins, and how many seconds it may take."""
    UNDER_WAY.info("%s %s", limit or "inf", name)


def end_with_parent() -> None:
    """Have the kernel end this process when its parent ends, so that no job keeps writing after its
    workflow is killed (Linux only).
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def measure_cpu_time() -> float:
    """Return the CPU seconds of this process and of its children that have ended and were waited
    for, with those of theirs: a planner may leave its work to them.
    """
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + ended.ru_utime + ended.ru_stime


def describe_end(status: int) -> str:
    """Describe how a process ended before its work was done. status: its exit status, or the number
    of the signal that ended it, below 0.
    """
    if status >= 0:
        return f"its process ended itself with exit status {status}, before it was done"
    known = -status in set(signal.Signals)
    name = signal.Signals(-status).name if known else f"number {-status}"
    return f"its process was ended by signal {name}" + (
        ", by another program or for want of memory" if name == "SIGKILL" else ""
    )
