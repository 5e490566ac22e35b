"""Mappings in files as frozen classes, one per kind of mapping, whose fields are the keys.

They are built with pydantic, which reports each fault as a record of kind, place and input. This
module makes one line of it that names place, key, value and what would be right. The description of
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

from bezierplan.schema.checked import Fault, describe_known, find_closest


class Model(BaseModel):
    """A mapping whose keys are exactly the fields. Only `parse` raises Fault."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    @model_validator(mode="before")
    @classmethod
    def _check_keys(cls, content: Any) -> Any:
        """Report unknown keys first: a misspelt key is also a missing one."""
        fields = list_keys(cls)
        if not isinstance(content, dict):
            raise build_error(
                f"{show_value(content)}: expected a mapping with "
                f"{', '.join([key for key in fields if fields[key].is_required()] or fields)}"
            )
        for key in content:
            if key not in fields:
                text = f"{key}: unknown key{describe_known(key, fields)}"
                raise PydanticCustomError(
                    "unknown_key", "{text}", {"text": text, "key": key, "known": [*fields]}
                )
        for key, field in fields.items():
            if field.is_required() and key not in content:
                raise build_error(f"{key}: missing key; {field.description}")
        return content

    @field_validator("*", mode="wrap")
    @classmethod
    def _describe(cls, value: Any, handler: Callable[[Any], Any], info: Any) -> Any:
        """Report a value that is wrong as a whole with the description of its field."""
        try:
            return handler(value)
        except ValidationError as error:
            faults = error.errors(include_url=False)
            # A fault inside the value has a place and a message of its own.
            if any(fault["loc"] or fault["type"] == "unknown_key" for fault in faults):
                raise
            raise build_error(
                _describe_fault(faults[0], cls.model_fields[info.field_name])
            ) from None

    def plain(self, *without: str) -> dict[str, Any]:
        """Return the mapping as written, in plain values, without some keys."""
        return self.model_dump(
            exclude_unset=True,
            by_alias=True,
            serialize_as_any=True,
            warnings=False,
            exclude={*without},
        )

    def but(self, **changed: Any) -> Self:
        """Return a copy with changed values, which are not checked."""
        return self.model_copy(update=changed)


M = TypeVar("M", bound=Model)


def list_keys(model: type[Model]) -> dict[str, FieldInfo]:
    """Return the keys of a mapping, each with its field."""
    return {field.alias or name: field for name, field in model.model_fields.items()}


def parse(model: type[M], content: Any, *location: str) -> M:
    """Validate loaded content of a file, plain values, and return it as a model. Raises Fault, each
    line beginning with the location.
    """
    sound, faults, _ = parse_sound_part(model, content, *location)
    if faults:
        raise Fault(*faults)
    return sound


def parse_sound_part(
    model: type[M], content: Any, *location: str
) -> tuple[M, list[str], list[tuple[str, str]]]:
    """Return the sound part of a file's content as a model, the faults of the rest, and section and
    name of the entries that are left out for them. Raises Fault if too little is left.

    An unknown key is taken out, and the rest of its mapping is checked without it.
    """
    lines: dict[str, None] = {}
    while True:
        try:
            return model.model_validate(content), [*lines], []
        except ValidationError as error:
            faults, told = error.errors(include_url=False), len(lines)
            lines |= dict.fromkeys(_list_fault_lines(error, *location))
        # Options that panels share are copied before they are checked, so their unknown keys stay
        # and are told again.
        if len(lines) == told or not _take_out_unknown_keys(faults):
            break
    places = {each["loc"][:2] for each in faults}
    # From the end, so that the numbers of entries in a list stay valid.
    for key, name in sorted((place for place in places if len(place) == 2), reverse=True):
        del content[key][name]
    try:
        return (
            model.model_validate(content),
            [*lines],
            [(str(each[0]), str(each[-1])) for each in places],
        )
    except ValidationError:
        raise Fault(*lines) from None


def _take_out_unknown_keys(faults: list[Any]) -> bool:
    """Take the unknown keys that faults are about out of their mappings, and return whether there
    are any.

    A value moves to the key that is likely meant, which else would be missing, too.
    """
    unknown = [each for each in faults if each["type"] == "unknown_key"]
    for each in unknown:
        key, mapping = each["ctx"]["key"], each["input"]
        value = mapping.pop(key, None)
        if meant := find_closest(key, each["ctx"]["known"]):
            mapping.setdefault(meant, value)
    return bool(unknown)


