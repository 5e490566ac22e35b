"""The checks of a claim in each of its variants, and the checks of counted work next to seconds."""

import itertools
from typing import Any

from bezierplan.analysis.claims.check import GROUP_KEYS, ClaimCheck
from bezierplan.analysis.claims.claim import Claim
from bezierplan.schema.model import convert_to_list


def list_variants(claim: Claim) -> list[dict[str, Any]]:
    """List every combination of the values of a claim's variants, by column; the first one is
    primary.
    """
    return [
        dict(zip(claim.variants, values)) for values in itertools.product(*claim.variants.values())
    ]


def name_variant(assignment: dict[str, Any]) -> str:
    """Name a variant as in claims.csv; the name seeds its random draws."""
    return ", ".join(
        f"{column}={' '.join(map(str, convert_to_list(value)))}"
        for column, value in assignment.items()
    )


def apply_variant(
    checks: list[ClaimCheck], first: dict[str, Any], assignment: dict[str, Any]
) -> list[ClaimCheck]:
    """Replace the first values by those of an assignment, wherever a check names them.

    Lists are replaced member by member. A column whose first value no check names becomes one more
    condition of `where`, and None there is no condition.
    """
    for column, chosen in assignment.items():
        # Values are exchanged one by one: `Claim` accepts only lists that are equally long.
        pairs = dict(zip(convert_to_list(first[column]), convert_to_list(chosen), strict=True))
        # With None in place of the values, each check that names one is another check.
        if any(_replace_in_check(check, column, dict.fromkeys(pairs)) != check for check in checks):
            checks = [_replace_in_check(check, column, pairs) for check in checks]
        elif chosen is not None:
            checks = [
                check.but(where=check.where | {column: chosen}) if has_runs(check) else check
                for check in checks
            ]
    return checks


def has_runs(check: ClaimCheck) -> bool:
    """Return whether a check selects runs."""
    return "where" in type(check).model_fields


def _replace_in_check(check: ClaimCheck, column: str, pairs: dict) -> ClaimCheck:
    """Replace values in a check, wherever it names the column."""
    # A variant changes a key of the check, its groups along the column, or a condition.
    keys = [column] if column in ("metric", "experiment") else []
    keys = GROUP_KEYS if check.against and column == check.cells else keys
    written = check.model_fields_set.intersection(keys)
    changed = {key: _replace_values(getattr(check, key), pairs) for key in written}
    if has_runs(check) and column in check.where:
        changed["where"] = check.where | {column: _replace_values(check.where[column], pairs)}
    return check.but(**changed)


def _replace_values(values: Any, pairs: dict) -> Any:
    """Replace values, also within lists, by their partners in pairs."""
    return (
        [_replace_values(value, pairs) for value in values]
        if isinstance(values, list)
        else pairs.get(values, values)
    )


def split_work(check: ClaimCheck) -> list[ClaimCheck]:
    """Split a check of seconds that names counted work into a primary check of the work and a
    secondary one of the seconds; any other check stays alone.
    """
    if check.work is None:
        return [check]
    return [check.use_work(), check.but(secondary=True)]
