"""What the job that makes the page is made from, beside the tables of all studies together: names,
plain values, and files.
"""

from typing import Annotated, Any, NamedTuple

from pydantic import PlainValidator

from bezierplan.analysis.claims.check import Check
from bezierplan.analysis.claims.kinds import check_of
from bezierplan.analysis.table_kinds import Table, table_of


class PaperCited(NamedTuple):
    """A paper as it is cited."""

    title: str
    where: str
    """Journal and year, as far as known."""
    doi: str | None


class MethodShown(NamedTuple):
    """A method of a study."""

    planner: str
    settings: dict[str, Any]


class FigureShown(NamedTuple):
    """A figure of the page."""

    title: str
    caption: str


class TableShown(NamedTuple):
    """A table of the page."""

    title: str
    caption: str
    spec: Annotated[Table, PlainValidator(table_of)]


class AssumptionShown(NamedTuple):
    """A detail that a paper leaves open."""

    id: str
    detail: str
    default: Any
    alternatives: list[Any]
    reason: str
    source: str
    setting: str | None
    claims: list[str]


class ExperimentShown(NamedTuple):
    """An experiment whose runs the viewer shows."""

    methods: list[str]
    """Those that are shown."""
    repeats: int
    runs: list[str]
    """Files of chunks."""
    problems: str
    bounds: str
    traces: list[str]
    """Files of the drives, where the world moves."""


class StudyShown(NamedTuple):
    """A study of the page."""

    title: str
    paper: PaperCited | None
    """None for a reader's own study."""
    labels: dict[str, str]
    """Name -> how it is printed."""
    methods: dict[str, MethodShown]
    checks: dict[str, list[Annotated[Check, PlainValidator(check_of)]]]
    """Those of each claim."""
    repeats: dict[str, list[int]]
    """Scale -> the least and the largest number of runs of a method under a condition; empty for a
    study without experiments.
    """
    tables: dict[str, TableShown]
    figures: dict[str, FigureShown]
    assumptions: list[AssumptionShown]
    files: dict[str, str]
    """Its claims, comparisons of claims, audit, alternatives and interpretations, as far as there
    are any.
    """
    latex: str
    """The file of its tables as LaTeX, if there is one."""
    experiments: dict[str, ExperimentShown]


class PageJob(NamedTuple):
    """The page of a scale."""

    scale: str
    studies: dict[str, StudyShown]
    outcome: bool
    """Whether the README's outcome is shown next to that of this scale (`outcome`)."""
