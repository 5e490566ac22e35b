"""YAML files read strictly and checked against a schema; every fault in one line that names file, key, value and what would be right."""

import difflib
import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import yaml

SCHEMAS = Path(__file__).parent / "schemas"


class Fault(ValueError):
    """Something in a file that a reader has to mend, in one line."""


class _Loader(yaml.SafeLoader):
    """YAML 1.2's plain scalars: `no` is a word, `0_15` is a word, `010` is ten, `1e-3` is a number; a key may stand only once."""


_Loader.yaml_implicit_resolvers = {}
for _tag, _pattern, _first in (
    ("null", r"|null|~", ["", "n", "~"]),
    ("bool", r"true|false", list("tf")),
    ("int", r"[-+]?[0-9]+", list("-+0123456789")),
    ("float", r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.inf|\.nan", list("-+.0123456789")),
):
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", re.compile(f"^(?:{_pattern})$"), _first)
_Loader.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value))


def _mapping(loader: _Loader, node: yaml.MappingNode) -> dict:
    keys = [key.value for key, _ in node.value]
    for number, key in enumerate(keys):
        if key in keys[:number]:
            raise yaml.MarkedYAMLError(problem=f"{key}: this key stands here twice", problem_mark=node.value[number][0].start_mark)
    # Names are text even when they look like numbers.
    return {key.value: loader.construct_object(value, deep=True) for key, value in node.value}


_Loader.add_constructor("tag:yaml.org,2002:map", _mapping)


def read(file: Path, schema: str) -> dict[str, Any]:
    """The content of a YAML file that fits the schema of that name. Raises Fault."""
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise Fault(f"{file}: cannot be read ({type(error).__name__})") from None
    content = parse(text, str(file))
    check(content, schema, str(file))
    return content


def parse(text: str, place: str) -> Any:
    """The content of YAML text, read strictly. Raises Fault, beginning with a place."""
    try:
        return yaml.load(text, _Loader)
    except yaml.MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        raise Fault(f"{place}: {line}{error.problem}") from None


def check(content: Any, schema: str, place: str) -> None:
    """Raise Fault, beginning with a place, unless content fits the schema of that name."""
    import jsonschema

    errors = list(jsonschema.Draft202012Validator(_schema(schema)).iter_errors(content))
    if errors:
        # A misspelt key is also a missing key: name the one that stands there.
        error = min(errors, key=lambda e: (e.validator != "additionalProperties", len(e.absolute_path), str(e.absolute_path)))
        raise Fault(": ".join([place, *map(str, error.absolute_path), _fault(error)]))


@cache
def _schema(name: str) -> dict:
    return yaml.safe_load((SCHEMAS / f"{name}.schema.yaml").read_text(encoding="utf-8"))


def _fault(error: Any) -> str:
    wanted = error.schema.get("description", "")
    if error.validator == "additionalProperties":
        known = list(error.schema.get("properties", {}))
        wrong = next(key for key in error.instance if key not in known and not _matches(key, error.schema))
        return f"{wrong}: unknown key{closest(wrong, known)}"
    if error.validator == "propertyNames":
        return f"{error.instance}: not a name; {error.schema.get('description', 'names are lower-case letters, digits and _')}"
    if error.validator == "required":
        missing = next(key for key in error.validator_value if key not in error.instance)
        return f"{missing}: missing key; {_described(error.schema, missing)}"
    if error.validator == "enum":
        return f"{error.instance}: unknown{closest(error.instance, error.validator_value)}"
    if error.validator == "type":
        return f"{error.instance!r}: expected {wanted or error.validator_value}"
    return f"{error.instance!r}: {wanted or error.message}"


def _matches(key: str, schema: dict) -> bool:
    return any(re.search(pattern, key) for pattern in schema.get("patternProperties", {}))


def _described(schema: dict, key: str) -> str:
    return schema.get("properties", {}).get(key, {}).get("description", "needed here")


def closest(word: Any, known: Iterable[str]) -> str:
    """`; did you mean ...?` and the known words, to end a sentence about an unknown one."""
    words = sorted(map(str, known))
    near = difflib.get_close_matches(str(word), words, n=1)
    hint = f"; did you mean {near[0]}?" if near else ";"
    return f"{hint} known: {', '.join(words) or 'none'}"
