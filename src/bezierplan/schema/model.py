"""Mappings in files as frozen classes, one per kind of mapping, whose fields are the keys.

They are built with pydantic. Snakemake has already loaded it when a study is read, so it adds nothing to the start-up time (msgspec
would add 0.05 s), and it reports every fault as a record of kind, place and input, from which this module makes one line that names
place, key, value and what would be right. msgspec stops at the first fault and then reports a misspelt key as a missing one.

The description of a field is written once and serves three purposes: the message about a wrong value, the tables of config/README.md,
and the reader of the class. The types below reject what `pydantic` would convert: a number stays the integer or the decimal that was
written.
"""

import math
import re
import typing
from collections.abc import Callable, Iterator
from typing import Annotated, Any, NamedTuple, Self, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, PlainValidator, TypeAdapter, ValidationError, field_validator, model_validator
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
    def _check_keys(cls, given: Any) -> Any:
        """Report unknown keys first: a misspelt key is also a missing one."""
        fields = keys(cls)
        if not isinstance(given, dict):
            raise wrong(
                f"{shown(given)}: expected a mapping with {', '.join(key for key in fields if fields[key].is_required()) or 'keys'}"
            )
        for key in given:
            if key not in fields:
                raise wrong(f"{key}: unknown key{closest(key, fields)}")
        for key, field in fields.items():
            if field.is_required() and key not in given:
                raise wrong(f"{key}: missing key; {field.description}")
            if key in given and given[key] is None:
                raise wrong(f"{key}: has no value; expected {field.description}")
        return given

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
        given = {field.alias or name: getattr(self, name) for name, field in fields if name in self.model_fields_set}
        return {key: plain(value) for key, value in given.items() if key not in without}

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
    """Models as mappings, also inside lists and mappings."""
    if isinstance(value, Model):
        return value.plain()
    if isinstance(value, dict):
        return {key: plain(each) for key, each in value.items()}
    return [plain(each) for each in value] if isinstance(value, list) else value


def parsed(model: type[M], content: Any, place: str) -> M:
    """The content of a file as a model. Raises Fault, beginning with a place."""
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise Fault(": ".join([place, *first_fault(error)])) from None


def first_fault(error: ValidationError) -> list[str]:
    """The fault that is reported of several: the keys that lead to it, and the end of the message."""
    # After a key that is itself wrong, pydantic puts `[key]`.
    faults = [([str(key) for key in fault["loc"] if key != "[key]"], _fault(fault, None)) for fault in error.errors(include_url=False)]
    path, text = min(faults, key=lambda fault: (": unknown key" not in fault[1], len(fault[0])))
    return [*path, text]


def wrong(text: str) -> PydanticCustomError:
    """An error with this text at the end of the line, unchanged even if it contains braces."""
    return PydanticCustomError("wrong", "{text}", {"text": text})


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
    """The end of a message, from a pydantic record; for the value of a field, from the field's description."""
    context, given = fault.get("ctx", {}), fault["input"]
    if fault["type"] == "wrong":
        return context["text"]
    if fault["type"] == "expected" and field is None:
        return f"{shown(given)}: expected {context['text']}"
    if fault["type"] == "literal_error" and isinstance(given, str):
        known = re.findall(r"'([^']*)'", context["expected"])
        return f"{given}: unknown{closest(given, known)}"
    return f"{shown(given)}: expected {field.description if field else _EXPECTED.get(fault['type'], fault['msg'])}"


# Types of values.


def value(fits: Callable[[Any], bool], expected: str) -> PlainValidator:
    """A type of single value, kept as written."""

    def check(given: Any) -> Any:
        if not fits(given):
            raise PydanticCustomError("expected", "{text}", {"text": expected})
        return given

    return PlainValidator(check)


def is_number(given: Any) -> bool:
    """Whether it is a finite number, and not a boolean."""
    return isinstance(given, int | float) and not isinstance(given, bool) and math.isfinite(given)


def _is_whole(given: Any) -> bool:
    return isinstance(given, int) and not isinstance(given, bool)


def _is_huge(given: Any) -> bool:
    return isinstance(given, int) and abs(given) >= 10**9


def _is_line(given: Any) -> bool:
    return isinstance(given, str) and 0 < len(given) <= LONGEST_LINE and given.isprintable()


LONGEST_LINE = 600
"""Characters of a text."""
MOST = 1_000_000
"""Largest count: of repeats, of layouts, of cells."""

Number = Annotated[float, value(is_number, "a number")]
Positive = Annotated[float, value(lambda given: is_number(given) and given > 0, "a number above 0")]
NotNegative = Annotated[float, value(lambda given: is_number(given) and given >= 0, "a number of at least 0")]
Whole = Annotated[int, value(lambda given: _is_whole(given) and 0 <= given <= MOST, f"a whole number from 0 to {MOST}")]
Count = Annotated[int, value(lambda given: _is_whole(given) and 1 <= given <= MOST, f"a whole number of at least 1, at most {MOST}")]
Line = Annotated[str, value(_is_line, f"one line of text without control characters, at most {LONGEST_LINE} characters")]
Flag = Annotated[bool, value(lambda given: isinstance(given, bool), "true or false")]
Scalar = Annotated[
    str | float | bool, value(lambda given: isinstance(given, bool) or is_number(given) or _is_line(given), "a word or a number")
]
"""A value of a column: a word, a number, true or false."""
Setting = Annotated[
    str | float | bool | None,
    value(
        lambda given: (
            given is None or _is_line(given) or (isinstance(given, int | float) and not math.isnan(given) and not _is_huge(given))
        ),
        "a word, a number, true or false",
    ),
]
"""A value of a planner's setting, which may be infinite."""