def _list_fault_lines(error: ValidationError, *location: str) -> list[str]:
    """List a line for each fault of a model, with a location and the keys that lead to it."""
    # After a key that is itself wrong, pydantic puts `[key]`.
    lines = [
        [
            *location,
            *(str(key) for key in fault["loc"] if key != "[key]"),
            _describe_fault(fault, None),
        ]
        for fault in error.errors(include_url=False)
    ]
    # Faults from which others may follow come first: the first line is the text of the exception.
    lines.sort(key=lambda line: (": unknown key" not in line[-1], len(line)))
    return [*map(": ".join, lines)]


def build_error(text: str) -> PydanticCustomError:
    """Return an error with this text at the end of the line, unchanged even if it contains
    braces.
    """
    return PydanticCustomError("wrong", "{text}", {"text": text})


def build_expectation(text: str) -> PydanticCustomError:
    """Return an error about a value in whose place this was expected."""
    return PydanticCustomError("expected", "{text}", {"text": text})


def show_value(value: Any) -> str:
    """Return a value in the form that a message shows."""
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
"""pydantic's name of a fault -> what is expected of a value without a description."""


def _describe_fault(fault: Any, field: FieldInfo | None) -> str:
    """Return the end of a message for one of pydantic's faults.

    field: its description says what is expected, if it is given.
    """
    context, value = fault.get("ctx", {}), fault["input"]
    if fault["type"] in ("wrong", "unknown_key"):
        return context["text"]
    known = re.findall(r"'([^']*)'", context.get("expected", ""))
    if known and isinstance(value, str):
        return f"{value}: unknown{describe_known(value, known)}"
    words = _EXPECTED.get(fault["type"])
    wanted = words.format_map(context) if words else context.get("text", fault["msg"])
    of_yaml = isinstance(value, int | float) and "one line" in context.get("text", "")
    quoted = f"; `{value}` is no text in YAML: put it in quotes" if of_yaml else ""
    return f"{show_value(value)}: expected {field.description if field else wanted}{quoted}"


# Types of values. Numbers stay as they are written: 20 is part of names, and 20.0 another one.


def build_value_type(fits: Callable[[Any], bool], form: str) -> Any:
    """Return a type of single value that is kept as written. form: what is expected, for
    messages.
    """

    def check(entry: Any) -> Any:
        if not fits(entry):
            raise build_expectation(form)
        return entry

    return Annotated[Any, PlainValidator(check)]


def is_number(entry: Any) -> bool:
    """Return whether an entry is a finite number, and not a boolean."""
    return isinstance(entry, int | float) and not isinstance(entry, bool) and abs(entry) <= LARGEST


def is_line(entry: Any) -> bool:
    """Return whether an entry is one line of text that is not blank."""
    return isinstance(entry, str) and bool(entry.strip()) and entry.isprintable()


def _keep_as_written(entry: Any, check: Callable[[Any], Any]) -> Any:
    """Check an entry, and return it unchanged."""
    check(entry)
    return entry


MOST = 1_000_000
"""Largest count: of repeats, layouts or cells."""
LARGEST = 1e12
"""Largest coordinate, length or weight."""


def build_number_type(**limits: float | None) -> Any:
    """Return a type of number within limits: `gt`, `ge`, `le`."""
    given: Any = {"ge": -LARGEST, "le": LARGEST} | limits
    return Annotated[float, Field(**given), WrapValidator(_keep_as_written)]


def build_whole_type(low: int, high: int) -> Any:
    """Return a type of whole number from `low` to `high`."""
    return Annotated[int, Field(ge=low, le=high)]


Number, Positive, NotNegative = (
    build_number_type(),
    build_number_type(gt=0, ge=None),
    build_number_type(ge=0),
)
Whole: Any = build_whole_type(0, MOST)
Count: Any = build_whole_type(1, MOST)
Decimals: Any = build_whole_type(0, 15)
Line: Any = build_value_type(is_line, "one line of text, not blank")
Setting: Any = build_value_type(
    lambda entry: (
        entry is None
        or is_line(entry)
        or (isinstance(entry, int | float) and not math.isnan(entry))
    ),
    "a word, a number, true or false",
)
"""A value of a planner's setting, which may be infinite, or of a column."""


def build_text_type(pattern: str, form: str) -> Any:
    """Return a type of text that a regular expression matches as a whole."""
    return build_value_type(
        lambda entry: isinstance(entry, str) and bool(re.fullmatch(pattern, entry)),
        form,
    )


Name: Any = build_text_type(
    r"[a-z][a-z0-9_]{0,99}",
    "a name of lower-case letters, digits and _ that begins with a letter",
)


def convert_to_list(entry: Any) -> list:
    """Return a list as it is, and any other value as a list of one."""
    return entry if isinstance(entry, list) else [entry]


def identify(entry: Any) -> str:
    """Return a text that equal values share, and no others. 20 and 20.0 are one number, true and 1
    are not; also inside lists.
    """
    if isinstance(entry, list):
        return f"[{', '.join(map(identify, entry))}]"
    return repr(float(entry) if is_number(entry) else entry)


