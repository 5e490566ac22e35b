"""What each job that analyses runs is made from, beside its input files: names and plain values.

A study makes these at every start of the workflow, so this file imports nothing but what models
need.
"""

from typing import NamedTuple

from bezierplan.analysis.table_kinds import Layout


class AuditJob(NamedTuple):
    """A paper's own numbers, checked against each other and against exact bounds."""

    study: str
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
    verdicts: dict[str, str]
    """Study -> the digest of its sentences of what follows, of those that have any."""


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
