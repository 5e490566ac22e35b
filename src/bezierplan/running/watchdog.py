"""End a process whose run takes too long, whatever it is doing.

A compiled kernel gives nothing back to Python before it ends, so neither a signal handler nor a thread of the same process could act. The
watchdog is a process of its own. It reads from a pipe which run has begun, costs a run two short writes, and ends with the process that it
watches, whose pipe then closes.
"""

import os
import select
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def watching(limit: float | None) -> Iterator[Callable[[str], None]]:
    """Give a function that is told what begins, and is called with an empty text when it has ended.

    What takes longer than `limit` seconds ends this process by SIGKILL, after one line that names it on stderr and in the file that this
    process logs to, if it does. Without a limit nothing is watched.
    """
    if limit is None:
        yield lambda begun: None
        return
    import logging
    import subprocess

    log = next((each.baseFilename for each in logging.getLogger().handlers if isinstance(each, logging.FileHandler)), os.devnull)
    # Neither the environment nor site-packages are read. A session of its own leaves it to the pipe when it ends.
    command = [sys.executable, "-I", "-S", __file__, str(os.getpid()), str(limit), log]
    with subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=True) as watchdog:

        def tell(begun: str) -> None:
            os.write(watchdog.stdin.fileno(), f"{begun}\n".encode())

        yield tell


def _watch(process: int, limit: float, log: str) -> None:
    """Read from stdin what begins, a line each, and end a process if no other line follows within the limit."""
    begun = b""
    while select.select([0], [], [], limit if begun else None)[0]:
        told = os.read(0, 1 << 16)
        if not told:
            return
        begun = told.split(b"\n")[-2]
    line = f"{begun.decode()}: not done within the time limit of {limit:g} s; the job is ended\n"
    with open(log, "a", encoding="utf-8") as file:
        file.write(line)
    sys.stderr.write(line)
    sys.stderr.flush()
    os.kill(process, signal.SIGKILL)


if __name__ == "__main__":
    _watch(int(sys.argv[1]), float(sys.argv[2]), sys.argv[3])
