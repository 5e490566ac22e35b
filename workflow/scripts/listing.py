"""Make a table without runs."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis import table_jobs
    from bezierplan.analysis.jobs import ListingJob
    from bezierplan.running import inputs
    from bezierplan.schema import model

    table = table_jobs.listing(
        model.job(ListingJob, snakemake.params.job), inputs.part(snakemake.input, "published")
    )
    table.to_csv(output[0], index=False, float_format="%.10g", lineterminator="\n")
