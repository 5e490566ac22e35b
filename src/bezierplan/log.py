"""What every job of the workflow does first: end with its parent, write to its log, and end in one clear line when something fails."""

import ctypes
import logging
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager

PR_SET_PDEATHSIG = 1


def end_with_parent() -> None:
    """Have the kernel end this process when its parent ends, so that no job writes on after its workflow was killed (Linux only)."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


@contextmanager
def job(file: str) -> Iterator[None]:
    """Log to a file; an exception is written there in full and ends the process with its one line."""
    end_with_parent()
    logging.basicConfig(filename=file, filemode="w", level=logging.INFO, format="%(asctime)s %(levelname)s %(message)s")
    try:
        yield
    except Exception as error:
        logging.exception("failed")
        sys.exit(f"{type(error).__name__}: {error} (full account: {file})")
