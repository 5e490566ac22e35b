"""Measure the methods of all studies against the baselines that the studies name."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis import baseline_comparison
    from bezierplan.running import inputs

    rows = baseline_comparison.of_studies(snakemake.params.job, inputs.experiments(snakemake.input))
    rows.to_csv(output[0], index=False, float_format="%.6g", lineterminator="\n")
