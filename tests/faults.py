"""A fault put into a study's folder, and the line that reports it."""

from pathlib import Path

import pytest
from trees import edit

from bezierplan.schema.checked import Fault
from bezierplan.study import loading


def told(file: Path, old: str, new: str, study: Path) -> str:
    """What loading a study tells, in one line, when a file of its folder has new words in the place
    of old ones, which it must have.
    """
    edit(file, old, new)
    with pytest.raises(Fault) as caught:
        loading.load([study])
    assert "\n" not in str(caught.value)
    return str(caught.value)
