"""Mappings in files as frozen classes, one per kind of mapping, whose fields are the keys.

They are built with pydantic. Snakemake has already loaded it when a study is read, so it adds
nothing to the start-up time (msgspec would add 0.05 s), and it reports every fault as a record of
kind, place and input, from which this module makes one line that names place, key, value and what
would be right. msgspec stops at the first fault and then reports a misspelt key as a missing one.

The description of a field is written once and serves three purposes: the message about a wrong
value, the tables of config/README.md, and the reader of the class. The types below reject what
`pydantic` would convert: a number stays the integer or the decimal that was written.
"""

import math
import re
import types
import typing
from collections.abc import Callable, Iterable, Iterator
from typing import Annotated, Any, NamedTuple, Self, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    PlainValidator,
    TypeAdapter,
    ValidationError,
    field_validator,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from bezierplan.schema.checked import Fault, closest

LONGEST_VALUE = 100
"""Characters of a value that a message shows."""


class Model(BaseModel):
    """A mapping whose keys are exactly the fields. Only `parsed` raises Fault."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    @model_validator(mode="before")
    @classmethod
    def _check_keys(cls, content: Any) -> Any:
        """Report unknown keys first: a misspelt key is also a missing one."""
        fields = keys(cls)
        if not isinstance(content, dict):
            raise wrong(
                f"{shown(content)}: expected a mapping with "
                f"{', '.join(key for key in fields if fields[key].is_required()) or 'keys'}"
            )
        for key in content:
            if key not in fields:
                raise wrong(f"{key}: unknown key{closest(key, fields)}")
        for key, field in fields.items():
            if field.is_required() and key not in content:
                raise wrong(f"{key}: missing key; {field.description}")
            if key in content and content[key] is None:
                raise wrong(f"{key}: has no value; expected {field.description}")
        return content

    @field_validator("*", mode="wrap")
    @classmethod
    def _describe(cls, value: Any, handler: Callable[[Any], Any], info: Any) -> Any:
        """Report a value that is wrong as a whole with the description of its field."""
        try:
            return handler(value)
        except ValidationError as error:
            if any(fault["loc"] for fault in error.errors(include_url=False)):
                raise
            field = cls.model_fields[info.field_name]
            raise wrong(_fault(error.errors(include_url=False)[0], field)) from None

    def plain(self, *without: str) -> dict[str, Any]:
        """The mapping as written, in plain values, for jobs; some keys can be left out."""
        fields = type(self).model_fields.items()
        entry = {
            field.alias or name: getattr(self, name)
            for name, field in fields
            if name in self.model_fields_set
        }
        return {key: plain(value) for key, value in entry.items() if key not in without}

    def but(self, **changed: Any) -> Self:
        """A copy with changed values, which are not checked."""
        return self.model_copy(update=changed)


M = TypeVar("M", bound=Model)


def keys(model: type[Model]) -> dict[str, FieldInfo]:
    """Keys of a mapping -> what they hold."""
    return {field.alias or name: field for name, field in model.model_fields.items()}


def defaults(model: type[Model]) -> dict[str, Any]:
    """Keys that a mapping can leave out -> the values that they then have, None for none."""
    return {key: field.default for key, field in keys(model).items() if not field.is_required()}


def plain(value: Any) -> Any:
    """Models and named tuples as mappings, also inside lists and mappings; of a named tuple without
    what has its default.
    """
    if isinstance(value, Model):
        return value.plain()
    if hasattr(value, "_asdict"):
        absent, entry = value._field_defaults, value._asdict()
        return {
            name: plain(each)
            for name, each in entry.items()
            if name not in absent or each != absent[name]
        }
    if isinstance(value, dict):
        return {key: plain(each) for key, each in value.items()}
    return [plain(each) for each in value] if isinstance(value, list | tuple) else value


J = TypeVar("J")


def job(kind: type[J], params: Any) -> J:
    """A job as the named tuple from before `plain`. Raises ValidationError for other content."""
    return TypeAdapter(kind).validate_python(params)


def parsed(model: type[M], content: Any, location: str) -> M:
    """The content of a file as a model. Raises Fault, beginning with a location."""
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise Fault(": ".join([location, *first_fault(error)])) from None


def first_fault(error: ValidationError) -> list[str]:
    """The fault that is reported of several: the keys that lead to it, and its message's end."""
    # After a key that is itself wrong, pydantic puts `[key]`.
    faults = [
        ([str(key) for key in fault["loc"] if key != "[key]"], _fault(fault, None))
        for fault in error.errors(include_url=False)
    ]
    path, text = min(faults, key=lambda fault: (": unknown key" not in fault[1], len(fault[0])))
    return [*path, text]


