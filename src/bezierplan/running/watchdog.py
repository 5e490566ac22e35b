"""End a process whose run takes too long, whatever it is doing.

A compiled kernel does not yield to Python before it ends, so neither a signal handler nor a thread of the same process could act. The
watchdog is therefore a separate process. It reads from a pipe which run has begun, costs a run two short writes, and ends with the
process that it watches, whose pipe then closes.
"""

import os
import select
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def watching(limit: float | None) -> Iterator[Callable[[str], None]]:
    """Yield a function to call with the name of a run when it begins, and with an empty text when it ends.

    A run longer than `limit` seconds ends this process by SIGKILL, after one line that names the run on stderr and in this process's log
    file, if any. Without a limit nothing is watched.
    """
    if limit is None:
        yield lambda begun: None
        return
    import logging
    import subprocess

    log = next((each.baseFilename for each in logging.getLogger().handlers if isinstance(each, logging.FileHandler)), os.devnull)
    # Neither the environment nor site-packages are read. In a session of its own, only the closing pipe ends the watchdog.
    command = [sys.executable, "-I", "-S", __file__, str(os.getpid()), str(limit), log]
    with subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=True) as watchdog:

        def tell(begun: str) -> None:
            os.write(watchdog.stdin.fileno(), f"{begun}\n".encode())

        yield tell


def _watch(process: int, limit: float, log: str) -> None:
    """Read from stdin the name of each run that begins, one per line, and end a process if no line follows within the limit."""
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
