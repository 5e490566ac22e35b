"""The data on which a study's claims are judged."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import Field

from bezierplan.analysis.table_kinds import PublishedFile
from bezierplan.schema.model import Experiment, Metric, Model, Name, Where

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.analysis.results import Results


class Display(Model):
    """Runs that a table or a panel of a figure shows, and the published numbers of a table.

    where: column -> value or list of values. reads: the paper's word -> the metric with which a
    number is compared.
    """

    experiment: Experiment
    where: Where = Field({})
    published: PublishedFile = None
    reads: dict[Name, Metric] = Field({})


class Material(NamedTuple):
    """The data on which a study's claims are judged, everything by name.

    results: of each experiment that was run. published: files of published numbers, named without
    `.csv`. artefacts: what each table and figure shows of runs. functions: of the study's file in
    `papers/`. variant_of: method -> the method whose published numbers count.
    paired: for each experiment, whether runs with equal repeat numbers share a start or a random
    workspace. repeats: the paper's number of repeats of each, used if the printed numbers do not
    state it. labels: name -> how it is printed. among: of how many readings this is one.
    """

    results: dict[str, Results]
    published: dict[str, pd.DataFrame]
    artefacts: dict[str, list[Display]]
    functions: dict[str, Any]
    variant_of: dict[str, str]
    paired: dict[str, bool]
    repeats: dict[str, int]
    labels: dict[str, str]
    among: int = 1


class Untestable(Exception):
    """Why a check cannot be judged."""