def wrong(text: str) -> PydanticCustomError:
    """An error with this text at the end of the line, unchanged even if it contains braces."""
    return PydanticCustomError("wrong", "{text}", {"text": text})


def expected(text: str) -> PydanticCustomError:
    """An error of a value in the place of which this was expected."""
    return PydanticCustomError("expected", "{text}", {"text": text})


def shown(value: Any) -> str:
    """A value as a message shows it."""
    text = repr(value)
    return text if len(text) <= LONGEST_VALUE else f"{text[: LONGEST_VALUE - 3]}..."


_EXPECTED = {
    "string_type": "text",
    "bool_type": "true or false",
    "list_type": "a list",
    "dict_type": "a mapping of names to values",
    "model_attributes_type": "a mapping",
}


def _fault(fault: Any, field: FieldInfo | None) -> str:
    """The end of a message, by a pydantic record; for a field's value, by its description."""
    context, value = fault.get("ctx", {}), fault["input"]
    if fault["type"] == "wrong":
        return context["text"]
    if fault["type"] == "expected" and field is None:
        return f"{shown(value)}: expected {context['text']}"
    if fault["type"] == "literal_error" and isinstance(value, str):
        known = re.findall(r"'([^']*)'", context["expected"])
        return f"{value}: unknown{closest(value, known)}"
    return (
        f"{shown(value)}: expected "
        f"{field.description if field else _EXPECTED.get(fault['type'], fault['msg'])}"
    )


# Types of values.


def value(fits: Callable[[Any], bool], wanted: str) -> PlainValidator:
    """A type of single value, kept as written."""

    def check(entry: Any) -> Any:
        if not fits(entry):
            raise expected(wanted)
        return entry

    return PlainValidator(check)


def is_number(entry: Any) -> bool:
    """Whether it is a finite number, and not a boolean."""
    if isinstance(entry, int):
        return not isinstance(entry, bool) and abs(entry) < 10**300  # the others are no floats
    return isinstance(entry, float) and math.isfinite(entry)


def _is_whole(entry: Any) -> bool:
    return isinstance(entry, int) and not isinstance(entry, bool)


def _is_huge(entry: Any) -> bool:
    return isinstance(entry, int) and abs(entry) >= 10**9


LONGEST_LINE = 600
"""Characters of a text."""


def is_line(entry: Any, longest: int = LONGEST_LINE) -> bool:
    """Whether it is one line of printable text that is not blank, of at most so many characters."""
    return (
        isinstance(entry, str)
        and bool(entry.strip())
        and len(entry) <= longest
        and entry.isprintable()
    )


LONGEST_LABEL, LONGEST_WORD = 80, 30
"""Characters of a text that is printed in a figure or in the head of a table, and of a word in it:
lines are broken at blanks.
"""
MOST = 1_000_000
"""Largest count: of repeats, of layouts, of cells."""
SMALLEST, LARGEST = 1e-12, 1e12
"""Size of a number other than 0: beyond, arithmetic with coordinates and lengths means nothing."""


def sized(fits: Callable[[Any], bool], wanted: str) -> PlainValidator:
    """A type of number, kept as written, of a size that can be meant."""

    def check(entry: Any) -> Any:
        if not (is_number(entry) and fits(entry)):
            raise expected(wanted)
        if entry and not SMALLEST <= abs(entry) <= LARGEST:
            raise wrong(f"{shown(entry)}: expected a size from {SMALLEST:g} to {LARGEST:g}, or 0")
        return entry

    return PlainValidator(check)


Number = Annotated[float, sized(lambda entry: True, "a number")]
Positive = Annotated[float, sized(lambda entry: entry > 0, "a number above 0")]
NotNegative = Annotated[float, sized(lambda entry: entry >= 0, "a number of at least 0")]


def whole(low: int, high: int) -> PlainValidator:
    """A type of whole number, not true or false, between two limits that are part of it."""
    return value(
        lambda entry: _is_whole(entry) and low <= entry <= high,
        f"a whole number from {low} to {high}",
    )


Whole = Annotated[int, whole(0, MOST)]
Count = Annotated[int, whole(1, MOST)]
Decimals = Annotated[int, whole(0, 15)]


