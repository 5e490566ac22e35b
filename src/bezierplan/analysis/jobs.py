"""What each job that analyses runs is made from, beside its input files: names and plain values.

A study makes these at every start of the workflow, so this file imports nothing but what models
need.
"""

from typing import Annotated, NamedTuple

from pydantic import PlainValidator

from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.material import Shown
from bezierplan.analysis.table_kinds import Layout, Pivot, Table, table_of


class PivotJob(NamedTuple):
    """A table of runs, and its comparison with published numbers."""

    name: str
    """`study/table`."""
    spec: Pivot
    labels: dict[str, str]
    """Name -> how it is printed."""
    variants: dict[str, str]
    """Method -> the method whose published numbers it is compared with."""
    baselines: list[str]
    repeats: int


class ListingJob(NamedTuple):
    """A table without runs."""

    spec: Annotated[Table, PlainValidator(table_of)]
    module: str | None
    """That of the study, whose function makes the table."""
    labels: dict[str, str]


class ClaimsJob(NamedTuple):
    """The claims of a study, judged on the runs of some experiments."""

    study: str
    module: str | None
    """That of the study, with the functions that claims name."""
    claims: list[Claim]
    primary_alone: bool
    """Whether claims are judged in their primary variant only."""
    artefacts: dict[str, list[Shown]]
    """What each table and figure shows of runs."""
    variant_of: dict[str, str]
    """Method -> the method whose published numbers count."""
    paired: dict[str, bool]
    """By experiment, whether runs with equal repeat numbers share a start or a random workspace."""
    paper_repeats: dict[str, int]
    """By experiment, repeats of the paper, used if the printed numbers do not state them."""
    labels: dict[str, str]
    repeats: dict[str, int]
    """By experiment, the repeats that are judged."""


class AuditJob(NamedTuple):
    """A paper's own numbers, checked against each other and against exact bounds."""

    study: str
    module: str | None
    """That of the study, with checks of its own."""
    tables: dict[str, str]
    """Table of published numbers -> the experiment that reproduces it."""
    primary: dict[str, dict]
    """By table, the rows that count as the paper's interpretation: column -> value."""
    layouts: dict[str, Layout]
    """By table."""


class SummaryJob(NamedTuple):
    """The numbers and claims of all studies."""

    tables: list[tuple[str, str]]
    """Study and table of each comparison with published numbers, in order."""
    titles: dict[str, str]
    """Those of the studies."""


class MeasuredJob(NamedTuple):
    """A study whose methods are measured against a baseline."""

    baseline: str
    repeats: dict[str, int]
    """By experiment that is measured."""


class Tried(NamedTuple):
    """An alternative that is tried on claims, as its table describes it."""

    study: str
    assumption: str
    detail: str
    setting: str | None
    default: object
    alternative: object
