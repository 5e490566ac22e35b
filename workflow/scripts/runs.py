"""Run a method on every condition of an experiment, one block of repeats."""

from bezierplan import log

with log.job(snakemake) as output:
    import pyarrow.parquet as parquet

    from bezierplan import problems, running

    runs, times = running.run_chunk(problems.read(snakemake.input.problems), snakemake.params.job)
    parquet.write_table(runs, output.runs)
    parquet.write_table(times, output.times)
