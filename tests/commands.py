"""Commands of this process: how they end, and what they say."""

from typing import Any

import pytest

from bezierplan.__main__ import main


def call(capsys: pytest.CaptureFixture, *words: Any) -> tuple[Any, list[str], list[str]]:
    """What a command ends with, the lines that it prints, and those about faults."""
    status = 0
    try:
        main([*map(str, words)])
    except SystemExit as end:
        status = end.code
    printed = capsys.readouterr()
    return status, printed.out.splitlines(), printed.err.splitlines()


def refused(capsys: pytest.CaptureFixture, *words: Any) -> str:
    """The line about a command that cannot be meant, which is all that it prints."""
    status, printed, (line,) = call(capsys, *words)
    assert (status, printed) == (2, [])
    return line
