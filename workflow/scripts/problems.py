"""Make the problems of an experiment."""

from bezierplan import log

with log.job(snakemake.log[0]):
    from pathlib import Path

    from bezierplan import problems

    made, workspaces = problems.build_all(snakemake.params.job, Path(snakemake.params.folder))
    problems.write(made, workspaces, snakemake.output[0])
