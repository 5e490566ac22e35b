"""The jobs that make tables: from files of runs, problems, bounds and published numbers to the
tables as printed.
"""

import importlib
from collections.abc import Mapping

import pandas as pd

from bezierplan.analysis import comparison, results, tables
from bezierplan.analysis import listing as listings
from bezierplan.analysis.jobs import ListingJob, PivotJob
from bezierplan.running.inputs import Files


def pivot(
    job: PivotJob, files: Mapping[str, Files], published: str | None
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """A table of runs, and its comparison with published numbers. files: of its experiment, by
    name. published: the file of published numbers.
    """
    experiment = job.spec.experiment
    runs = results.read(files[experiment], job.repeats, experiment)
    compared = comparison.compare(
        runs,
        job.spec,
        comparison.read_published(published, job.spec),
        job.variants,
        job.baselines,
        job.name,
    )
    return tables.pivot(runs, job.spec, job.labels), compared


def listing(job: ListingJob, published: Mapping[str, str]) -> pd.DataFrame:
    """A table without runs. published: files of published numbers or of comparisons, by table."""
    functions = vars(importlib.import_module(job.module)) if job.module else {}
    return listings.table(job.spec, published, functions, job.labels)
