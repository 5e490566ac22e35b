"""Measure the methods of all studies against the baselines that the studies name."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis import baseline_comparison
    from bezierplan.analysis.jobs import MeasuredJob
    from bezierplan.running import inputs
    from bezierplan.schema import model

    job = model.job(dict[str, MeasuredJob], snakemake.params.job)
    rows = baseline_comparison.of_studies(job, inputs.experiments(snakemake.input))
    rows.to_csv(output[0], index=False, float_format="%.6g", lineterminator="\n")
