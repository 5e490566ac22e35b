"""How much code there may be, in tokens of src and of tests: budgets are in `pyproject.toml`."""

import ast
import io
import tokenize
import tomllib
from collections import Counter
from pathlib import Path

import pytest

TREE = Path(__file__).parents[1]
BUDGETS = tomllib.loads((TREE / "pyproject.toml").read_text())["tool"]["bezierplan"]["budgets"]
LAYOUT = {
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
    tokenize.COMMENT,
}


def lines_of_docstrings(tree):
    """Numbers of the lines that docstrings take."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            first = node.body[0] if node.body else None
            if isinstance(first, ast.Expr) and isinstance(getattr(first.value, "value", None), str):
                yield from range(first.lineno, first.end_lineno + 1)


def tokens(text):
    """The number of names, numbers, strings and operators; no comments, docstrings or layout."""
    words = set(lines_of_docstrings(ast.parse(text)))
    return sum(
        token.type not in LAYOUT and token.start[0] not in words
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
    )


def test_tokens_leave_out_what_only_explains_and_how_it_is_laid_out():
    assert tokens('"""A\nmodule."""\n\nx = f(1)  # why\n') == tokens("x = f(\n    1\n)\n") == 6


@pytest.mark.parametrize("root", BUDGETS)
def test_the_code_does_not_outgrow_its_budget(root):
    counts = Counter()
    for file in (TREE / root).rglob("*.py"):
        counts[file.parent] += tokens(file.read_text())
    for folder, count in counts.most_common():
        print(f"{count:7,} {folder.relative_to(TREE)}")
    assert 0 < counts.total() <= BUDGETS[root]