def build_list_type(item: Any, *, least: int = 1, single: bool = False) -> Any:
    """Return a type of list without duplicates.

    least: smallest length. single: also allow one item without a list, which is kept as written.
    """
    distinct = Annotated[list[item], Field(min_length=least), AfterValidator(_check_distinct)]
    if not single:
        return distinct
    return Annotated[list[item], _build_either_type(list, distinct, item)]


def _build_either_type(kind: type, of_kind: Any, other: Any) -> PlainValidator:
    """Return a type of value that is `of_kind` for a list or mapping (`kind`), and `other` for the
    rest.
    """
    as_kind, as_other = TypeAdapter(of_kind), TypeAdapter(other)
    return PlainValidator(
        lambda entry: (as_kind if isinstance(entry, kind) else as_other).validate_python(
            entry, strict=True
        )
    )


def _check_distinct(entry: list) -> list:
    """Return a list, or raise an error if it has an item twice."""
    texts = [identify(each) for each in entry]
    for number, text in enumerate(texts):
        if text in texts[:number]:
            raise build_error(f"{show_value(entry)}: {entry[number]!r} is listed twice")
    return entry


Values = build_list_type(Setting, single=True)
"""A value of a column, or a list of them."""


def build_choice_type(key: str, models: dict[str, type[Model]]) -> PlainValidator:
    """Return a type of mapping in which the value of one key selects the model."""

    def check(entry: Any) -> Model:
        if not isinstance(entry, dict):
            raise build_expectation(f"a mapping with {key}")
        if key not in entry:
            raise build_error(f"{key}: missing key; one of {', '.join(sorted(models))}")
        kind = entry[key]
        if not isinstance(kind, str) or kind not in models:
            raise build_error(f"{key}: {kind}: unknown{describe_known(kind, models)}")
        return models[kind].model_validate(entry)

    return PlainValidator(check)


def build_mapping_type(mapping: Any, other: Any) -> Any:
    """Return a type of value that is a mapping of one type, or a value of another type."""
    return Annotated[Any, _build_either_type(dict, mapping, other)]


# Names defined elsewhere.


class Names(NamedTuple):
    """Marks a field whose text names something: a metric, a column, a method, ... `find_names`
    finds these names, and `checks` looks them up.
    """

    what: str


def build_name_type(what: str, form: Any = Name) -> Any:
    """Return a type of value, of the type `form`, that names something defined elsewhere."""
    return Annotated[form, Names(what)]


Metric = build_name_type("metric")
Statistic = build_name_type("statistic")
Column = build_name_type("column")
"""A column that is known before a run and so identifies runs."""
NumberColumn = build_name_type("number column")
"""A column of numbers that is known before a run."""
Quantity = build_name_type("quantity")
"""Any column of numbers."""
Repeat = build_name_type("repeat", Whole)
PrintedTable = build_name_type("printed table", Line)
ExperimentName = build_name_type("experiment")
WorkspaceName = build_name_type("workspace")
Function = build_name_type("function")
Where = build_name_type("where", dict[Column, Values])  # type: ignore[valid-type]
Arguments = dict[Name, Any]
"""Keyword-only arguments of a study's function; `checks` compares them with its annotations."""
ARGUMENTS = (
    "the function's keyword-only arguments, by name: "
    "values that the paper gives, or that were chosen"
)


def find_names(
    model: Model, path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], str, Any]]:
    """Yield each name in a model that is defined elsewhere: the keys that lead to it, what it
    names, and the name itself.
    """
    for key, field in type(model).model_fields.items():
        # Defaults name nothing that a file could have wrong.
        if key in model.model_fields_set:
            yield from _find_names(
                getattr(model, key), field.annotation, field.metadata, (*path, key)
            )


def _find_names(
    content: Any, annotation: Any, metadata: Any, path: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], str, Any]]:
    """Yield the names in a field's value of what is defined elsewhere, as `find_names` does."""
    if typing.get_origin(annotation) is Annotated:
        metadata, annotation = annotation.__metadata__, annotation.__origin__
    parts = typing.get_args(annotation) or (None,)
    if isinstance(content, Model):
        yield from find_names(content, path)
    elif marks := [item.what for item in metadata if isinstance(item, Names)]:
        yield path, marks[0], content
    elif isinstance(content, list):
        for number, item in enumerate(content):
            yield from _find_names(item, parts[0], (), (*path, str(number)))
    elif isinstance(content, dict):
        for key, item in content.items():
            yield from _find_names(item, parts[-1], (), (*path, key))
    elif typing.get_origin(annotation) is list:  # a lone item of `convert_to_list`
        yield from _find_names(content, parts[0], (), path)
