"""Words of unknown origin as one line that no terminal and no log is harmed by."""

LONGEST = 500
"""Characters of the longest text of an exception that is shown."""


def plain(text: str, most: int | None = None) -> str:
    """A text with its control characters escaped, line breaks too, and cut after `most` characters,
    which is told.
    """
    cut = (
        text if most is None or len(text) <= most else f"{text[:most]}... ({len(text)} characters)"
    )
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in cut)


def told(error: BaseException, most: int = LONGEST) -> str:
    """An exception as one line: its class and its text, which foreign code may have written."""
    try:
        text = str(error)
    except BaseException as fault:  # of a class of unknown origin
        text = f"its text cannot be read: {type(fault).__name__}"
    text = " ".join(text[: 10 * most].split()) if len(text) <= 10 * most else text
    name = "sys.exit" if isinstance(error, SystemExit) else type(error).__name__
    return plain(f"{name}: {text}" if text else name, most)
