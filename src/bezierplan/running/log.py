"""Common behaviour of workflow jobs: end with the parent, write to the log, leave only complete files, report a failure in one line."""

import ctypes
import errno
import glob
import logging
import os
import shutil
import signal
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bezierplan.running import effort

PR_SET_PDEATHSIG = 1
FULL = (errno.ENOSPC, errno.EDQUOT)
"""What an operating system says of a full disk, or of a user's full share of it."""
RUNS_COLUMN = "id"
"""A column of every table of runs."""


def end_with_parent() -> None:
    """Have the kernel end this process when its parent ends, so that no job keeps writing after its workflow is killed (Linux only)."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


@contextmanager
def job(given: Any) -> Iterator[Any]:
    """Run a job: `given` is its script's `snakemake` object; the block receives temporary names for the output files.

    The files get their final names when the block ends, and the log says what CPU time the job took (`effort`). An exception is written to
    the job's log in full and ends the process with a one-line message.
    """
    end_with_parent()
    effort.begin()
    logging.basicConfig(filename=given.log[0], filemode="w", level=logging.INFO, format="%(asctime)s %(levelname)s %(message)s")
    try:
        with whole_files(given.output) as output:
            yield output
        logging.info(effort.line())
    except Exception as error:
        if isinstance(error, OSError) and error.errno in FULL:
            logging.raiseExceptions = False  # the log may lie on the same disk
        logging.exception("failed")
        sys.exit(
            full_disk(error, given.output) or damaged(given.input) or f"{type(error).__name__}: {error} (full account: {given.log[0]})"
        )


@contextmanager
def whole_files(files: Any) -> Iterator[Any]:
    """Temporary names in another folder for a job's files, all of one folder; they get their final names once the block succeeds.

    So an existing file is always complete, even if its job was killed. What a killed job left is removed when the job runs again.
    """
    first = Path(files[0])
    prefix = f".part-{first.name}-"
    for left in first.parent.glob(f"{glob.escape(prefix)}*"):
        shutil.rmtree(left, ignore_errors=True)
    with tempfile.TemporaryDirectory(prefix=prefix, dir=first.parent) as folder:
        parts = type(files)(toclone=files, custom_map=lambda file: str(Path(folder) / Path(file).name))
        yield parts
        for part, file in zip(parts, files, strict=True):
            os.replace(part, file)


def full_disk(error: Exception, files: Any) -> str:
    """What to do about a disk without space for a job's files; empty for another error."""
    if not (isinstance(error, OSError) and error.errno in FULL):
        return ""
    return f"{Path(files[0]).parent}: no space left on this disk; free some and start again: finished jobs are kept"


def damaged(files: Iterable[str]) -> str:
    """What to do about the first Parquet file that is cut off, or is no table of runs in the place of one; empty if there is none."""
    import pyarrow as pa
    import pyarrow.parquet as parquet

    for file in files:
        if str(file).endswith(".parquet"):
            try:
                columns = parquet.read_schema(file).names
            except (OSError, pa.ArrowException):
                return f"{file}: not a whole Parquet file; delete it and start again: the workflow reproduces it"
            if "runs" in Path(file).parts and RUNS_COLUMN not in columns:
                return f"{file}: not a table of runs; delete it and start again: the workflow reproduces it"
    return ""
