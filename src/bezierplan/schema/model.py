"""Mappings in files as frozen classes, one per kind of mapping, whose fields are the keys.

They are built with pydantic, which reports every fault as a record of kind, place and input. This
module makes of it one line that names place, key, value and what would be right. The description of
a field is written once and serves three purposes: the message about a wrong value, the tables of
config/README.md, and the reader of the class.
"""

import math
import re
import textwrap
import typing
from collections.abc import Callable, Iterator
from typing import Annotated, Any, NamedTuple, Self, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    PlainValidator,
    TypeAdapter,
    ValidationError,
    WrapValidator,
    field_validator,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from bezierplan.schema.checked import Fault, closest


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
                f"{', '.join([key for key in fields if fields[key].is_required()] or fields)}"
            )
        for key in content:
            if key not in fields:
                raise wrong(f"{key}: unknown key{closest(key, fields)}")
        for key, field in fields.items():
            if field.is_required() and key not in content:
                raise wrong(f"{key}: missing key; {field.description}")
        return content

    @field_validator("*", mode="wrap")
    @classmethod
    def _describe(cls, value: Any, handler: Callable[[Any], Any], info: Any) -> Any:
        """Report a value that is wrong as a whole with the description of its field."""
        try:
            return handler(value)
        except ValidationError as error:
            faults = error.errors(include_url=False)
            if any(fault["loc"] for fault in faults):
                raise
            raise wrong(_fault(faults[0], cls.model_fields[info.field_name])) from None

    def plain(self, *without: str) -> dict[str, Any]:
        """The mapping as written, in plain values; some keys can be left out."""
        return self.model_dump(
            exclude_unset=True,
            by_alias=True,
            serialize_as_any=True,
            warnings=False,
            exclude={*without},
        )

    def but(self, **changed: Any) -> Self:
        """A copy with changed values, which are not checked."""
        return self.model_copy(update=changed)


M = TypeVar("M", bound=Model)


def keys(model: type[Model]) -> dict[str, FieldInfo]:
    """Keys of a mapping -> what they hold."""
    return {field.alias or name: field for name, field in model.model_fields.items()}


def parsed(model: type[M], content: Any, location: str) -> M:
    """The content of a file as a model. Raises Fault, beginning with a location."""
    sound, faults, _ = sound_part(model, content, location)
    if faults:
        raise Fault(*faults)
    return sound


def sound_part(model: type[M], content: Any, location: str) -> tuple[M, list[str], list[str]]:
    """What is sound of the content of a file, the faults of the rest, and the names of the entries
    that are left out for them. Raises Fault if too little is left.
    """
    try:
        return model.model_validate(content), [], []
    except ValidationError as error:
        fault = fault_of(error, location)
        places = {each["loc"][:2] for each in error.errors(include_url=False)}
    for key, name in sorted((place for place in places if len(place) == 2), reverse=True):
        del content[key][name]
    try:
        return model.model_validate(content), fault.lines, [str(each[-1]) for each in places]
    except ValidationError:
        raise fault from None


def fault_of(error: ValidationError, *location: str) -> Fault:
    """All faults of a model, those that others may follow from first, each with a location and the
    keys that lead to it.
    """
    # After a key that is itself wrong, pydantic puts `[key]`.
    lines = [
        [*location, *(str(key) for key in fault["loc"] if key != "[key]"), _fault(fault, None)]
        for fault in error.errors(include_url=False)
    ]
    lines.sort(key=lambda line: (": unknown key" not in line[-1], len(line)))
    return Fault(*map(": ".join, lines))


def wrong(text: str) -> PydanticCustomError:
    """An error with this text at the end of the line, unchanged even if it contains braces."""
    return PydanticCustomError("wrong", "{text}", {"text": text})


def expected(text: str) -> PydanticCustomError:
    """An error of a value in the place of which this was expected."""
    return PydanticCustomError("expected", "{text}", {"text": text})


def shown(value: Any) -> str:
    """A value as a message shows it."""
    return textwrap.shorten(repr(value), 100, placeholder="...")


_EXPECTED = {
    "string_type": "text",
    "bool_type": "true or false",
    "int_type": "a whole number",
    "float_type": "a number",
    "finite_number": "a number",
    "list_type": "a list",
    "dict_type": "a mapping of names to values",
    "model_attributes_type": "a mapping",
    "greater_than": "a number above {gt}",
    "greater_than_equal": "a number of at least {ge}",
    "less_than_equal": "a number of at most {le}",
    "too_short": "a list of at least {min_length}",
}
"""By the kind of a fault in a value that has no description."""


def _fault(fault: Any, field: FieldInfo | None) -> str:
    """The end of a message, by a pydantic record; for a field's value, by its description."""
    context, value = fault.get("ctx", {}), fault["input"]
    if fault["type"] == "wrong":
        return context["text"]
    known = re.findall(r"'([^']*)'", context.get("expected", ""))
    if known and isinstance(value, str):
        return f"{value}: unknown{closest(value, known)}"
    words = _EXPECTED.get(fault["type"])
    wanted = words.format_map(context) if words else context.get("text", fault["msg"])
    of_yaml = isinstance(value, int | float) and "one line" in context.get("text", "")
    quoted = f"; `{value}` is no text in YAML: put it in quotes" if of_yaml else ""
    return f"{shown(value)}: expected {field.description if field else wanted}{quoted}"