NAME = r"^[a-z][a-z0-9_]*$"


def matching(pattern: str, expected: str) -> PlainValidator:
    """A type of text that matches a regular expression."""
    return value(lambda given: isinstance(given, str) and re.search(pattern, given) is not None and len(given) <= 100, expected)


Name = Annotated[str, matching(NAME, "a name of lower-case letters, digits and _ that begins with a letter")]


def one_or_list(given: Any) -> list:
    """A value, or a list of values, as a list."""
    return given if isinstance(given, list) else [given]


def listed(item: Any, *, least: int = 1, single: bool = False) -> Any:
    """A type of list without duplicates, kept as written; with `single`, also a lone item without a list."""
    adapter = TypeAdapter(list[item], config=ConfigDict(strict=True))

    def check(given: Any) -> Any:
        if not isinstance(given, list) and not single:
            raise PydanticCustomError("expected", "{text}", {"text": "a list"})
        items = adapter.validate_python(one_or_list(given)) if isinstance(given, list) else _one(adapter, given)
        if isinstance(given, list) and len(items) < least:
            raise PydanticCustomError("expected", "{text}", {"text": f"a list of at least {least}"})
        texts = [repr(each) for each in items]
        if repeated := [text for number, text in enumerate(texts) if text in texts[:number]]:
            raise wrong(f"{shown(given)}: {repeated[0]} is listed twice")
        return items if isinstance(given, list) else items[0]

    return Annotated[list[item], PlainValidator(check)]


def _one(adapter: TypeAdapter, given: Any) -> list:
    try:
        return adapter.validate_python([given])
    except ValidationError:
        raise PydanticCustomError("expected", "{text}", {"text": "a value or a list of values"}) from None


Values = listed(Scalar, single=True)
"""A value of a column or a list of them."""


def one_of(key: str, models: dict[str, type[Model]]) -> PlainValidator:
    """A type of mapping in which the value of one key selects the model."""

    def check(given: Any) -> Model:
        if not isinstance(given, dict):
            raise PydanticCustomError("expected", "{text}", {"text": f"a mapping with {key}"})
        if key not in given:
            raise wrong(f"{key}: missing key; one of {', '.join(sorted(models))}")
        kind = given[key]
        if not isinstance(kind, str) or kind not in models:
            raise wrong(f"{key}: {kind if isinstance(kind, str) else shown(kind)}: unknown{closest(kind, models)}")
        return models[kind].model_validate(given)

    return PlainValidator(check)


def mapping_or(mapping: Any, other: Any) -> PlainValidator:
    """A type of value that is either a mapping of one type, or of another type."""
    as_mapping, as_other = TypeAdapter(mapping), TypeAdapter(other)
    return PlainValidator(lambda given: (as_mapping if isinstance(given, dict) else as_other).validate_python(given))


def after(check: Callable[[Any], Any]) -> AfterValidator:
    """A further check of a value that has passed the previous ones."""
    return AfterValidator(check)


# Names defined elsewhere.


class Names(NamedTuple):
    """Marks a field whose text names something: a metric, a column, a method, ...; `named` finds these names, and `checks` looks them
    up.
    """

    what: str


Metric = Annotated[Name, Names("metric")]
Statistic = Annotated[Name, Names("statistic")]
Column = Annotated[Name, Names("column")]
Experiment = Annotated[Name, Names("experiment")]
Workspace = Annotated[Name, Names("workspace")]
Function = Annotated[Name, Names("function")]
Where = Annotated[dict[Column, Values], Names("where")]
Arguments = dict[Name, Any]
"""Keyword-only arguments of a function of a study's module, which `checks` compares with their annotations."""
ARGUMENTS = "the function's keyword-only arguments, by name: values that the paper gives, or that were chosen"


def named(model: Model, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], str, Any]]:
    """Every name in a model that is defined elsewhere: the keys that lead to it, what it names, and the name."""
    for key, field in type(model).model_fields.items():
        if key in model.model_fields_set:
            yield from _named(getattr(model, key), field.metadata, field.annotation, (*path, key))


def _named(given: Any, metadata: Any, annotation: Any, path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], str, Any]]:
    if isinstance(given, Model):
        yield from named(given, path)
        return
    while typing.get_origin(annotation) is Annotated:
        metadata, annotation = [*metadata, *annotation.__metadata__], annotation.__origin__
    marks = [each.what for each in metadata if isinstance(each, Names)]
    for what in marks[:1]:
        yield path, what, given
    if marks:
        return
    parts = typing.get_args(annotation)
    if isinstance(given, list):
        for number, each in enumerate(given):
            yield from _named(each, [], parts[0] if parts else None, (*path, str(number)))
    elif isinstance(given, dict):
        for key, each in given.items():
            yield from _named(each, [], parts[1] if len(parts) > 1 else None, (*path, key))
    elif typing.get_origin(annotation) is list:  # a lone item of `one_or_list`
        yield from _named(given, [], parts[0], path)
