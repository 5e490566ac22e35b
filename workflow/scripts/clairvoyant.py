"""Compute for each problem of an experiment what no robot can beat, and the best that any reached, or could knowing the future."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import pyarrow.parquet as parquet

    from bezierplan.running import problems, rides, worlds

    file = snakemake.input.problems
    arrivals = rides.first_arrivals(snakemake.input.runs, snakemake.params.repeats)
    parquet.write_table(rides.bounds_of(problems.read(file), worlds.read(file), arrivals), output[0])
