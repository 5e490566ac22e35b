"""Models of `claims.yaml` and `assumptions.yaml`: sentences of a paper as checks, and what a paper leaves open.

Each kind of check has its own keys, defined next to its code (`analysis.claims.kinds`).
"""

import math
import re
from typing import Annotated, Any, Literal

from annotated_types import MinLen
from pydantic import Field, model_validator

from bezierplan.analysis.claims.kinds import Check, kinds
from bezierplan.schema.model import (
    MOST_ENTRIES,
    Line,
    Model,
    Name,
    Names,
    Setting,
    Values,
    at_most,
    identity,
    line,
    listed,
    mapping_or,
    matching,
    one_of,
    one_or_list,
    shown,
    wrong,
)
from bezierplan.study.experiments import PART, PART_EXPECTED, ProblemName

MOST_CHECKS = 100
"""Checks of one claim."""
MOST_VARIANTS = 100
"""Combinations of the values of a claim's variants, each a row of its own."""
MOST_ALTERNATIVES = 100
"""Alternatives of one assumption."""

ClaimId = Annotated[str, matching(r"C[1-9][0-9]*", "C and a number, such as C1")]


class Claim(Model):
    """A sentence of the paper."""

    id: ClaimId = Field(description="C and a number, such as C1")
    place: Line = Field(description="where the paper says it")
    statement: Annotated[str, line(160)] = Field(description="one plain sentence of at most 160 characters, in words of one's own")
    artefact: listed(Annotated[Name, Names("artefact")], least=2, single=True) = Field(
        [],
        description="the table or figure that shows it, or a list of them; the groups that `rest` and the metric rank range over "
        "are theirs",
    )
    finding: Literal[True] = Field(None, description="true: our own finding, no sentence of the paper; left out otherwise")
    criterion: Literal["ours"] = Field(
        None, description="ours: the paper gives no number, and the threshold or margin that decides is ours; left out otherwise"
    )
    note: Line = Field(None, description="one line that is shown with the reason for the verdict")
    holds: Literal["all", "any", "together"] = Field(
        "all",
        description="`all` comparisons of the primary checks (left out: this), or `any` of them; `together`: all as one "
        "sentence, such as that one is the best, which a single comparison can refute",
    )
    variants: dict[str, listed(Values, least=2)] = Field(
        {},
        description="column → list of values: the claim is judged with the first one, and once more, in a row of its own, with each of the "
        "others in its place",
        min_length=1,
    )
    checks: Annotated[list[Annotated[Check, one_of("test", kinds())]], at_most(MOST_CHECKS)] = Field(
        description="a list of checks, at least one of them primary", min_length=1
    )

    @model_validator(mode="after")
    def _check_decides(self) -> "Claim":
        if not any(check.primary for check in self.checks):
            raise wrong("checks: every check has secondary: true; expected one that decides")
        if math.prod(map(len, self.variants.values())) > MOST_VARIANTS:
            raise wrong(f"variants: expected at most {MOST_VARIANTS} combinations of values")
        for column, values in self.variants.items():
            if len({len(one_or_list(each)) for each in values}) > 1:
                raise wrong(f"variants: {column}: expected values, or lists of them that are equally long")
        return self

    @property
    def artefacts(self) -> list[str]:
        """Tables and figures that show it."""
        return one_or_list(self.artefact)


class ClaimsFile(Model):
    """The file."""

    claims: Annotated[list[Claim], at_most(MOST_ENTRIES)] = Field(description="a list of claims", min_length=1)


class Assumption(Model):
    """What a paper leaves open, and the choice in force here."""

    id: Annotated[str, matching(r"[OM][1-9][0-9]*[a-z]?", "O or M and a number")] = Field(
        description="O or M and a number, such as O1; O1b for a second setting of the same point"
    )
    detail: Line = Field(description="what the paper leaves open, one line")
    default: Annotated[Any, mapping_or(Annotated[dict[Name, Setting], MinLen(1)], Setting)] = Field(
        description="the value in force; or method → value, and then the alternatives are for these methods alone"
    )
    alternatives: listed(Setting, least=0, most=MOST_ALTERNATIVES) = Field(
        description="a list of the other values that the setting can take; [] for none"
    )
    reason: Line = Field(description="why the default was chosen, one or two lines")
    source: Literal["published", "inferred", "assumed"] = Field(description="where the default comes from: published, inferred or assumed")
    setting: Name = Field(None, description="the planner's setting that it governs")
    problems: listed(ProblemName) = Field([], description="the problems on which alone the alternatives of a setting are tried")
    workspace: dict[Name, Name] = Field(
        {},
        description="workspace → its key that it governs, instead of a setting: `snakemake readings` draws the workspace anew",
        min_length=1,
    )
    table: Literal["within"] = Field(
        None,
        description="within: it governs this key of the tables, instead of a setting; the default is then `all`, alternatives are columns",
    )
    along: dict[Name, dict[Name, Setting]] = Field(
        {}, alias="with", description="method → further settings that go along with every alternative", min_length=1
    )
    claims: listed(ClaimId) = Field(
        [], description="ids of the claims on which `snakemake alternatives` tries each alternative, one at a time (`sensitivity.csv`)"
    )

    not_searched: listed(Setting) = Field([], description="alternatives that `snakemake readings` leaves out because they take too long")

    @model_validator(mode="after")
    def _check_setting(self) -> "Assumption":
        if unknown := [each for each in self.not_searched if each not in self.alternatives]:
            raise wrong(f"not_searched: {shown(unknown[0])}: not among the alternatives")
        defaults = {identity(each) for each in (self.default.values() if isinstance(self.default, dict) else [self.default])}
        for each in self.alternatives:
            if {identity(each)} == defaults:
                raise wrong(f"alternatives: {each}: is the default; expected the other values")
            if self.setting is not None and not re.fullmatch(PART, str(each)):
                raise wrong(f"alternatives: {each!r}: is part of a file's name; expected {PART_EXPECTED}, or a number")
        if self.setting and (self.workspace or self.table):
            raise wrong("setting: beside workspace or table; expected one of them")
        if self.table and self.default != "all":
            raise wrong(f"default: {shown(self.default)}: expected all, since table: {self.table} is not in force")
        if self.setting is None and self.problems:
            raise wrong("problems: without setting; expected the planner's setting that is governed there")
        if self.setting is None and self.model_fields_set & {"along", "claims"}:
            raise wrong("setting: missing key; with and claims need the planner's setting that is governed")
        return self


class AssumptionsFile(Model):
    """The file."""

    assumptions: Annotated[list[Assumption], at_most(MOST_ENTRIES)] = Field(description="a list of assumptions", min_length=1)
