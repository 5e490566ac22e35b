"""Gather the numbers and claims of all studies."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    import pandas as pd

    from bezierplan.analysis import summary

    job, files = snakemake.params.job, snakemake.input
    comparisons = {tuple(name): pd.read_csv(file) for name, file in zip(job["tables"], files.comparisons, strict=True)}
    numbers = summary.numbers(comparisons)
    claims = summary.read_claims(files.claims)
    numbers.to_csv(output.numbers, index=False, float_format="%.10g", lineterminator="\n")
    claims.to_csv(output.claims, index=False, float_format="%.10g", lineterminator="\n")
    report = summary.report(numbers, claims, pd.read_csv(files.worth), job["titles"], snakemake.wildcards.scale)
    Path(output.summary).write_text(report, encoding="utf-8")
