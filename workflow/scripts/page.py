"""Write the page of a scale."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.figures.page import job

    numbers, claims = snakemake.input.summary or (None, None)
    job.write(snakemake.params.job, Path("results", snakemake.wildcards.scale), numbers, claims, output.page)
