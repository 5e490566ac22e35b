"""Draw a figure from its data, which are first written and read back."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.figures import job
    from bezierplan.running import inputs

    files, published = (
        inputs.experiments(snakemake.input),
        inputs.part(snakemake.input, "published"),
    )
    job.draw(snakemake.params.job, files, published, Path(snakemake.params.folder), output)
