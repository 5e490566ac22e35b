"""Names say what they stand for, as CONTRIBUTING describes: a function that does something begins
with a verb; classes, fields and parameters are nouns; a participle or adjective is for what is true
or false.
"""

import ast
import re
from collections import Counter
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src"
# Common ones; a function may begin with any other verb.
VERBS = (
    "add apply bound build can check choose collect compare compile compute convert count cut "
    "describe draw drive evaluate fill find follow format get group has is join judge keep list "
    "load look measure merge mutate name parse place plan prepare read refuse replace round run "
    "sample save search select show sort split take walk write yield"
)
IRREGULAR = (
    "asked begun bred broken brought built chosen done drawn driven fallen felt found given gone "
    "got grown held hidden kept known laid lent lost made meant met paid said seen sent shown sold "
    "spent stood taken taught thought thrown told torn understood wanted won worn written"
)
PARTICIPLE = re.compile(rf"(?:{IRREGULAR.replace(' ', '|')}|[a-z]{{2,}}ed)")
# Words that end alike, and terms of the field, of graph searches and of the papers' tables.
NOUNS = {"breed", "embed", "need", "seed", "speed"}
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


def functions(text: str) -> list[str]:
    """First words of a module's functions and methods, without properties, which are values, and
    without those that Python calls.
    """
    return [
        node.name.strip("_").partition("_")[0]
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("__")
        if not any("property" in ast.unparse(each) for each in node.decorator_list)
    ]


def faults(rule) -> dict[str, list[str]]:
    """What a rule says of the modules of the package."""
    texts = {
        file.relative_to(SOURCE).as_posix(): file.read_text(encoding="utf-8")
        for file in sorted(SOURCE.rglob("*.py"))
    }
    return {name: said for name, text in texts.items() if (said := rule(text))}


def test_functions_begin_with_verbs_and_not_with_participles():
    words = [word for file in SOURCE.rglob("*.py") for word in functions(file.read_text("utf-8"))]
    done = [word for word in words if PARTICIPLE.fullmatch(word) and word not in NOUNS]
    assert sum(word in VERBS.split() for word in words) >= 0.5 * len(words)
    assert len(done) <= 0.03 * len(words), sorted(done)


def test_what_is_declared_has_a_noun_for_a_name():
    assert faults(participles) == {}


def test_a_class_name_stands_for_one_thing():
    """But for what each file of an interface has, which is found by the file's name."""
    shared = {"Options", "Settings"}
    trees = [ast.parse(file.read_text(encoding="utf-8")) for file in SOURCE.rglob("*.py")]
    every = [node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]
    borne = Counter(node.name for node in every if not node.name.startswith("_"))
    assert {name for name, count in borne.items() if count > 1} <= shared


def test_a_participle_is_noticed():
    assert functions(
        "def _told(a):\n    pass\nclass A:\n    def __init__(self):\n        pass"
    ) == ["told"]
    assert participles("class Found:\n    b_kept: int\n    seed: int\n    open_seen: bool\n") == [
        "Found",
        "b_kept",
    ]
    assert participles("def f(drawn, seeded: bool, *, told: str, speed):\n    pass") == [
        "drawn",
        "told",
    ]
