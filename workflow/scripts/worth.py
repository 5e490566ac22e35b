"""Measure the methods of all studies against the baselines that the studies name."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis import worth
    from bezierplan.running import inputs

    rows = worth.of_studies(snakemake.params.job, inputs.experiments(snakemake.input))
    rows.to_csv(output[0], index=False, float_format="%.6g", lineterminator="\n")
