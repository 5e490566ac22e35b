"""User-supplied text files, read safely: a device, a pipe, or an endless file is rejected before anything is read."""

import stat
from pathlib import Path

LARGEST_FILE = 16 * 2**20
"""Most bytes of a text file: enough for a map of 4,000 x 4,000 cells."""


def read_text(file: Path, largest: int = LARGEST_FILE) -> str:
    """The text of a regular file in UTF-8 with at most `largest` bytes, with line ends as `\\n`.

    Raises ValueError, in one line without the file's name, for anything else: an unreadable file, a folder, a device or pipe, a larger
    file, bytes that are not UTF-8, and a NUL character.
    """
    try:
        found = file.stat()
        if not stat.S_ISREG(found.st_mode):
            raise ValueError("is not a regular file; expected a text file")
        if found.st_size > largest:
            raise ValueError(f"has {found.st_size:,} bytes; expected at most {largest:,}")
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise ValueError(f"cannot be read ({error.strerror or type(error).__name__})") from None
    except UnicodeDecodeError as error:
        raise ValueError(f"cannot be read: byte {error.start} is not UTF-8; expected a text file in UTF-8") from None
    if "\0" in text:
        raise ValueError(f"has a NUL character in line {text[: text.index(chr(0))].count(chr(10)) + 1}; expected a text file")
    return text
