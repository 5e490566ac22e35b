"""Let a robot drive under every condition of an experiment, one block of repeats."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import pyarrow.parquet as parquet

    from bezierplan.running import problems, rides, rows, worlds
    from bezierplan.running.chunk import Chunk

    file = snakemake.input.problems
    runs, times, traces = rides.run_chunk(
        problems.read(file), worlds.read(file), Chunk(**snakemake.params.job)
    )
    rows.write(runs, output.runs)
    parquet.write_table(times, output.times)
    parquet.write_table(traces, output.traces, compression="zstd")
