"""The examples in docstrings give what they print."""

import doctest
import importlib
from pathlib import Path

import pytest

import bezierplan

PACKAGE = Path(bezierplan.__file__).parent
PROMPT = ">>> "
FILES = [
    file for file in sorted(PACKAGE.rglob("*.py")) if PROMPT in file.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.relative_to(PACKAGE).as_posix())
def test_examples_give_what_they_print(file):
    parts = file.relative_to(PACKAGE.parent).with_suffix("").parts
    module = importlib.import_module(".".join(parts[:-1] if parts[-1] == "__init__" else parts))
    failed, attempted = doctest.testmod(module)
    assert failed == 0
    # doctest overlooks what is no plain function, such as a compiled kernel.
    assert attempted == file.read_text(encoding="utf-8").count(PROMPT)
