"""Judge the claims of a study."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis.claims import job
    from bezierplan.running import inputs

    files, published = (
        inputs.experiments(snakemake.input),
        inputs.part(snakemake.input, "published"),
    )
    job.run(snakemake.params.job, files, published, output.claims, output.checks)
