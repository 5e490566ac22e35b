"""Build the problems of an experiment."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.running import problems
    from bezierplan.running.descriptions import Descriptions

    described = Descriptions(**snakemake.params.job)
    made = problems.build_all(described, Path(snakemake.params.folder))
    problems.write(made, described.homes, output[0])
