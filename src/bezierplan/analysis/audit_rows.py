"""Rows of an audit: a number that a paper prints, and a rule that it should obey."""

import operator
from collections.abc import Iterable, Mapping

COLUMNS = ["study", "item", "place", "rule", "printed", "limit", "consistent", "arithmetic"]

NOT_KEYS = ("metric", "statistic", "n", "unit", "value", "printed")
"""Columns of a table of published numbers that do not tell its rows apart."""

RELATIONS = {
    "<": operator.lt,
    "<=": operator.le,
    "==": operator.eq,
    ">=": operator.ge,
    ">": operator.gt,
}


def place(row: Mapping, keys: Iterable[str]) -> str:
    """Which cell a row of published numbers is, in words."""
    return ", ".join(f"{key}={row[key]}" for key in keys)


def checked(
    item: str,
    location: str,
    rule: str,
    printed: float,
    limit: float,
    consistent: bool | None,
    arithmetic: str = "",
) -> dict:
    """A row of an audit, with `COLUMNS` but for the study. consistent: None if the rule cannot
    tell.
    """
    values = (item, location, rule, printed, float(limit), consistent, arithmetic)
    return dict(zip(COLUMNS[1:], values, strict=True))


def compared(
    item: str, location: str, rule: str, printed: float, relation: str, limit: float
) -> dict:
    """The row of a number that should be <, <=, ==, >= or > than its limit."""
    return checked(item, location, rule, printed, limit, bool(RELATIONS[relation](printed, limit)))
