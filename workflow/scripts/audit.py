"""Check a paper's own numbers against each other and against exact bounds."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis import audit
    from bezierplan.running import inputs

    problems, bounds, published = (
        inputs.part(snakemake.input, name) for name in (inputs.PROBLEMS, inputs.BOUNDS, "published")
    )
    table = audit.audited(snakemake.params.job, problems, bounds, published)
    table.to_csv(output[0], index=False, float_format="%.10g", lineterminator="\n")
