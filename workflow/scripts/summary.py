"""Gather the numbers and claims of all studies."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.analysis import summary
    from bezierplan.analysis.jobs import SummaryJob
    from bezierplan.running import inputs
    from bezierplan.schema import model

    comparisons, claims = (inputs.part(snakemake.input, name) for name in ("comparisons", "claims"))
    scale = snakemake.wildcards.scale
    found = summary.gathered(
        model.job(SummaryJob, snakemake.params.job),
        comparisons,
        list(claims.values()),
        snakemake.input.baseline_comparison,
        scale,
    )
    found.numbers.to_csv(output.numbers, index=False, float_format="%.10g", lineterminator="\n")
    found.claims.to_csv(output.claims, index=False, float_format="%.10g", lineterminator="\n")
    Path(output.summary).write_text(found.report, encoding="utf-8")
