"""Variables say what they hold: words that could hold anything live in scopes of a few lines."""

import ast
from collections.abc import Iterator
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src"
ANYTHING = {"found", "given", "own", "each", "one", "other", "place"}
MOST_LINES = 5
# An expression of its own binds its names for itself.
OWN = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.Lambda, ast.FunctionDef)


def names(scope: ast.AST) -> Iterator[tuple[str, int, bool]]:
    """Names of a scope with their lines, and whether they are bound there, but for those of the
    scopes within it.
    """
    for node in ast.iter_child_nodes(scope):
        if isinstance(node, OWN):
            continue
        if isinstance(node, ast.Name):
            yield node.id, node.lineno, isinstance(node.ctx, ast.Store)
        if isinstance(node, ast.arg):
            yield node.arg, node.lineno, True
        yield from names(node)


def long_lived(text: str) -> list[str]:
    """Words of `ANYTHING` that live longer than a few lines in some function of a module's text."""
    said = []
    for function in (
        node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)
    ):
        for word in ANYTHING:
            uses = [(line, bound) for name, line, bound in names(function) if name == word]
            lines = [line for line, _ in uses]
            if any(bound for _, bound in uses) and max(lines) - min(lines) > MOST_LINES:
                said.append(f"{function.name}: {word}, lines {min(lines)} to {max(lines)}")
    return said


def test_words_that_could_hold_anything_live_in_short_scopes():
    modules = {
        file.relative_to(SOURCE).as_posix(): file.read_text(encoding="utf-8")
        for file in sorted(SOURCE.rglob("*.py"))
    }
    assert {name: said for name, text in modules.items() if (said := long_lived(text))} == {}


def test_a_long_scope_is_noticed():
    body = "\n".join(f"    step_{number} = {number}" for number in range(MOST_LINES + 1))
    assert long_lived(f"def f(a):\n    found = a\n{body}\n    return found\n") == [
        f"f: found, lines 2 to {MOST_LINES + 4}"
    ]
    assert long_lived("def f(a):\n    found = a\n    return found\n") == []
