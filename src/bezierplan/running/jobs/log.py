"""Common behaviour of workflow jobs: end with the parent, write to the log, leave only complete
files, report a failure in one line.
"""

import errno
import glob
import logging
import os
import shutil
import sys
import tempfile
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from bezierplan.running.jobs.watchdog import PlannerFailure, end_with_parent
from bezierplan.schema.safe_text import describe_in_one_line, escape

LAST = "CRITICAL "
"""Beginning of the line in a failed job's log that says why it failed."""
MOST_FRAMES, MOST_LINES, LONGEST_LINE = 100, 400, 2000
"""Most frames and lines of a traceback in a log, and most characters of a line: a recursion without
end has a thousand frames, and a planner's message may be of any length.
"""
MOST_TOLD = 20
"""Most runs of a job that are named as faulty, one line each."""


@contextmanager
def run_job(snakemake: Any) -> Iterator[Any]:
    """Run a job in a block, which receives temporary names for the output files.

    snakemake: the script's object of this name. The files get their final names when the block
    ends. An exception is written to the job's log in full, and ends the process with a one-line
    message, which is also the last line of the log. Ends that nothing in the process could report
    are reported by `forks`.
    """
    log = snakemake.log[0]
    end_with_parent()
    logging.raiseExceptions = False  # the disk of the log may be full
    logging.basicConfig(
        filename=log,
        filemode="w",
        level=logging.INFO,
        format="%(asctime)s %(levelname)s %(message)s",
    )
    try:
        with write_whole_files(snakemake.output) as output:
            yield output
    except Exception as error:
        logging.error("failed\n%s", describe_error(error))
        said = (
            str(error)
            if isinstance(error, PlannerFailure)
            else describe_in_one_line(find_full_disk(error) or error)
        )
        lines = said.splitlines()
        if len(lines) > MOST_TOLD:
            lines[MOST_TOLD:] = [f"and {len(lines) - MOST_TOLD} more runs"]
        lines[-1] += f" (full account: {log})"
        for line in lines:
            logging.critical(line)
            say(line)
        sys.exit(1)


def say(line: str) -> None:
    """Print a line to stderr."""
    # Text and line break in one write, so that no other job's words come between them.
    print(f"{line}\n", end="", file=sys.stderr, flush=True)


def report(log: str, line: str) -> None:
    """Write to a job's log and to stderr how it has ended."""
    line = f"{escape(line)} (log: {log})"
    with suppress(OSError), open(log, "a", encoding="utf-8") as file:
        file.write(f"{LAST}{line}\n")
    say(line)


def find_full_disk(error: BaseException | None) -> BaseException | None:
    """Return the exception of a full disk that led to another one, or None. Libraries fail once
    more when they close a file that they could not write.
    """
    while error and getattr(error, "errno", None) not in (errno.ENOSPC, errno.EDQUOT):
        error = error.__cause__ or error.__context__
    return error


def describe_error(error: BaseException) -> str:
    """Return the last lines of an exception's traceback, each of limited length and without control
    characters.
    """
    lines = "".join(traceback.format_exception(error, limit=-MOST_FRAMES)).splitlines()
    return "\n".join(escape(line, LONGEST_LINE) for line in lines[-MOST_LINES:])


@contextmanager
def write_whole_files(files: Any) -> Iterator[Any]:
    """Give temporary names in another folder for a job's files, all of one folder; these get their
    final names once the block succeeds.

    So an existing file is always complete, even if its job was killed. Remains of a killed job are
    removed when the job runs again.
    """
    first = Path(files[0])
    prefix = f".part-{first.name}-"
    for left in first.parent.glob(f"{glob.escape(prefix)}*"):
        shutil.rmtree(left, ignore_errors=True)
    with tempfile.TemporaryDirectory(prefix=prefix, dir=first.parent) as folder:
        parts = type(files)(
            toclone=files, custom_map=lambda file: str(Path(folder) / Path(file).name)
        )
        yield parts
        for part, file in zip(parts, files, strict=True):
            # In one step, since both are in one folder's file system.
            os.replace(part, file)