def line(longest: int) -> PlainValidator:
    """A type of text: one line, kept as written."""
    return value(
        lambda entry: is_line(entry, longest),
        f"one line of text without control characters, not blank, at most {longest} characters",
    )


Line = Annotated[str, line(LONGEST_LINE)]
Label = Annotated[
    str,
    value(
        lambda entry: (
            is_line(entry, LONGEST_LABEL) and max(map(len, entry.split())) <= LONGEST_WORD
        ),
        f"one line of text without control characters, not blank, at most {LONGEST_LABEL} "
        f"characters, {LONGEST_WORD} a word",
    ),
]
Flag = Annotated[bool, value(lambda entry: isinstance(entry, bool), "true or false")]
Scalar = Annotated[
    str | float | bool,
    value(
        lambda entry: isinstance(entry, bool) or is_number(entry) or is_line(entry, LONGEST_LINE),
        "a word or a number",
    ),
]
"""A value of a column: a word, a number, true or false."""
Setting = Annotated[
    str | float | bool | None,
    value(
        lambda entry: (
            entry is None
            or is_line(entry, LONGEST_LINE)
            or (isinstance(entry, int | float) and not math.isnan(entry) and not _is_huge(entry))
        ),
        "a word, a number, true or false",
    ),
]
"""A value of a planner's setting, which may be infinite."""

LONGEST_NAME = 100
"""Characters of a name, which is part of paths."""
DEVICES = frozenset(
    {
        "con",
        "prn",
        "aux",
        "nul",
        *(f"{port}{number}" for port in ("com", "lpt") for number in range(10)),
    }
)
"""Names that no file can have on Windows."""


def matching(pattern: str, wanted: str) -> PlainValidator:
    """A type of text that a regular expression matches as a whole, and that a file or folder can be
    called.
    """

    def check(entry: Any) -> Any:
        if not (isinstance(entry, str) and re.fullmatch(pattern, entry)):
            raise expected(wanted)
        if len(entry) > LONGEST_NAME:
            raise wrong(f"{shown(entry)}: {len(entry)} characters; expected at most {LONGEST_NAME}")
        if entry in DEVICES:
            raise wrong(f"{entry}: the name of a device on Windows; expected another one")
        return entry

    return PlainValidator(check)


Name = Annotated[
    str,
    matching(
        r"[a-z][a-z0-9_]*", "a name of lower-case letters, digits and _ that begins with a letter"
    ),
]


def one_or_list(entry: Any) -> list:
    """A value, or a list of values, as a list."""
    return entry if isinstance(entry, list) else [entry]


MOST_ENTRIES = 1000
"""Entries of a list of names or values, and of a mapping of what has a name: methods, problems,
claims, ...
"""


def identity(entry: Any) -> str:
    """A text that equal values share, and no others: 20 and 20.0 are one number, true and 1 are
    not; also inside lists.
    """
    if isinstance(entry, list):
        return f"[{', '.join(map(identity, entry))}]"
    return repr(float(entry) if is_number(entry) else entry)


def at_most(number: int) -> AfterValidator:
    """A limit on the entries of a list or mapping."""

    def check(entry: Any) -> Any:
        if len(entry) > number:
            raise wrong(f"{len(entry)} entries; expected at most {number}")
        return entry

    return AfterValidator(check)


def listed(item: Any, *, least: int = 1, most: int = MOST_ENTRIES, single: bool = False) -> Any:
    """A type of list without duplicates, kept as written; with `single`, also a lone item without a
    list.
    """
    return Annotated[list[item], _distinct(item, least=least, most=most, single=single)]


def _distinct(
    item: Any, *, least: int = 1, most: int = MOST_ENTRIES, single: bool = False
) -> PlainValidator:
    adapter = TypeAdapter(list[item], config=ConfigDict(strict=True))

    def check(entry: Any) -> Any:
        if not isinstance(entry, list) and not single:
            raise expected("a list")
        if isinstance(entry, list) and len(entry) > most:
            raise wrong(f"{len(entry)} entries; expected at most {most}")
        try:
            items = adapter.validate_python(one_or_list(entry))
        except ValidationError:
            if isinstance(entry, list):
                raise
            raise expected("a value or a list of values") from None
        if isinstance(entry, list) and len(items) < least:
            raise expected(f"a list of at least {least}")
        texts: dict[str, None] = {}
        for each in items:
            if (text := identity(each)) in texts:
                raise wrong(f"{shown(entry)}: {each!r} is listed twice")
            texts[text] = None
        return items if isinstance(entry, list) else items[0]

    return PlainValidator(check)


