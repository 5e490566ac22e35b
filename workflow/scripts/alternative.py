"""Run what an alternative of an assumption changes, and judge its claims on these runs and the other methods' runs in force."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    import pyarrow.parquet as parquet

    from bezierplan.analysis.claims import job as claims_job
    from bezierplan.running import execution, problems, rows

    files = {name: list(snakemake.input[name]) for name in ("problems", "bounds", "published")}
    runs = list(snakemake.input.runs)
    made = {name: problems.read(file) for name, file in zip(snakemake.params.job["repeats"], files["problems"], strict=True)}
    for chunk, job in snakemake.params.chunks.items():
        file = Path(output.runs) / chunk
        file.parent.mkdir(parents=True, exist_ok=True)
        table, times = execution.run_chunk(made[job["experiment"]], job)
        rows.write(table, str(file))
        parquet.write_table(times, file.with_suffix(".times.parquet"))
        runs.append(str(file))
    claims_job.run(snakemake.params.job, runs, files, output.claims, output.checks)
