"""Turn words of unknown origin into one line that harms no terminal and no log."""

import traceback
from pathlib import Path

from bezierplan.machine.modules import USERS

LONGEST = 500
"""Most characters of an exception's text that are shown."""


def escape(text: str, most: int | None = None) -> str:
    """Return a text with its control characters escaped, line breaks too.

    most: after so many characters the text is cut, and the result says so.
    """
    if most is not None and len(text) > most:
        text = f"{text[:most]}... ({len(text)} characters)"
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def describe_in_one_line(error: BaseException) -> str:
    """Describe an exception in one line: its class and text, which foreign code may have written,
    and the line of a user's file that it comes from, if it does.
    """
    text = " ".join(str(error).split())
    places = [
        f"line {line} of {Path(frame.f_code.co_filename).name}: "
        for frame, line in traceback.walk_tb(error.__traceback__)
        if str(frame.f_globals.get("__name__")).startswith(USERS)
    ]
    name = "sys.exit" if isinstance(error, SystemExit) else type(error).__name__
    # The innermost line of a user's file is the one to look at.
    return escape("".join(places[-1:]) + (f"{name}: {text}" if text else name), LONGEST)
