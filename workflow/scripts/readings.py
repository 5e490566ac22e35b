"""Search for the reading of a paper that explains its published numbers, and draw the specification curve."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    import pandas as pd

    from bezierplan.analysis import explained, readings
    from bezierplan.figures import sheet, specification
    from bezierplan.running import problems

    job, files = snakemake.params.job, snakemake.input
    made = {name: problems.read(file) for name, file in zip(job["experiments"], files.problems, strict=True)}
    bounds = {name: pd.read_parquet(file) for name, file in zip(job["experiments"], files.bounds, strict=True)}
    evaluate = readings.Evaluator(job, made, bounds, dict(zip(job["tables"], files.published)), Path(snakemake.params.kept))
    tried = readings.search(job["choices"], evaluate, job["study"], job["most"])
    found = explained.readings_table(job["study"], tried, job["choices"])
    tables = {output.readings: found, output.explained: explained.explained_table(job["study"], tried)}
    for file, table in (tables | {output.held_out: explained.held_out_table(job["study"], tried)}).items():
        table.to_csv(file, index=False, float_format="%.10g", lineterminator="\n")
    sheet.save(specification.draw(found, [choice["id"] for choice in job["choices"]]), output.svg, output.png)
