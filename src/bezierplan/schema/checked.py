"""YAML files read strictly, within stated limits; a fault is one line with its place.

YAML is written by people and read from folders of unknown origin, so anything that could overload
the reader is rejected before it is built: files that are not regular, long files, deep nesting, and
aliases that expand beyond what a file could hold. Tags are not supported, because plain scalars get
their types without them.
"""

import difflib
import re
import stat
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import yaml

from bezierplan.schema.words import plain

try:
    from yaml import CSafeLoader as SafeLoader
except ImportError:  # PyYAML was built without libyaml
    from yaml import SafeLoader

LONGEST_FILE = 4_000_000
"""Bytes of the longest file that is read: a study's YAML, maps, published numbers."""
DEEPEST = 20
"""Levels of the deepest nesting in YAML."""
TOO_DEEP = f"nested more than {DEEPEST} levels deep"
MOST_NODES = 200_000
"""Values in one YAML file, aliases counted as what they stand for."""


LONGEST_MESSAGE, MESSAGE_END = 1000, 300
"""Characters of the longest message, and how many of its end are shown of a longer one."""


class Fault(ValueError):
    """A problem in a file that the user must fix, in one line of bounded length: no character from
    the file can break the line.
    """

    def __init__(self, text: str) -> None:
        if len(text) > LONGEST_MESSAGE:
            text = f"{text[: LONGEST_MESSAGE - MESSAGE_END - 5]} ... {text[-MESSAGE_END:]}"
        super().__init__(plain(text))


class _Loader(SafeLoader):
    """YAML 1.2's plain scalars: `no` is a word, `0_15` is a word, `010` is ten, `1e-3` is a number;
    a key may occur only once.
    """


_Loader.yaml_implicit_resolvers = {}
for _tag, _pattern, _first in (
    ("null", r"|null|~", ["", "n", "~"]),
    ("bool", r"true|false", list("tf")),
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
_Loader.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value))


def _mapping(loader: _Loader, node: yaml.MappingNode) -> dict:
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


_Loader.add_constructor("tag:yaml.org,2002:map", _mapping)


def read(file: Path, location: str | None = None) -> Any:
    """The content of a YAML file. Raises Fault, beginning with the place (default: file name)."""
    return parse(text_of(file, location or str(file)), location or str(file))


def text_of(file: Path, location: str) -> str:
    """The text of a file. Raises Fault, beginning with a location, unless it is a regular text file
    of at most `LONGEST_FILE` bytes.
    """
    try:
        found = file.stat()
        if not stat.S_ISREG(found.st_mode):
            raise Fault(f"{location}: cannot be read (not a regular file)")
        if found.st_size > LONGEST_FILE:
            raise Fault(f"{location}: {found.st_size} bytes; expected at most {LONGEST_FILE}")
        return file.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise Fault(f"{location}: cannot be read; expected text in UTF-8") from None
    except OSError as error:
        raise Fault(f"{location}: cannot be read ({type(error).__name__})") from None


def parse(text: str, location: str) -> Any:
    """The content of YAML text, read strictly. Raises Fault, beginning with a location."""
    try:
        _check_size(text, location)
        return yaml.load(text, _Loader)
    except yaml.MarkedYAMLError as error:
        # Newer versions of libyaml have a limit of their own, and meet it where they read ahead.
        problem = TOO_DEEP if error.problem == "exceeded maximum nesting depth" else error.problem
        raise Fault(f"{_line(location, error.problem_mark)}: {problem}") from None
    except yaml.YAMLError as error:  # characters not allowed in YAML
        raise Fault(f"{location}: not YAML ({str(error).splitlines()[0]})") from None


def _line(location: str, mark: Any) -> str:
    return f"{location}: line {mark.line + 1}" if mark else location


def _check_size(text: str, location: str) -> None:
    """Raise Fault for nesting and aliases beyond the limits, and for tags, from the events alone,
    before anything is built.
    """
    sizes: dict[str, int] = {}  # of nodes with an anchor
    opened = [("", 0)]  # anchor and value count so far of each open node
    for event in yaml.parse(text, _Loader):
        anchor, size = getattr(event, "anchor", None) or "", 0
        if getattr(event, "tag", None):
            raise Fault(
                f"{_line(location, event.start_mark)}: {event.tag}: "
                "tags are not read; write the plain value"
            )
        if isinstance(event, yaml.CollectionStartEvent):
            opened.append((anchor, 1))
            if len(opened) > DEEPEST:
                raise Fault(f"{_line(location, event.start_mark)}: {TOO_DEEP}")
        elif isinstance(event, yaml.AliasEvent):
            if anchor not in sizes:
                raise Fault(
                    f"{_line(location, event.start_mark)}: *{anchor}: stands for nothing before "
                    "it, or for itself"
                )
            size = sizes[anchor]
        elif isinstance(event, yaml.ScalarEvent):
            sizes[anchor] = size = 1
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, size = opened.pop()
            sizes[anchor] = size
        opened[-1] = opened[-1][0], opened[-1][1] + size
        if opened[-1][1] > MOST_NODES:
            raise Fault(
                f"{_line(location, event.start_mark)}: more than {MOST_NODES} values, aliases "
                "counted as what they stand for"
            )


def check_known(name: Any, known: Iterable[Any], location: str) -> None:
    """Raise Fault, beginning with a location, for a name that is not among those known."""
    known = list(known)
    if name not in known:
        raise Fault(f"{location}: {name}: unknown{closest(name, known)}")


# More known words than this are not all listed, but only some that are most alike.
MOST_LISTED, FEW_LISTED = 40, 10


def closest(word: Any, known: Iterable[Any]) -> str:
    """`; did you mean ...?` and the known words, or those most alike of many, to end a sentence
    about an unknown one.
    """
    words = sorted(map(str, known))
    near = difflib.get_close_matches(str(word), words, n=1)
    hint = f"; did you mean {near[0]}?" if near else ";"
    if len(words) > MOST_LISTED:
        listed = difflib.get_close_matches(str(word), words, n=FEW_LISTED, cutoff=0.0)
        return f"{hint} known: {', '.join(sorted(listed))} and {len(words) - len(listed)} others"
    return f"{hint} known: {', '.join(words) or 'none'}"
