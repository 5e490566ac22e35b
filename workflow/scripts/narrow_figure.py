"""Draw a figure on a sheet of one text column, from the data of the wide one."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.figures import job
    from bezierplan.figures.figure_job import FigureJob
    from bezierplan.running import inputs
    from bezierplan.schema import model

    job.draw_narrow(
        model.job(FigureJob, snakemake.params.job),
        inputs.part(snakemake.input, inputs.PROBLEMS),
        snakemake.input.data,
        Path(snakemake.params.folder),
        output,
    )
