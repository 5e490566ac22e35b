"""Settings of a planner, each declared once, as a field of a named tuple:

    class Settings(NamedTuple):
        genes: Annotated[int, Range(0, 60), About("free control points", "song2016, Section III-B")]
        mutation: Annotated[Mutation, About("what mutates", "song2016, Section III-E")]

    @with_settings(Settings)
    def plan(problem, rng, settings): ...

Callers give settings by name, choices as words. `plan` gets the named tuple, in which everything is
a number, so kernels can read it: a choice is an `IntEnum`, whose members are the words. What is
accepted, the text of messages and `help(plan)` follow from the declaration.
"""

import inspect
import math
import sys
import typing
from collections.abc import Callable
from enum import EnumMeta
from functools import cache, wraps
from typing import Any, NamedTuple, TypeVar

ASSUMED = "assumed"
"""The source of a setting that no paper gives."""

UNITS = "units"
"""The unit of lengths in a workspace."""


class Range(NamedTuple):
    """Limits of a setting's value, both inclusive.

    Infinity is a value only where it is given as a limit: few planners end with it.
    """

    low: float = -sys.float_info.max
    high: float = sys.float_info.max

    def __str__(self) -> str:
        if self.high >= sys.float_info.max:
            return f"at least {self.low:g}"
        return f"from {self.low:g} to {self.high:g}"


SHARE, NOT_NEGATIVE = Range(0, 1), Range(0)
"""Of probabilities and other shares, and of lengths, weights and penalties."""


class About(NamedTuple):
    """Meaning of a setting in one line, its place in the paper, and its unit, empty if none."""

    text: str
    source: str = ASSUMED
    unit: str = ""


class Setting(NamedTuple):
    """A declared setting.

    Attributes
    ----------
    kind : type
        `bool`, `int`, `float`, an `IntEnum`, or `str` for the words of a `Literal`.
    words : tuple
        Accepted values of a choice.
    limits : Range
        Accepted values of a number.
    about : About or None
        Meaning, source and unit; None in a planner that does not tell.
    """

    kind: type
    words: tuple
    limits: Range
    about: About | None

    def __str__(self) -> str:
        """Describe the accepted values, for messages and help."""
        if self.words:
            return "one of " + ", ".join(map(str, self.words))
        number = {bool: "true or false", int: "a whole number", float: "a number"}[self.kind]
        return number if self.limits == Range() else f"{number} {self.limits}"

    @property
    def meaning(self) -> str:
        """Return the text, the unit and the source in one line."""
        text, source, unit = self.about or About("", "")
        return text + (f" [{unit}]" if unit else "") + (f" ({source})" if source else "")

    def number(self, value: Any) -> Any:
        """Convert a value for kernels: a choice becomes its number, and a decimal stays one.

        An integer in place of a decimal would compile kernels again.
        """
        if isinstance(self.kind, EnumMeta):
            return int(self.kind[value])
        return float(value) if self.kind is float else value


def read_setting(annotation: Any) -> Setting:
    """Read the setting that an annotation declares.

    Raises TypeError unless it is `bool`, `int`, `float`, a `Literal` or an `IntEnum`, or one of
    these `Annotated` with a `Range` and an `About`.

    >>> read_setting(typing.Annotated[int, Range(1, 9)]).limits
    Range(low=1, high=9)
    """
    notes: tuple = ()
    if typing.get_origin(annotation) is typing.Annotated:
        annotation, *notes = typing.get_args(annotation)
    limits = next((note for note in notes if isinstance(note, Range)), Range())
    about = next((note for note in notes if isinstance(note, About)), None)
    if typing.get_origin(annotation) is typing.Literal:
        return Setting(str, typing.get_args(annotation), limits, about)
    if isinstance(annotation, EnumMeta) and issubclass(annotation, int) and annotation.__members__:
        return Setting(annotation, tuple(annotation.__members__), limits, about)
    if annotation not in (bool, int, float) or any(
        not isinstance(note, Range | About) for note in notes
    ):
        raise TypeError(f"{annotation} declares no setting")
    return Setting(annotation, (), limits, about)


def find_setting_fault(declaration: Setting, value: Any) -> str | None:
    """Say what is expected instead of a setting's value, or return None if the value is valid."""
    if declaration.words:
        return None if value in declaration.words else str(declaration)
    # Python counts `True` as an integer, a file of settings does not.
    accepted = (int, float) if declaration.kind is float else declaration.kind
    if not isinstance(value, accepted) or (
        isinstance(value, bool) and declaration.kind is not bool
    ):
        return str(declaration._replace(limits=Range()))
    if declaration.limits.low <= value <= declaration.limits.high:
        return None
    return (
        str(declaration)
        if abs(value) < math.inf
        else f"a finite {str(declaration).removeprefix('a ')}"
    )


def list_settings(plan: Callable[..., Any]) -> dict[str, Setting]:
    """List the settings of a planner's function `plan`, its keyword-only arguments, by name.

    Raises TypeError or NameError for an annotation that declares none.
    """
    parameters = inspect.signature(plan, eval_str=True).parameters.values()
    return {
        each.name: read_setting(each.annotation)
        for each in parameters
        if each.kind is each.KEYWORD_ONLY
    }


T = TypeVar("T", bound=tuple)


@cache
def _list_declared(settings: type) -> dict[str, Setting]:
    """List the settings that a class of settings declares, by name."""
    return {name: read_setting(annotation) for name, annotation in settings.__annotations__.items()}


def fill_settings(settings: type[T], values: dict[str, Any]) -> T:
    """Fill a class of settings with values by name.

    Raises TypeError for a missing or unknown name.
    """
    declared = _list_declared(settings)
    return settings(
        **{
            name: declared[name].number(value) if name in declared else value
            for name, value in values.items()
        }
    )


def convert_to_cells(settings: T, cell: float) -> T:
    """Return the same settings for kernels that count in cells: units divided by a cell's side."""
    lengths = [
        name
        for name, each in _list_declared(type(settings)).items()
        if each.about and each.about.unit == UNITS
    ]
    return settings._replace(**{name: getattr(settings, name) / cell for name in lengths})


def with_settings(*classes: type) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Have `plan(problem, rng, settings, ...)` called with the settings by name.

    classes: types of its arguments `settings`, in their order.
    """

    def decorate(plan: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(plan)
        def call_by_name(problem: Any, rng: Any, *further: Any, **values: Any) -> Any:
            filled = [
                fill_settings(
                    each, {name: values.pop(name) for name in each._fields if name in values}
                )
                for each in classes
            ]
            # What is left has a name that no class has, which `plan` refuses.
            return plan(problem, rng, *filled, *further, **values)

        # What asks for arguments or help sees the settings by name, too.
        signature = inspect.signature(plan)
        kept = list(signature.parameters.values())
        # The tuples stand behind `problem` and `rng`.
        del kept[2 : 2 + len(classes)]
        keywords = [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=annotation)
            for each in classes
            for name, annotation in each.__annotations__.items()
        ]
        call_by_name.__signature__ = signature.replace(parameters=[*kept, *keywords])
        told = [
            f"{name} : {each}\n    {each.meaning}"
            for part in classes
            for name, each in _list_declared(part).items()
        ]
        call_by_name.__doc__ = "\n".join(
            [inspect.cleandoc(plan.__doc__ or ""), "\nOther Parameters\n----------------", *told]
        )
        return call_by_name

    return decorate
