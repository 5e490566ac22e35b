"""Read YAML files strictly; a fault is one line with its place."""

import difflib
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import yaml

from bezierplan.schema.safe_text import escape


class Fault(ValueError):
    """A problem in a file that the user must fix, in one line that no character from the file can
    break.

    lines: one for each fault that was found; the first is the text of the exception.
    """

    def __init__(self, *lines: str) -> None:
        # A fault quotes what stands in the file, which may be of any length.
        self.lines = [escape(line, 1500) for line in lines]
        super().__init__(self.lines[0])


class _Loader(yaml.CSafeLoader):
    """A loader of YAML 1.2's plain scalars: `no` and `0_15` are words, `010` is ten, `1e-3` is a
    number. A key may occur only once.
    """


# None of YAML 1.1: it reads song2016's problem 0_15 as the octal number 13.
_Loader.yaml_implicit_resolvers = {}
for _tag, _pattern, _first in (
    ("null", r"|null|~", ["", "n", "~"]),
    ("bool", r"true|false", list("tf")),
    # A whole number of 18 digits fits into 64 bits.
    ("int", r"[-+]?[0-9]{1,18}", list("-+0123456789")),
    (
        "float",
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.inf|\.nan",
        list("-+.0123456789"),
    ),
):
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_tag}", re.compile(f"^(?:{_pattern})$"), _first
    )
# The constructor of YAML 1.1 takes 010 for eight.
_Loader.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value))


def _build_mapping(loader: _Loader, node: yaml.MappingNode) -> dict:
    """Return a mapping of YAML. Raises MarkedYAMLError for a key that is no name or is
    given twice.
    """
    content = {}
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise yaml.MarkedYAMLError(
                problem="a key is a list or a mapping; expected a name", problem_mark=key.start_mark
            )
        if key.value in content:
            raise yaml.MarkedYAMLError(
                problem=f"{key.value}: this key is given twice", problem_mark=key.start_mark
            )
        # Names are text even when they look like numbers.
        content[key.value] = loader.construct_object(value, deep=True)
    return content


_Loader.add_constructor("tag:yaml.org,2002:map", _build_mapping)


def read(file: Path, location: str = "") -> Any:
    """Read a YAML file and return its content. Raises Fault, beginning with the location (default:
    the file's name).
    """
    location = location or str(file)
    return parse(read_text(file, location), location)


def read_text(file: Path, location: str) -> str:
    """Read the text of a file. Raises Fault, beginning with a location, if that fails."""
    try:
        # Some editors begin a file with a byte order mark.
        return file.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise Fault(f"{location}: cannot be read; expected text in UTF-8") from None
    except OSError as error:
        raise Fault(f"{location}: {error.strerror}") from None


def parse(text: str, location: str) -> Any:
    """Parse YAML text strictly and return its content. Raises Fault, beginning with a location."""
    try:
        return yaml.load(text, _Loader)
    except yaml.MarkedYAMLError as error:
        line = f": line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise Fault(f"{location}{line}: {error.problem}") from None
    except (yaml.YAMLError, ValueError, LookupError, AttributeError, RecursionError) as error:
        # Characters not allowed in YAML, values that are not of their tags.
        raise Fault(f"{location}: not YAML ({str(error).splitlines()[0]})") from None


def check_known(name: Any, names: Iterable[Any], location: str, home: str = "") -> None:
    """Raise Fault, beginning with a location, for a name that is not among those known.

    home: the file of a study's folder that could define it.
    """
    names = list(names)
    if name not in names:
        where = f"; one of your own stands in {home} of the study's folder" if home else ""
        if str(name) in map(str, names):  # a number in quotes, or text without
            name, names = repr(name), map(repr, names)
        raise Fault(f"{location}: {name}: unknown{describe_known(name, names)}{where}")


def check_all(words: Iterable[Any], names: Iterable[Any], location: str) -> None:
    """Raise Fault, beginning with a location, for the first word that is not among some names."""
    names = [*names]
    for word in words:
        check_known(word, names, location)


def find_closest(word: Any, names: Iterable[Any]) -> str:
    """Return the known word that an unknown one is likely to mean, empty if none is close."""
    words = sorted({*map(str, names)})
    near = difflib.get_close_matches(str(word), words, n=1)
    # A word of the same unit may be meant, such as cpu_s for wall_s.
    near = near or [each for each in words if str(word).endswith(f"_{each.rpartition('_')[2]}")]
    return near[0] if near else ""


def describe_known(word: Any, names: Iterable[Any]) -> str:
    """Return the end of a message about an unknown word: the closest known word, if one is close,
    and the known words (of more than 40, the ten closest).
    """
    words, near = sorted({*map(str, names)}), find_closest(word, names)
    hint = f"; did you mean {near}?" if near else ";"
    if len(words) > 40:
        listed = difflib.get_close_matches(str(word), words, n=10, cutoff=0.0)
        return f"{hint} known: {', '.join(sorted(listed))} and {len(words) - len(listed)} others"
    return f"{hint} known: {', '.join(words) or 'none'}"
