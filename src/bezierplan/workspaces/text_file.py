"""User-supplied text files, read safely: a device, a pipe, or an endless file is rejected before
anything is read.
"""

import re
import stat
from pathlib import Path

LARGEST_FILE = 16 * 2**20
"""Most bytes of a text file: enough for a map of 4,000 x 4,000 cells."""


_NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?", re.ASCII)
LONGEST_NUMBER = 400
"""Characters of a number: Python writes none with more, and reads more than some thousands digits
slowly, or not at all.
"""


def number(word: str) -> float:
    """A word as a number, as people write one: Python also reads `1_0`, `infinity` and digits of
    other scripts. Raises ValueError.
    """
    if len(word) > LONGEST_NUMBER or not _NUMBER.fullmatch(word):
        raise ValueError(f"{word[:40]!r} is not a number")
    return float(word)


def is_count(word: str) -> bool:
    """Whether a word is a whole number of at least 1, of a size that something can have."""
    return word.isascii() and word.isdecimal() and len(word) < 10 and int(word) >= 1


def lines_of(text: str) -> list[str]:
    """The lines of a text, without blank ones at its end, and without spaces and tabs at theirs,
    which editors leave. Nothing but `\\n` ends a line: a vertical tab is a character in it.
    """
    lines = [line.rstrip(" \t") for line in text.split("\n")]
    while lines and not lines[-1]:
        lines.pop()
    return lines


def read_text(file: Path, largest: int = LARGEST_FILE) -> str:
    """The text of a regular file in UTF-8 with at most `largest` bytes, without a byte order mark,
    with line ends as `\\n`.

    Raises ValueError, in one line without the file's name, for anything else: an unreadable file, a
    folder, a device or pipe, a larger file, bytes that are not UTF-8, and a NUL character.
    """
    try:
        found = file.stat()
        if not stat.S_ISREG(found.st_mode):
            raise ValueError("is not a regular file; expected a text file")
        if found.st_size > largest:
            raise ValueError(f"has {found.st_size:,} bytes; expected at most {largest:,}")
        text = file.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ValueError(f"cannot be read ({error.strerror or type(error).__name__})") from None
    except UnicodeDecodeError as error:
        raise ValueError(
            f"cannot be read: byte {error.start} is not UTF-8; expected a text file in UTF-8"
        ) from None
    if "\0" in text:
        raise ValueError(
            f"has a NUL character in line {text[: text.index(chr(0))].count(chr(10)) + 1}; "
            "expected a text file"
        )
    return text
