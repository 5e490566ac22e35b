"""Check a paper's own numbers against each other and against exact bounds."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis import audit
    from bezierplan.analysis.jobs import AuditJob
    from bezierplan.running import inputs
    from bezierplan.schema import model

    problems, bounds, published = (
        inputs.part(snakemake.input, name) for name in (inputs.PROBLEMS, inputs.BOUNDS, "published")
    )
    job = model.job(AuditJob, snakemake.params.job)
    table = audit.audited(job, problems, bounds, published)
    table.to_csv(output[0], index=False, float_format="%.10g", lineterminator="\n")
