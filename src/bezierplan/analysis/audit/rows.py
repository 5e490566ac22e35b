"""Rows of an audit: a number that a paper prints, and a rule that it should obey."""

import operator
from collections.abc import Iterable, Mapping

COLUMNS = ["study", "item", "place", "rule", "printed", "limit", "consistent", "arithmetic"]

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


def together(rows: Iterable[dict]) -> list[dict]:
    """Rows with those of a rule that several numbers obey as one, which says how many they are."""
    by_rule: dict[str, list[dict]] = {}
    for row in rows:
        by_rule.setdefault(row["rule"], []).append(row)
    return [row for rule, own in by_rule.items() for row in _of_rule(rule, own)]


def _of_rule(rule: str, rows: list[dict]) -> list[dict]:
    obeyed = [row for row in rows if row["consistent"] is True]
    if len(obeyed) < 2:
        return rows
    items = ", ".join(dict.fromkeys(row["item"] for row in obeyed))
    count, every = len(obeyed), len(rows)
    row = checked(items, f"{count} of {every} numbers", rule, count, every, True)
    return [*(other for other in rows if other["consistent"] is not True), row]


def compared(
    item: str, location: str, rule: str, printed: float, relation: str, limit: float
) -> dict:
    """The row of a number that should be <, <=, ==, >= or > than its limit."""
    return checked(item, location, rule, printed, limit, bool(RELATIONS[relation](printed, limit)))