Values = Annotated[list[Scalar], _distinct(Scalar, single=True)]
"""A value of a column or a list of them."""


def one_of(key: str, models: dict[str, type[Model]]) -> PlainValidator:
    """A type of mapping in which the value of one key selects the model."""

    def check(entry: Any) -> Model:
        if not isinstance(entry, dict):
            raise expected(f"a mapping with {key}")
        if key not in entry:
            raise wrong(f"{key}: missing key; one of {', '.join(sorted(models))}")
        kind = entry[key]
        if not isinstance(kind, str) or kind not in models:
            raise wrong(
                f"{key}: {kind if isinstance(kind, str) else shown(kind)}: "
                f"unknown{closest(kind, models)}"
            )
        return models[kind].model_validate(entry)

    return PlainValidator(check)


def mapping_or(mapping: Any, other: Any) -> PlainValidator:
    """A type of value that is either a mapping of one type, or of another type."""
    as_mapping, as_other = TypeAdapter(mapping), TypeAdapter(other)
    return PlainValidator(
        lambda entry: (as_mapping if isinstance(entry, dict) else as_other).validate_python(entry)
    )


def after(check: Callable[[Any], Any]) -> AfterValidator:
    """A further check of a value that has passed the previous ones."""
    return AfterValidator(check)


# Names defined elsewhere.


class Names(NamedTuple):
    """Marks a field whose text names something: a metric, a column, a method, ...; `named` finds
    these names, and `checks` looks them up.
    """

    what: str


Metric = Annotated[Name, Names("metric")]
Statistic = Annotated[Name, Names("statistic")]
Column = Annotated[Name, Names("column")]
"""A column that is known before a run: runs are told apart by it."""
NumberColumn = Annotated[Name, Names("number column")]
"""Such a column of numbers."""
Quantity = Annotated[Name, Names("quantity")]
"""Any column of numbers."""
Repeat = Annotated[Whole, Names("repeat")]
PrintedTable = Annotated[Line, Names("printed table")]
Experiment = Annotated[Name, Names("experiment")]
Workspace = Annotated[Name, Names("workspace")]
Function = Annotated[Name, Names("function")]
Where = Annotated[dict[Column, Values], Names("where")]
Arguments = dict[Name, Any]
"""Keyword-only arguments of a study's function, which `checks` compares with annotations."""
ARGUMENTS = (
    "the function's keyword-only arguments, by name: "
    "values that the paper gives, or that were chosen"
)


def named(model: Model, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], str, Any]]:
    """Every name in a model that is defined elsewhere: the keys to it, what it names, the name."""
    for key, field in type(model).model_fields.items():
        if key in model.model_fields_set:
            yield from _named(getattr(model, key), field.metadata, field.annotation, (*path, key))


def unwrapped(metadata: Iterable[Any], annotation: Any) -> tuple[list[Any], Any]:
    """What stands beside a type, and the type itself, whether a key may be left out (`type | None`)
    or not.
    """
    metadata = list(metadata)
    while True:
        parts = typing.get_args(annotation)
        if typing.get_origin(annotation) is Annotated:
            metadata, annotation = [*metadata, *annotation.__metadata__], annotation.__origin__
        elif (
            typing.get_origin(annotation) in (typing.Union, types.UnionType)
            and len(parts) == 2
            and parts[1] is type(None)
        ):
            annotation = parts[0]
        else:
            return metadata, annotation


def _named(
    content: Any, metadata: Any, annotation: Any, path: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], str, Any]]:
    if isinstance(content, Model):
        yield from named(content, path)
        return
    metadata, annotation = unwrapped(metadata, annotation)
    marks = [item.what for item in metadata if isinstance(item, Names)]
    for what in marks[:1]:
        yield path, what, content
    if marks:
        return
    parts = typing.get_args(annotation)
    if isinstance(content, list):
        for number, item in enumerate(content):
            yield from _named(item, [], parts[0] if parts else None, (*path, str(number)))
    elif isinstance(content, dict):
        for key, item in content.items():
            yield from _named(item, [], parts[1] if len(parts) > 1 else None, (*path, key))
    elif typing.get_origin(annotation) is list:  # a lone item of `one_or_list`
        yield from _named(content, [], parts[0], path)
