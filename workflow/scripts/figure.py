"""Draw a figure from its data, which are first written and read back."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.figures import job
    from bezierplan.figures.figure_job import FigureJob
    from bezierplan.running import inputs
    from bezierplan.schema import model

    job.draw(
        model.job(FigureJob, snakemake.params.job),
        inputs.experiments(snakemake.input),
        inputs.part(snakemake.input, "published"),
        Path(snakemake.params.folder),
        output,
    )
