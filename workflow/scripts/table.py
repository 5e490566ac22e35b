"""Make a table and its comparison with the published numbers."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis import table_jobs
    from bezierplan.analysis.jobs import PivotJob
    from bezierplan.running import inputs
    from bezierplan.schema import model

    table, comparison = table_jobs.pivot(
        model.job(PivotJob, snakemake.params.job),
        inputs.experiments(snakemake.input),
        next(iter(inputs.part(snakemake.input, "published").values()), None),
    )
    table.to_csv(output.table, lineterminator="\n")
    comparison.to_csv(output.comparison, index=False, float_format="%.10g", lineterminator="\n")
