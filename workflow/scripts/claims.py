"""Judge the claims of a study."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis import claim_job

    files = {name: list(snakemake.input[name]) for name in ("problems", "bounds", "published")}
    claim_job.judge(snakemake.params.job, list(snakemake.input.runs), files, output.claims, output.checks)
