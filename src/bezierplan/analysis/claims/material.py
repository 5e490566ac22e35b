"""The data on which a study's claims are judged."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import Field

from bezierplan.analysis.table_kinds import PublishedFile
from bezierplan.schema.model import ExperimentName, Metric, Model, Name, Where

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.analysis.claims.claim import Claim
    from bezierplan.analysis.results import Results


class Display(Model):
    """Runs that a table or a panel of a figure shows, and the published numbers of a table.

    where: column -> value or list of values. reads: the paper's word -> the metric with which a
    number is compared.
    """

    experiment: ExperimentName
    where: Where = Field({})
    published: PublishedFile = None
    reads: dict[Name, Metric] = Field({})


class StudyForClaims(NamedTuple):
    """A study as far as its claims depend on it.

    artefacts: what each table and figure shows of runs. variant_of: method -> the method whose
    published numbers count. paired: by experiment, whether runs with equal repeat numbers share a
    start or a random workspace. repeats: by experiment, those of the paper, used if the printed
    numbers do not state them. labels: name -> how it is printed.
    """

    name: str
    claims: list[Claim]
    artefacts: dict[str, list[Display]]
    variant_of: dict[str, str]
    paired: dict[str, bool]
    repeats: dict[str, int]
    labels: dict[str, str]


class Material(NamedTuple):
    """The data on which a study's claims are judged, everything by name.

    results: of each experiment that was run. published: files of published numbers, named without
    `.csv`. functions: of the study's file in `papers/`.
    """

    study: StudyForClaims
    results: dict[str, Results]
    published: dict[str, pd.DataFrame]
    functions: dict[str, Any]


class Untestable(Exception):
    """Raised for a check that cannot be judged, with the reason."""
