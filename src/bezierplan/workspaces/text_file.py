"""Text files of users."""

from pathlib import Path

LARGEST_FILE = 16 * 2**20
"""Most bytes of a text file: enough for a map of 4,000 x 4,000 cells."""


def split_lines(text: str) -> list[str]:
    """Split a text into lines, without blanks at their ends and blank lines at its end."""
    return [line.rstrip() for line in text.rstrip().split("\n")]


def read_text(file: Path) -> str:
    """Read the text of a file in UTF-8, without a byte order mark, with line ends as `\\n`.

    Raises ValueError, in one line without the file's name, for a file that cannot be read, one with
    more than `LARGEST_FILE` bytes, and bytes that are not UTF-8.
    """
    try:
        with file.open("rb") as stream:
            # One byte more tells that a file is too large; the rest need not be read.
            content = stream.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise ValueError(f"has too many bytes; expected at most {LARGEST_FILE:,}")
        # Programs on Windows begin with a byte order mark and end lines with two characters.
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except OSError as error:
        raise ValueError(f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError as error:
        raise ValueError(f"cannot be read: byte {error.start} is not UTF-8") from None
