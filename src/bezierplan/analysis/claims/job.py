"""The job that judges claims: from files of runs, problems, bounds and published numbers to the
tables of claims and of their checks.
"""

import importlib
from collections.abc import Mapping

from bezierplan.analysis import results
from bezierplan.analysis.claims import judge
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.material import Shown
from bezierplan.running.inputs import Files
from bezierplan.schema.model import parsed


def run(
    job: dict,
    files: Mapping[str, Files],
    published_files: Mapping[str, str],
    claims_file: str,
    checks_file: str,
) -> None:
    """Judge the claims of a job (`study.targets.claims_params`) and write both tables as csv.

    files: by experiment. published_files: of published numbers, by table.
    """
    experiments = results.read_all(files, job["repeats"])
    published = {name: results.published_table(file) for name, file in published_files.items()}
    functions = vars(importlib.import_module(job["module"])) if job["module"] else {}
    material = {
        "variant_of": job["variant_of"],
        "paired": job["paired"],
        "repeats": job["paper_repeats"],
        "labels": job["labels"],
    }
    artefacts = {
        name: [Shown.model_validate(part) for part in parts]
        for name, parts in job["artefacts"].items()
    }
    claims = [parsed(Claim, each, "claims") for each in job["claims"]]
    if job["primary_alone"]:
        claims = [claim.in_primary_variant() for claim in claims]
    judged, checks = judge.judge(
        claims, experiments, published, artefacts, job["study"], functions, **material
    )
    for table, file in ((judged, claims_file), (checks, checks_file)):
        table.to_csv(file, index=False, float_format="%.10g", lineterminator="\n")
