"""Models of `claims.yaml` and `assumptions.yaml`: a paper's sentences as checks, and its open
details.

A claim is defined beside the code that judges it (`analysis.claims.claim`), and so are the keys of
each kind of check.
"""

import re
from typing import Literal

from pydantic import Field, model_validator

from bezierplan.analysis.claims.claim import Claim, ClaimId
from bezierplan.schema.model import (
    Line,
    Metric,
    Model,
    Name,
    Setting,
    Where,
    build_error,
    build_list_type,
    build_mapping_type,
    build_name_type,
    build_text_type,
    show_value,
)
from bezierplan.study.experiments import Problems

AssumptionId = build_text_type(r"[OM][1-9][0-9]*[a-z]?", "O or M and a number")


class ClaimsFile(Model):
    """The content of `claims.yaml`."""

    claims: list[Claim] = Field(description="a list of claims", min_length=1)


class AssumptionEntry(Model):
    """A detail that a paper leaves open, with our default and the other possible values."""

    id: AssumptionId = Field(
        description="O or M and a number, such as O1; O1b for a second setting of the same point"
    )
    detail: Line = Field(description="what the paper leaves open, one line")
    default: build_mapping_type(dict[Name, Setting], Setting) = Field(
        None,
        description="the value that runs use; left out for a setting, whose value stands in "
        "`experiments.yaml`",
    )
    alternatives: build_list_type(Setting, least=0) = Field(
        description="a list of the other values that the setting can take; [] for none"
    )
    reason: Line = Field(description="why the default was chosen, one or two lines")
    source: Literal["published", "inferred", "fitted", "assumed"] = Field(
        description="where the default comes from: published, inferred, fitted (chosen because our "
        "numbers then come nearest to printed ones, so that these confirm nothing) or assumed"
    )
    excluded_by: Line = Field(
        None,
        description="the place of the paper, in our words, that excludes the alternatives, which "
        "then are no readings",
    )
    setting: Name = Field(None, description="the planner's setting that it governs")
    methods: build_list_type(build_name_type("method")) = Field(
        [], description="the methods for which alone the alternatives of a setting are"
    )
    problems: Problems = Field(
        [],
        description="the problems on which alone the alternatives of a setting hold; the "
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

    @model_validator(mode="after")
    def _check_setting(self) -> "AssumptionEntry":
        """Refuse a default beside a setting, and neither of the two."""
        if self.setting is None and self.default is None:
            raise build_error(
                "default: missing key; the value that runs use, unless it is a setting's"
            )
        if self.setting is not None and self.default is not None:
            raise build_error(
                f"default: {show_value(self.default)}: expected none beside a setting, whose value "
                "stands in experiments.yaml"
            )
        return self


class ReadingEntry(Model):
    """A joint reading: another program that a careful reader of the paper could have written."""

    name: build_text_type(
        r"[A-Za-z0-9.-]+(,? [A-Za-z0-9.-]+){0,9}",
        "a few words of letters, digits, . and -, with single spaces between them",
    ) = Field(description="words that a reader of the tables understands, such as weak rivals")
    values: dict[AssumptionId, Setting] = Field(
        description="id of an assumption → one of its alternatives; all of them hold at once",
        min_length=1,
    )
    reason: Line = Field(
        description="why a careful reader of the paper could have written this program, one or two "
        "lines; no printed value is a reason"
    )
    claims: build_list_type(ClaimId) = Field(
        [],
        description="the claims that it tests; left out: those with `main`",
    )

    @property
    def folder(self) -> str:
        """Return the name of the folder of the reading's results."""
        return re.sub("[ ,]+", "_", self.name)


class AssumptionsFile(Model):
    """The content of `assumptions.yaml`."""

    assumptions: list[AssumptionEntry] = Field(description="a list of assumptions", min_length=1)
    readings: list[ReadingEntry] = Field(
        [], description="a list of joint readings, under which claims are judged at scale extended"
    )
    fitted: dict[Name, dict[Metric, Where]] = Field(
        {},
        description="table → metric → the printed numbers to which something was fitted, so that "
        "they confirm nothing: column → value or list of values, {} for all",
    )
