"""Functions say what they do: most begin with a verb, and few with a participle."""

import ast
import re
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src"
IRREGULAR = "built drawn found given held kept known laid left made met said seen shown taken told"
PARTICIPLE = re.compile(rf"(?:{IRREGULAR.replace(' ', '|')}|[a-z]{{2,}}ed)")
NOUNS = {"embed", "need", "seed", "speed"}


def test_few_functions_are_named_by_a_participle():
    names = [
        node.name.lstrip("_").split("_")[0]
        for file in SOURCE.rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("__")
    ]
    named = [name for name in names if PARTICIPLE.fullmatch(name) and name not in NOUNS]
    assert len(named) < 0.14 * len(names)
