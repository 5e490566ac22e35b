"""Run a command, and end when all that it started has ended: `python counted.py COMMAND...`.

The CPU seconds of a process count for its parent once this has waited for it. This one becomes the
parent of every descendant that loses its own, and waits for all. On systems other than Linux it
waits for the command alone, and what the command itself does not wait for is not counted.
"""

import ctypes
import os
import subprocess
import sys
from contextlib import suppress

PR_SET_CHILD_SUBREAPER = 36

if sys.platform == "linux":
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)
STATUS = subprocess.call(sys.argv[1:])
with suppress(ChildProcessError):
    while True:
        os.wait()
sys.exit(STATUS)
