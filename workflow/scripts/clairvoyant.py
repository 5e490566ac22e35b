"""Compute for each problem of an experiment what no robot can beat, and the best that any reached,
or could knowing the future.
"""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.running import problems, rides, worlds

    file = snakemake.input.problems
    rides.write_bounds(
        problems.read(file),
        worlds.read(file),
        snakemake.input.runs,
        snakemake.params.repeats,
        output[0],
    )
