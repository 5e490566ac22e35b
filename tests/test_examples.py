"""The examples in docstrings give what they print."""

import doctest
import importlib
from pathlib import Path

import pytest

import bezierplan
from bezierplan.geometry import cell_length, checker, curves, shortest_paths
from bezierplan.workspaces import grid

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


@pytest.mark.parametrize(
    "function",
    [
        curves.length,
        curves.bezier_pieces,
        checker.check,
        shortest_paths.shortest_path,
        shortest_paths.lattice_path,
        cell_length.length4,
        cell_length.length8,
        grid.from_lines,
    ],
    ids=lambda function: function.__name__,
)
def test_what_readers_call_first_has_an_example(function):
    assert PROMPT in function.__doc__
