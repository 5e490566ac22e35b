"""Draw a figure on a sheet of one text column, from the data of the wide one."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.figures import job
    from bezierplan.running import inputs

    problems = inputs.part(snakemake.input, inputs.PROBLEMS)
    job.draw_narrow(
        snakemake.params.job, problems, snakemake.input.data, Path(snakemake.params.folder), output
    )
