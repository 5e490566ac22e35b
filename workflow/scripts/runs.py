"""Run a method on every condition of an experiment, one block of repeats."""

from bezierplan import log

with log.job(snakemake.log[0]):
    import pyarrow.parquet as parquet

    from bezierplan import problems, running

    runs, times = running.run_chunk(problems.read(snakemake.input.problems), snakemake.params.job)
    parquet.write_table(runs, snakemake.output.runs)
    parquet.write_table(times, snakemake.output.times)
