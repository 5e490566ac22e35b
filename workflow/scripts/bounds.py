"""Find the exact shortest path of each problem of an experiment."""

from bezierplan import log

with log.job(snakemake.log[0]):
    from bezierplan import problems

    problems.write_bounds(problems.read(snakemake.input[0]), snakemake.output[0])
