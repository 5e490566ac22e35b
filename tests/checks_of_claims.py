"""Checks of claims, from the plain values of a file."""

from typing import Any

from bezierplan.analysis.claims.check import ClaimCheck
from bezierplan.analysis.claims.kinds import list_kinds


def check_of(values: dict[str, Any]) -> ClaimCheck:
    """The check."""
    return list_kinds()[values["test"]].model_validate(values)
