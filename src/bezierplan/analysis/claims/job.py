"""The job that judges claims: from files of runs, problems, bounds and published numbers to the tables of claims and of their checks."""

import importlib
from pathlib import Path

from bezierplan.analysis import results
from bezierplan.analysis.claims import judge
from bezierplan.analysis.claims.claim import Claim
from bezierplan.schema.model import parsed


def run(job: dict, runs: list[str], files: dict[str, list[str]], claims_file: str, checks_file: str) -> None:
    """Judge the claims of a job (`study.targets.claims_params`) and write both tables as csv.

    runs: chunk files, in folders named by experiment and method. files: problems and bounds, one file per experiment in the order of the
    job, and published numbers.
    """
    runs_read = results.read_all(runs, job["repeats"], files["problems"], files["bounds"])
    published = {Path(file).stem: results.published_table(file) for file in files["published"]}
    functions = vars(importlib.import_module(job["module"])) if job["module"] else {}
    material = {"variant_of": job["variant_of"], "paired": job["paired"], "repeats": job["paper_repeats"], "labels": job["labels"]}
    claims = [parsed(Claim, each, "claims") for each in job["claims"]]
    if job["primary_alone"]:
        claims = [claim.in_primary_variant() for claim in claims]
    judged, checks = judge.judge(claims, runs_read, published, job["artefacts"], job["study"], functions, **material)
    for table, file in ((judged, claims_file), (checks, checks_file)):
        table.to_csv(file, index=False, float_format="%.10g", lineterminator="\n")
