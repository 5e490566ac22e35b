"""Amounts with their units, and names as they are printed."""

import re
from collections.abc import Mapping
from typing import Any

# Units with a plural; others are abbreviations, such as m.
_WORDS = ("unit", "cell", "step", "generation")


def amount(number: str, unit: str) -> str:
    """A number, as printed, with its unit.

    >>> amount("1", "cell"), amount("21.83", "cell"), amount("0.5", "m")
    ('1 cell', '21.83 cells', '0.5 m')
    """
    one = abs(float(number.replace(",", ""))) == 1
    return f"{number} {unit}{'s' if unit in _WORDS and not one else ''}"


def number(value: float, digits: int = 3) -> str:
    """Return a number to some significant digits, without an exponent.

    >>> number(0.12345), number(12345.6, 2)
    ('0.123', '12,000')
    """
    return f"{float(f'{value:.{digits}g}'):,.10g}"


def count(number: int, noun: str) -> str:
    """Return how many things there are, in words.

    >>> count(1, "claim"), count(3, "claim")
    ('1 claim', '3 claims')
    """
    return f"{number} {noun}{'s' if number != 1 else ''}"


def printed(value: Any, column: str, labels: Mapping[str, str]) -> str:
    """How a value of a column is printed: as its label, or a number after the column's label."""
    if isinstance(value, str):
        return labels.get(value, value)
    name = f"{value:g}"
    return labels.get(name, f"{column_name(column, labels)} = {name}")


def column_name(column: str, labels: Mapping[str, str]) -> str:
    """How a column or a metric is printed."""
    return labels.get(column, column.replace("_", " "))


def heading(name: str) -> str:
    """The name of a table or figure as printed: `table3` as Table 3, `figure_gallery` as Figure
    gallery.
    """
    words = re.sub(r"(?<=[a-z])(?=[0-9])", " ", name.replace("_", " "))
    return words[:1].upper() + words[1:]
