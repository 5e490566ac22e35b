"""Build the problems of an experiment in worlds that move."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.running import worlds

    made, workspaces, found = worlds.build_all(snakemake.params.job, Path(snakemake.params.folder))
    worlds.write(made, workspaces, found, output[0])
