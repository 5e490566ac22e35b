"""The job that judges claims: from files of runs, problems, bounds and published numbers to the
tables of claims and of their checks.
"""

import importlib
from collections.abc import Mapping

from bezierplan.analysis import results
from bezierplan.analysis.claims import judge
from bezierplan.analysis.jobs import ClaimsJob
from bezierplan.running.inputs import Files


def run(
    job: ClaimsJob,
    files: Mapping[str, Files],
    published_files: Mapping[str, str],
    claims_file: str,
    checks_file: str,
) -> None:
    """Judge claims and write both tables as csv.

    files: by experiment. published_files: of published numbers, by table.
    """
    judged, checks = judge.judge(
        [claim.in_primary_variant() for claim in job.claims] if job.primary_alone else job.claims,
        results.read_all(files, job.repeats),
        {name: results.published_table(file) for name, file in published_files.items()},
        job.artefacts,
        job.study,
        vars(importlib.import_module(job.module)) if job.module else {},
        variant_of=job.variant_of,
        paired=job.paired,
        repeats=job.paper_repeats,
        labels=job.labels,
    )
    for table, file in ((judged, claims_file), (checks, checks_file)):
        table.to_csv(file, index=False, float_format="%.10g", lineterminator="\n")
