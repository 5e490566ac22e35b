"""Fields of the job that makes the page: names, plain values and files, beside the tables of all
studies together.
"""

from typing import Any, NamedTuple

from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.naming import Labels
from bezierplan.analysis.table_kinds import TableEntry
from bezierplan.figures.caption import Caption


class MethodView(NamedTuple):
    """A method of a study, for its list on the page."""

    planner: str
    settings: dict[str, Any]
    about: str
    """The docstring of its planner's file."""


class StudyView(NamedTuple):
    """A study of the page, by names and plain values."""

    title: str
    paper: Any
    """Title, where it appeared, and DOI, as far as known; None for a reader's own study."""
    labels: Labels
    """Name -> printed name."""
    methods: dict[str, MethodView]
    claims: dict[str, Claim]
    """By id."""
    repeats: list[int]
    """The least and the largest number of runs of a method under a condition; empty for a study
    without experiments.
    """
    tables: dict[str, tuple[Caption, TableEntry]]
    """With their entries, which have the published numbers of the table that they extend."""
    figures: dict[str, Caption]
    assumptions: list[dict[str, Any]]
    """Details that the paper leaves open: the keys of their file, with the default in use."""
    files: list[str]
    """Its other tables, as far as there are any: claims, claim_checks, audit."""
    changes: list[str]
    """Settings that are not those of the README's outcome, in words."""
    answer: tuple[str, str] | None = None
    """Title and text of the README's outcome."""


class PageJob(NamedTuple):
    """The page of a scale, by names and plain values."""

    scale: str
    studies: dict[str, StudyView]
    outcome: list[str]
    """Studies whose outcome of many runs the project keeps for the same settings."""
