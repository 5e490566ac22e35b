"""Compute what a robot could reach that knew the future of its world, for each problem of an experiment."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import pyarrow.parquet as parquet

    from bezierplan.running import problems, rides, worlds

    file = snakemake.input[0]
    parquet.write_table(rides.bounds_of(problems.read(file), worlds.read(file)), output[0])
