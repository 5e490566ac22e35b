"""Write the page of a scale."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.figures.page import job
    from bezierplan.figures.page.page_job import PageJob
    from bezierplan.schema import model

    folder = Path(snakemake.output.page).parent
    verified = snakemake.input.verified[0]
    job.write(
        model.job(PageJob, snakemake.params.job),
        folder,
        list(snakemake.input.summary),
        output.page,
        snakemake.threads,
        verified,
    )
