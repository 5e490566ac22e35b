"""Run a method on every condition of an experiment, one block of repeats."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import pyarrow.parquet as parquet

    from bezierplan.running import execution, problems, rows
    from bezierplan.running.chunk import Chunk

    runs, times = execution.run_chunk(
        problems.read(snakemake.input.problems), Chunk(**snakemake.params.job)
    )
    rows.write(runs, output.runs)
    parquet.write_table(times, output.times)
