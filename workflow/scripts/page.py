"""Write the page of a scale."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.figures.page import job

    job.write(snakemake.params.job, Path("results", snakemake.wildcards.scale), list(snakemake.input.summary), output.page)
