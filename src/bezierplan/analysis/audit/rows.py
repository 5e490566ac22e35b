"""Rows of an audit: a number that a paper prints, and a rule that it should obey."""

import operator
from collections.abc import Iterable, Mapping

from bezierplan.analysis.columns import COLUMNS_OF

RELATIONS = {
    "<": operator.lt,
    "<=": operator.le,
    "==": operator.eq,
    ">=": operator.ge,
    ">": operator.gt,
}


def describe_cell(row: Mapping, keys: Iterable[str]) -> str:
    """Describe which cell a row of published numbers is, such as `method=ga, metric=length`."""
    return ", ".join(f"{key}={row[key]}" for key in keys)


def build_audit_row(
    item: str,
    location: str,
    rule: str,
    printed: float,
    limit: float,
    consistent: bool | None,
    arithmetic: str = "",
) -> dict:
    """Build a row of an audit, with all columns but for the study. consistent: None if the rule
    cannot tell.
    """
    values = (item, location, rule, printed, float(limit), consistent, arithmetic)
    return dict(zip(COLUMNS_OF["audit"][1:], values, strict=True))


def merge_rows(rows: Iterable[dict]) -> list[dict]:
    """Merge the rows of each rule that several numbers obey into one, which says how many they are;
    rows of numbers that disobey, or that the rule cannot judge, stay.
    """
    by_rule: dict[str, list[dict]] = {}
    for row in rows:
        by_rule.setdefault(row["rule"], []).append(row)
    merged = []
    for rule, own in by_rule.items():
        obeyed = [row for row in own if row["consistent"] is True]
        # A single row keeps its own place.
        if len(obeyed) < 2:
            merged += own
            continue
        merged += [row for row in own if row["consistent"] is not True]
        items = ", ".join(dict.fromkeys(row["item"] for row in obeyed))
        count, every = len(obeyed), len(own)
        place = f"{count} of {every} numbers"
        merged.append(build_audit_row(items, place, rule, count, every, True))
    return merged


def compare_with_limit(
    item: str, location: str, rule: str, printed: float, relation: str, limit: float
) -> dict:
    """Build the row of a number that should be <, <=, ==, >= or > than its limit."""
    return build_audit_row(
        item, location, rule, printed, limit, bool(RELATIONS[relation](printed, limit))
    )
