"""Models of `claims.yaml` and `assumptions.yaml`: sentences of a paper as checks, and what a paper
leaves open.

A claim is defined next to the code that judges it (`analysis.claims.claim`), and so are the keys of
each kind of check.
"""

import re
from typing import Annotated, Any, Literal

from annotated_types import MinLen
from pydantic import Field, model_validator

from bezierplan.analysis.claims.claim import Claim, ClaimId
from bezierplan.schema.model import (
    MOST_ENTRIES,
    Line,
    Model,
    Name,
    Setting,
    at_most,
    identity,
    listed,
    mapping_or,
    matching,
    wrong,
)
from bezierplan.study.experiments import PART, PART_EXPECTED, ProblemName

MOST_ALTERNATIVES = 100
"""Alternatives of one assumption."""


class ClaimsFile(Model):
    """The file."""

    claims: Annotated[list[Claim], at_most(MOST_ENTRIES)] = Field(
        description="a list of claims", min_length=1
    )


class Assumption(Model):
    """What a paper leaves open, and the default here."""

    id: Annotated[str, matching(r"[OM][1-9][0-9]*[a-z]?", "O or M and a number")] = Field(
        description="O or M and a number, such as O1; O1b for a second setting of the same point"
    )
    detail: Line = Field(description="what the paper leaves open, one line")
    default: Annotated[Any, mapping_or(Annotated[dict[Name, Setting], MinLen(1)], Setting)] = Field(
        description="the value that runs use; or method → value, and then the alternatives are for "
        "these methods alone"
    )
    alternatives: listed(Setting, least=0, most=MOST_ALTERNATIVES) = Field(
        description="a list of the other values that the setting can take; [] for none"
    )
    reason: Line = Field(description="why the default was chosen, one or two lines")
    source: Literal["published", "inferred", "fitted", "assumed"] = Field(
        description="where the default comes from: published, inferred, fitted (chosen because our "
        "numbers then come nearest to printed ones, so that these confirm nothing) or assumed"
    )
    setting: Name = Field(None, description="the planner's setting that it governs")
    problems: listed(ProblemName) = Field(
        [],
        description="the problems on which alone the alternatives of a setting are tried; the "
        "default is the value that is used on them",
    )
    workspace: dict[Name, Name] = Field(
        {},
        description="workspace → its key that it governs, instead of a setting",
        min_length=1,
    )
    along: dict[Name, dict[Name, Setting]] = Field(
        {},
        alias="with",
        description="method → further settings that go along with every alternative",
        min_length=1,
    )
    claims: listed(ClaimId) = Field(
        [],
        description="ids of the claims on which `snakemake alternatives` tries each alternative, "
        "one at a time (`sensitivity.csv`)",
    )

    @model_validator(mode="after")
    def _check_setting(self) -> "Assumption":
        defaults = {
            identity(value)
            for value in (
                self.default.values() if isinstance(self.default, dict) else [self.default]
            )
        }
        for value in self.alternatives:
            if {identity(value)} == defaults:
                raise wrong(f"alternatives: {value}: is the default; expected the other values")
            if self.setting is not None and not re.fullmatch(PART, str(value)):
                raise wrong(
                    f"alternatives: {value!r}: is part of a file's name; expected "
                    f"{PART_EXPECTED}, or a number"
                )
        if self.setting and self.workspace:
            raise wrong("setting: beside workspace; expected one of them")
        if self.setting is None and self.problems:
            raise wrong(
                "problems: without setting; expected the planner's setting that is governed there"
            )
        if self.setting is None and self.model_fields_set & {"along", "claims"}:
            raise wrong(
                "setting: missing key; with and claims need the planner's setting that is governed"
            )
        return self


class AssumptionsFile(Model):
    """The file."""

    assumptions: Annotated[list[Assumption], at_most(MOST_ENTRIES)] = Field(
        description="a list of assumptions", min_length=1
    )
