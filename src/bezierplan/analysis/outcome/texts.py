"""The answer to a paper, as a person writes it in a study's `verdict.yaml`: a title, a short text,
and the facts under it. A fact is an address in a table of the outcome, the number of rows that it
must find there, and one comparison that must hold in them.
"""

import operator
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, model_validator

from bezierplan.schema import checked
from bezierplan.schema.model import Model, build_error, parse

COMPARISONS = {"equals": operator.eq, "above": operator.gt, "below": operator.lt}
TABLES = ("numbers", "claims", "claim_checks", "claims_by_reading", "methods", "audit", "settings")


class Fact(Model):
    """A comparison that must hold in some rows of a table of the outcome, all of the study."""

    of: Literal[TABLES]
    where: dict[str, Any] = Field({}, description="column: value, or values; left out: all rows")
    each: list[str] = Field([], description="columns that name a row: none may be there twice")
    rows: int = Field(1, description="how many rows there must be; left out: 1")
    take: str = Field(description="the column that is compared")
    equals: Any = Field(None, description="a value, or the name of a column")
    above: Any = Field(None, description="a number, or the name of a column")
    below: Any = Field(None, description="a number, or the name of a column")
    holds: int = Field(None, description="in how many rows it must hold; left out: in all")
    pools: int = Field(
        1,
        description="how many drawn fields a row is the mean of; left out: 1, a row pools nothing",
    )
    percent: bool = Field(False, description="true to show a share in per cent")
    digits: int = Field(2, description="significant digits that are shown; left out: 2")
    turned_by: list[str] = Field(
        [], description="joint readings under which the claim is decided the other way"
    )

    @model_validator(mode="after")
    def _check_comparison(self) -> "Fact":
        """Refuse a fact without exactly one comparison."""
        if sum(getattr(self, name) is not None for name in COMPARISONS) != 1:
            raise build_error(f"expected one of {', '.join(COMPARISONS)}")
        return self


class Text(Model):
    """The answer to a paper: a title, a short text, and the facts under it."""

    title: str = Field(description="at most eight words that answer")
    text: str = Field(
        description="at most 60 words; in braces the value of a fact, or its low, high, holds, rows"
    )
    facts: dict[str, Fact] = Field(description="by name")


def read(file: str | Path) -> Text:
    """Read the answer of a study from its `verdict.yaml`. Raises Fault."""
    return parse(Text, checked.read(Path(file)), str(file))
