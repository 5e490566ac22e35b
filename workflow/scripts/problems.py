"""Build the problems of an experiment."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.running import problems

    made, workspaces = problems.build_all(snakemake.params.job, Path(snakemake.params.folder))
    problems.write(made, workspaces, output[0])
