"""Judge the claims of a study."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis.claims import job as claims_job

    files = {name: list(snakemake.input[name]) for name in ("problems", "bounds", "published")}
    claims_job.run(snakemake.params.job, list(snakemake.input.runs), files, output.claims, output.checks)
