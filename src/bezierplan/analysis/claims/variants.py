"""The checks of a claim in each of its variants, and the checks of counted work next to seconds."""

import itertools
from typing import Any

from bezierplan.analysis.claims.kinds import GROUP_KEYS, option
from bezierplan.schema.model import one_or_list


def variants(claim: dict) -> list[dict[str, Any]]:
    """Every combination of the values of a claim's variants, column -> value; the first one is primary."""
    columns = claim.get("variants", {})
    return [dict(zip(columns, values)) for values in itertools.product(*columns.values())]


def in_variant(checks: list[dict], first: dict[str, Any], assignment: dict[str, Any]) -> list[dict]:
    """The checks with the values of an assignment instead of the first ones, wherever a check names those.

    Lists are replaced member by member. A column whose first value no check names becomes one more condition of `where`.
    """
    for column, chosen in assignment.items():
        pairs = dict(zip(one_or_list(first[column]), one_or_list(chosen), strict=True))
        if any(_names(check, column) & set(pairs) for check in checks):
            checks = [_exchanged(check, column, pairs) for check in checks]
        else:
            checks = [check | {"where": check.get("where", {}) | {column: chosen}} for check in checks]
    return checks


def _places(check: dict, column: str) -> list[str]:
    """The keys of a check that hold values of a column."""
    if column in ("metric", "experiment"):
        return [column]
    return list(GROUP_KEYS) if column == option(check, "across") else []


def _names(check: dict, column: str) -> set:
    """The values of a column that a check names."""
    given = [check[key] for key in _places(check, column) if key in check] + [check.get("where", {}).get(column, [])]
    return set(_flat(given))


def _flat(values: Any) -> list:
    return [value for each in values for value in _flat(each)] if isinstance(values, list) else [values]


def _exchanged(check: dict, column: str, pairs: dict) -> dict:
    changed = {key: _replaced(check[key], pairs) for key in _places(check, column) if key in check}
    if column in check.get("where", {}):
        changed["where"] = check["where"] | {column: _replaced(check["where"][column], pairs)}
    return check | changed


def _replaced(values: Any, pairs: dict) -> Any:
    return [_replaced(value, pairs) for value in values] if isinstance(values, list) else pairs.get(values, values)


def with_work(check: dict) -> list[dict]:
    """A check of seconds that names counted work, split into a primary check of the work and a secondary one of the seconds."""
    if "work" not in check:
        return [check]
    seconds = {key: value for key, value in check.items() if key != "work"}
    return [seconds | {"metric": check["work"], "printed_metric": check["metric"]}, seconds | {"secondary": True}]
