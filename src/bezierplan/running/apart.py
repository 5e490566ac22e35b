"""Planners of unknown origin, each in a process of its own: nothing that one does to memory reaches
the process that judges its answers and writes them down.
"""

import contextlib
import json
import os
import resource
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection, Pipe
from typing import Any, NoReturn

import numpy as np

from bezierplan.planners import Plan
from bezierplan.running import answer, log, watchdog
from bezierplan.running.tampering import left_alone
from bezierplan.running.watchdog import PlannerFailure
from bezierplan.schema.words import told

# Seconds between two looks at whether a process is there that does not answer: one that it has
# started may hold its end of the pipe open.
_LOOK = 1.0

_FAILURE, _ACCOUNT = "failure", "account"

_ahead = np.zeros(2)
"""By how many seconds, of CPU and of the wall, `clock` is ahead of this process's own."""


def clock() -> np.ndarray:
    """Seconds of CPU and of the wall, (2,), of which only differences mean something: those of this
    process, in which a planner that is asked in another one takes as long as it does there.
    """
    return _own_clock() + _ahead


def _own_clock() -> np.ndarray:
    """Children that have ended count, for a planner may leave its work to them."""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = time.process_time() + ended.ru_utime + ended.ru_stime
    return np.array([cpu, time.perf_counter()])


@contextmanager
def asking(
    foreign: bool, name: str, plan: Callable[..., Any], fault: Callable[[], str] = str
) -> Iterator[Callable[..., Any]]:
    """Yield `ask(run, *given)`, which returns the answer `plan(*given)` of a planner.

    foreign: whether its code is of unknown origin. Then it is executed in a fork of this process,
    from which nothing comes back but plain values; on systems other than Linux, where a fork may
    crash, in this process, as other code.

    fault: says in one line, in the end and where the planner was executed, what it has changed.
    Raises PlannerFailure, beginning with `run` or `name`, if the planner fails, ends its process,
    leaves others behind, replaces part of another module, or has changed something.
    """
    if not foreign or sys.platform != "linux":
        with left_alone(name):
            yield lambda run, *given: plan(*given)
        _refuse(name, fault())
        return
    here, there = Pipe()
    child = watchdog.forked()
    if child == 0:
        here.close()
        _serve(there, name, plan, fault)
    there.close()
    try:
        yield lambda run, *given: _asked(here, child, run, given)
        _asked(here, child, name, None)
    finally:
        here.close()
        with contextlib.suppress(ProcessLookupError, ChildProcessError):
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)


def _refuse(name: str, fault: str) -> None:
    if fault:
        raise PlannerFailure(f"{name}: {fault}")


# --------------------------------------------------------------------------------------------------
# In the process that judges


def _asked(pipe: Connection, child: int, run: str, given: tuple | None) -> Plan | None:
    """The answer to a question, None to the one (None) whether all is well in the end."""
    before = _own_clock()
    try:
        pipe.send((run, given))
        while not pipe.poll(_LOOK):
            if watchdog.is_dead(child) and not pipe.poll():
                raise EOFError
        said = json.loads(pipe.recv_bytes())
        plan, took = (None, np.zeros(2)) if _FAILURE in said else _unpacked(**said)
    except (EOFError, OSError):
        raise PlannerFailure(f"{run}: {watchdog.awaited(child)}") from None
    except (ValueError, TypeError, LookupError):
        raise PlannerFailure(f"{run}: its process does not answer with a plan") from None
    if _FAILURE in said:
        failure = PlannerFailure(said[_FAILURE])
        failure.add_note(said[_ACCOUNT])
        raise failure
    _ahead[:] += took - (_own_clock() - before)
    return plan


# --------------------------------------------------------------------------------------------------
# In the process of the planner


def _serve(
    pipe: Connection, name: str, plan: Callable[..., Any], fault: Callable[[], str]
) -> NoReturn:
    """Answer questions until all is told."""
    try:
        try:
            with left_alone(name):
                _answer(pipe, plan)
            _refuse(name, fault())
            pipe.send_bytes(_packed(None, _own_clock()))
        except BaseException as error:  # code of unknown origin may raise anything
            text = str(error) if isinstance(error, PlannerFailure) else f"{name}: {told(error)}"
            said = {_FAILURE: text, _ACCOUNT: log.account(error)}
            pipe.send_bytes(json.dumps(said).encode())
        watchdog.flush()
    finally:
        os._exit(0)


def _answer(pipe: Connection, plan: Callable[..., Any]) -> None:
    """Answer all questions but the last."""
    while True:
        run, given = pipe.recv()
        if given is None:
            return
        before = _own_clock()
        with watchdog.executing(run, str):
            found = plan(*given)
        took = _own_clock() - before
        try:
            plain = answer.plain(found)
        except answer.Unfit as unfit:
            raise PlannerFailure(f"{run}: its answer: {unfit}") from None
        pipe.send_bytes(_packed(plain, took))


# --------------------------------------------------------------------------------------------------
# What goes through the pipe


def _packed(plan: Plan | None, took: np.ndarray) -> bytes:
    """A plain plan, with the seconds that it took, as text that holds all bits of its numbers."""
    fields = None
    if plan is not None:
        fields = plan._asdict() | {"history": plan.history.tolist()}
        if plan.path is not None:
            fields["path"] = answer.stored(plan.path)
    return json.dumps({"plan": fields, "took": took.tolist()}).encode()


def _unpacked(plan: dict[str, Any] | None, took: list[float]) -> tuple[Plan | None, np.ndarray]:
    seconds = np.array(took, dtype=float).reshape(2)
    if plan is None:
        return None, seconds
    path = plan["path"] and answer.restored(*plan["path"])
    history = np.array(plan["history"], dtype=float)
    return Plan(**plan | {"path": path, "history": history}), seconds
