"""Write the page of a scale."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.figures.page import job

    folder = Path(snakemake.output.page).parent
    verified = snakemake.input.verified[0]
    job.write(
        snakemake.params.job,
        folder,
        list(snakemake.input.summary),
        output.page,
        snakemake.threads,
        verified,
    )
