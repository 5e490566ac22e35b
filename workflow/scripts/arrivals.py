"""Compute for each problem of an experiment in a moving world what no robot can beat."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import pyarrow.parquet as parquet

    from bezierplan.running import problems, rides, worlds

    file = snakemake.input.problems
    parquet.write_table(rides.bounds_of(problems.read(file), worlds.read(file)), output[0])
