"""Amounts with their units, and names and values as they are printed."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

Labels = Mapping[str, str]
"""Name -> how it is printed."""

# Units with a plural; others are abbreviations, such as m.
_WORDS = ("unit", "cell", "step", "generation")


def format_amount(number: str, unit: str) -> str:
    """Format a number, as printed, with its unit.

    >>> [format_amount(*each) for each in (("1", "cell"), ("21.83", "cell"), ("0.5", "m"))]
    ['1 cell', '21.83 cells', '0.5 m']
    """
    one = abs(float(number.replace(",", ""))) == 1
    return f"{number} {unit}{'s' if unit in _WORDS and not one else ''}"


def format_number(value: float, digits: int = 3) -> str:
    """Format a number with some significant digits, without an exponent.

    >>> format_number(0.12345), format_number(12345.6, 2)
    ('0.123', '12,000')
    """
    # Rounded first and then written anew: `.2g` alone makes 1.2e+04 of 12345.6.
    return f"{float(f'{value:.{digits}g}'):,.10g}"


def format_count(number: int, noun: str) -> str:
    """Format how many things there are, in words.

    >>> format_count(1, "claim"), format_count(3, "claim")
    ('1 claim', '3 claims')
    """
    return f"{number} {noun}{'s' if number != 1 else ''}"


def format_value(value: Any, column: str, labels: Labels) -> str:
    """Format a value of a column: as its label, or a number after the column's label."""
    if isinstance(value, str):
        return labels.get(value, value)
    name = f"{value:g}"
    return labels.get(name, f"{name_column(column, labels)} = {name}")


def name_column(column: str, labels: Labels) -> str:
    """Name a column or a metric as printed."""
    return labels.get(column, column.replace("_", " "))


def list_in_order(values: pd.Series, where: Mapping[str, Any]) -> list[Any]:
    """List the distinct values of a column: first those that `where` lists, in its order, then the
    others, sorted.
    """
    first = where.get(values.name)
    listed = first if isinstance(first, list) else []
    present = values.dropna().unique().tolist()
    return [value for value in listed if value in present] + sorted(set(present) - set(listed))


def format_heading(name: str) -> str:
    """Format the name of a table or figure: `table3` as Table 3, `figure_gallery` as Figure
    gallery.
    """
    words = re.sub(r"(?<=[a-z])(?=[0-9])", " ", name.replace("_", " "))
    return words[:1].upper() + words[1:]
