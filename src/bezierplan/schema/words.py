"""Words of unknown origin as one line that no terminal and no log is harmed by."""

import traceback
from pathlib import Path

from bezierplan.machine.modules import USERS

LONGEST = 500
"""Characters of the longest text of an exception that is shown."""


def escape(text: str, most: int | None = None) -> str:
    """A text with its control characters escaped, line breaks too, and cut after `most` characters,
    which is told.
    """
    cut = (
        text if most is None or len(text) <= most else f"{text[:most]}... ({len(text)} characters)"
    )
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in cut)


def describe_in_one_line(error: BaseException) -> str:
    """An exception as one line: the line of a user's file that it comes from, if it does; its class
    and its text, which foreign code may have written.
    """
    text = " ".join(str(error).split())
    places = [
        f"line {line} of {Path(frame.f_code.co_filename).name}: "
        for frame, line in traceback.walk_tb(error.__traceback__)
        if str(frame.f_globals.get("__name__")).startswith(USERS)
    ]
    name = "sys.exit" if isinstance(error, SystemExit) else type(error).__name__
    return escape("".join(places[-1:]) + (f"{name}: {text}" if text else name), LONGEST)
