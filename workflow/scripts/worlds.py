"""Build the problems of an experiment in worlds that move."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.running import worlds
    from bezierplan.running.descriptions import Descriptions

    described = Descriptions(**snakemake.params.job)
    made, moving = worlds.build_all(described, Path(snakemake.params.folder))
    worlds.write(made, described.homes, moving, output[0])
