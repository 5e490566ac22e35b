"""Variables say what they hold: words that could hold anything live in scopes of a few lines. And
names are nouns: a participle says what was done with a thing, and not what it is, so none stands
alone or last in the name of a class, a parameter or a field, or of a variable with a long scope.
Functions may be named by what becomes of their argument, as `sorted` is; what is true or false may
be an adjective.
"""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src"
ANYTHING = {"found", "given", "own", "each", "one", "other", "place"}
MOST_LINES = 5
LONG_SCOPE = 20
# An expression of its own binds its names for itself.
OWN = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.Lambda, ast.FunctionDef)
IRREGULAR = (
    "asked begun bred broken brought built chosen done drawn driven fallen felt found given gone "
    "got grown held hidden kept known laid lent lost made meant met paid said seen sent shown sold "
    "spent stood taken taught thought thrown told torn understood wanted won worn written"
)
PARTICIPLE = re.compile(rf"(?:{IRREGULAR.replace(' ', '|')}|[a-z]{{2,}}ed)")
# Nouns that end alike, and terms of the field, of graph searches and of the papers' tables.
NOUNS = {"seed", "speed", "need", "embed"}
TERMS = {
    "blocked",
    "occupied",
    "paired",
    "printed",
    "published",
    "reconstructed",
    "settled",
    "visited",
}
# Keys that users write, and columns of results.
KEYS = {
    "counted",
    "defined",
    "extended",
    "fitted",
    "proposed",
    "runs_drawn",
    "tested",
    "travelled",
    "waited",
}


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


def is_participle(name: str) -> bool:
    """Whether the last word of a name says what was done."""
    last = re.sub(r"(?<!^)([A-Z])", r"_\1", name).strip("_").lower().rpartition("_")[2]
    return bool(PARTICIPLE.fullmatch(last)) and not {name, last} & (NOUNS | TERMS | KEYS)


def participles(text: str) -> list[str]:
    """Classes, fields and parameters of a module's text that have one for a name; what is true or
    false may be an adjective.
    """
    declared = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ClassDef):
            fields = [field for field in node.body if isinstance(field, ast.AnnAssign)]
            declared += [(node.name, None)]
            declared += [(ast.unparse(field.target), field.annotation) for field in fields]
        elif isinstance(node, ast.FunctionDef):
            arguments = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
            declared += [(argument.arg, argument.annotation) for argument in arguments]
    return [
        name
        for name, type_ in declared
        if is_participle(name) and (type_ is None or "bool" not in ast.unparse(type_))
    ]


def long_lived(text: str) -> list[str]:
    """Words of `ANYTHING` and participles that live longer than they may in some function of a
    module's text.
    """
    said = []
    for function in (
        node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)
    ):
        uses = list(names(function))
        for word in sorted({name for name, _, bound in uses if bound}):
            lines = [line for name, line, _ in uses if name == word]
            most = MOST_LINES if word in ANYTHING else LONG_SCOPE
            if (word in ANYTHING or is_participle(word)) and max(lines) - min(lines) > most:
                said.append(f"{function.name}: {word}, lines {min(lines)} to {max(lines)}")
    return said


def faults(rule) -> dict[str, list[str]]:
    """What a rule says of the modules of the package."""
    texts = {
        file.relative_to(SOURCE).as_posix(): file.read_text(encoding="utf-8")
        for file in sorted(SOURCE.rglob("*.py"))
    }
    return {name: said for name, text in texts.items() if (said := rule(text))}


def test_words_that_could_hold_anything_live_in_short_scopes():
    assert faults(long_lived) == {}


def test_what_is_declared_has_a_noun_for_a_name():
    assert faults(participles) == {}


def test_a_class_name_stands_for_one_thing():
    """But for what each file of an interface has, which is found by the file's name."""
    shared = {"Options", "Settings"}
    trees = [ast.parse(file.read_text(encoding="utf-8")) for file in SOURCE.rglob("*.py")]
    every = [node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]
    borne = Counter(node.name for node in every if not node.name.startswith("_"))
    assert {name for name, count in borne.items() if count > 1} <= shared


def test_a_long_scope_and_a_participle_are_noticed():
    body = "\n".join(f"    step_{number} = {number}" for number in range(MOST_LINES + 1))
    assert long_lived(f"def f(a):\n    found = a\n{body}\n    return found\n") == [
        f"f: found, lines 2 to {MOST_LINES + 4}"
    ]
    assert long_lived("def f(a):\n    found = a\n    return found\n") == []
    assert participles("class Found:\n    b_kept: int\n    seed: int\n    open_seen: bool\n") == [
        "Found",
        "b_kept",
    ]
    assert participles("def f(drawn, seeded: bool, *, told: str, speed):\n    pass") == [
        "drawn",
        "told",
    ]
