"""Compute the exact shortest path of each problem of an experiment."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import pyarrow.parquet as parquet

    from bezierplan.running import problems

    parquet.write_table(problems.bounds_of(problems.read(snakemake.input[0])), output[0])
