"""The model of a sentence of a paper: its checks, each a model of its own kind (`list_kinds`)."""

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from bezierplan.analysis.claims.check import ClaimCheck
from bezierplan.analysis.claims.kinds import list_kinds
from bezierplan.schema.model import (
    Line,
    Model,
    Values,
    build_choice_type,
    build_error,
    build_list_type,
    build_name_type,
    build_text_type,
    convert_to_list,
)

MOST_CHECKS = 100
"""Checks of one claim."""
MOST_VARIANTS = 100
"""Combinations of the values of a claim's variants, each a row of its own."""

ClaimId = build_text_type(r"C[1-9][0-9]*", "C and a number, such as C1")


class Claim(Model):
    """A sentence of the paper, or a finding of ours, with the checks that decide it."""

    id: ClaimId = Field(description="C and a number, such as C1")
    place: Line = Field(description="where the paper says it")
    statement: Line = Field(
        description="one plain sentence of at most 160 characters, in your own words"
    )
    artefact: build_list_type(build_name_type("artefact"), least=2, single=True) = Field(
        [],
        description="the table or figure that shows it, or a list of them; the groups that `rest` "
        "and the metric rank range over are theirs",
    )
    finding: Literal[True] = Field(
        None, description="true: our own finding, no sentence of the paper; left out otherwise"
    )
    main: Literal[True] = Field(
        None,
        description="true: the abstract or the conclusion says it; left out otherwise",
    )
    scale: Literal["extended"] = Field(
        None,
        description="extended: tested at that scale alone, because nothing in the paper needs its "
        "runs; left out for all other claims",
    )
    criterion: Literal["ours"] = Field(
        None,
        description="ours: the paper gives no number, and the threshold or margin that decides is "
        "ours; left out otherwise",
    )
    note: Line = Field(None, description="one line that is shown with the reason for the verdict")
    holds: Literal["all", "any", "together"] = Field(
        "all",
        description="`all` comparisons of the primary checks (left out: this), or `any` of them; "
        "`together`: all as one "
        "sentence, such as that one is the best, which a single comparison can refute",
    )
    variants: dict[str, build_list_type(Values)] = Field(
        {},
        description="column → list of values: the claim is tested with the first one and, in "
        "rows of their own, with each of the others; null is no condition",
        min_length=1,
    )
    variant_names: list[Line] = Field(
        [],
        description="names of the variants, one for each combination of their values, the last "
        "column varying fastest; left out: the values themselves",
    )
    checks: list[Annotated[ClaimCheck, build_choice_type("test", list_kinds())]] = Field(
        description="a list of checks, at least one of them primary",
        min_length=1,
        max_length=MOST_CHECKS,
    )

    @model_validator(mode="after")
    def _check_decides(self) -> "Claim":
        """Refuse a claim that nothing decides, or whose variants are too many or of
        unequal length.
        """
        if not any(check.primary for check in self.checks):
            raise build_error("checks: every check has secondary: true; expected one that decides")
        combinations = math.prod(map(len, self.variants.values()))
        if combinations > MOST_VARIANTS:
            raise build_error(f"variants: expected at most {MOST_VARIANTS} combinations of values")
        if len(self.variant_names) not in (0, combinations):
            raise build_error(f"variant_names: expected {combinations}, one for each combination")
        for column, values in self.variants.items():
            if len({len(convert_to_list(each)) for each in values}) > 1:
                raise build_error(
                    f"variants: {column}: expected values, or lists of them that are equally long"
                )
        return self

    @property
    def artefacts(self) -> list[str]:
        """Return the tables and figures that show it."""
        return convert_to_list(self.artefact)
