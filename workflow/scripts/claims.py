"""Judge the claims of a study."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis.claims import job
    from bezierplan.analysis.jobs import ClaimsJob
    from bezierplan.running import inputs
    from bezierplan.schema import model

    job.run(
        model.job(ClaimsJob, snakemake.params.job),
        inputs.experiments(snakemake.input),
        inputs.part(snakemake.input, "published"),
        output.claims,
        output.checks,
    )