# Types of values. Numbers stay as they are written: 20 is part of names, and 20.0 another one.


def value(fits: Callable[[Any], bool], form: str) -> PlainValidator:
    """A type of single value, kept as written."""

    def check(entry: Any) -> Any:
        if not fits(entry):
            raise expected(form)
        return entry

    return PlainValidator(check)


def is_number(entry: Any) -> bool:
    """Whether it is a finite number, and not a boolean."""
    return isinstance(entry, int | float) and not isinstance(entry, bool) and abs(entry) <= LARGEST


def is_line(entry: Any) -> bool:
    """Whether it is one line of text that is not blank."""
    return isinstance(entry, str) and bool(entry.strip()) and entry.isprintable()


def _as_written(entry: Any, check: Callable[[Any], Any]) -> Any:
    check(entry)
    return entry


MOST = 1_000_000
"""Largest count: of repeats, of layouts, of cells."""
LARGEST = 1e12
"""Largest coordinate, length or weight."""


def number(**limits: float | None) -> Any:
    """A type of number within limits: `gt`, `ge`, `le`."""
    given: Any = {"ge": -LARGEST, "le": LARGEST} | limits
    return Annotated[float, Field(**given), WrapValidator(_as_written)]


def whole(low: int, high: int) -> Any:
    """A limit on a whole number."""
    return Field(ge=low, le=high)


Number, Positive, NotNegative = number(), number(gt=0, ge=None), number(ge=0)
Whole = Annotated[int, whole(0, MOST)]
Count = Annotated[int, whole(1, MOST)]
Decimals = Annotated[int, whole(0, 15)]
Flag = bool
Line = Annotated[str, value(is_line, "one line of text, not blank")]
Setting = Annotated[
    str | float | bool | None,
    value(
        lambda entry: (
            entry is None
            or is_line(entry)
            or (isinstance(entry, int | float) and not math.isnan(entry))
        ),
        "a word, a number, true or false",
    ),
]
"""A value of a planner's setting, which may be infinite, or of a column."""


def matching(pattern: str, form: str) -> PlainValidator:
    """A type of text that a regular expression matches as a whole."""
    return value(
        lambda entry: isinstance(entry, str) and bool(re.fullmatch(pattern, entry)),
        form,
    )


Name = Annotated[
    str,
    matching(
        r"[a-z][a-z0-9_]{0,99}",
        "a name of lower-case letters, digits and _ that begins with a letter",
    ),
]


def one_or_list(entry: Any) -> list:
    """A value, or a list of values, as a list."""
    return entry if isinstance(entry, list) else [entry]


def identity(entry: Any) -> str:
    """A text that equal values share, and no others: 20 and 20.0 are one number, true and 1 are
    not; also inside lists.
    """
    if isinstance(entry, list):
        return f"[{', '.join(map(identity, entry))}]"
    return repr(float(entry) if is_number(entry) else entry)


def listed(item: Any, *, least: int = 1, single: bool = False) -> Any:
    """A type of list without duplicates, or with `single` also of a lone item without a list, kept
    as written.
    """
    distinct = Annotated[list[item], Field(min_length=least), AfterValidator(_distinct)]
    if not single:
        return distinct
    return Annotated[list[item], _either(list, distinct, item)]


def _either(kind: type, of_kind: Any, other: Any) -> PlainValidator:
    """A type of value that is of one type if it is a list, or a mapping, and of another if not."""
    as_kind, as_other = TypeAdapter(of_kind), TypeAdapter(other)
    return PlainValidator(
        lambda entry: (as_kind if isinstance(entry, kind) else as_other).validate_python(
            entry, strict=True
        )
    )


def _distinct(entry: list) -> list:
    texts = [identity(each) for each in entry]
    for number, text in enumerate(texts):
        if text in texts[:number]:
            raise wrong(f"{shown(entry)}: {entry[number]!r} is listed twice")
    return entry


Values = listed(Setting, single=True)
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
            raise wrong(f"{key}: {kind}: unknown{closest(kind, models)}")
        return models[kind].model_validate(entry)

    return PlainValidator(check)


def mapping_or(mapping: Any, other: Any) -> PlainValidator:
    """A type of value that is either a mapping of one type, or of another type."""
    return _either(dict, mapping, other)


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
Where = Annotated[dict[Column, Values], Names("where")]  # type: ignore[valid-type]
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
            yield from _named(getattr(model, key), field.annotation, field.metadata, (*path, key))


def _named(
    content: Any, annotation: Any, metadata: Any, path: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], str, Any]]:
    if typing.get_origin(annotation) is Annotated:
        metadata, annotation = annotation.__metadata__, annotation.__origin__
    parts = typing.get_args(annotation) or (None,)
    if isinstance(content, Model):
        yield from named(content, path)
    elif marks := [item.what for item in metadata if isinstance(item, Names)]:
        yield path, marks[0], content
    elif isinstance(content, list):
        for number, item in enumerate(content):
            yield from _named(item, parts[0], (), (*path, str(number)))
    elif isinstance(content, dict):
        for key, item in content.items():
            yield from _named(item, parts[-1], (), (*path, key))
    elif typing.get_origin(annotation) is list:  # a lone item of `one_or_list`
        yield from _named(content, parts[0], (), path)
