"""Compare the verdicts under each alternative with those under the values in force."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import pandas as pd

    from bezierplan.analysis import sensitivity

    described, files = snakemake.params.described, snakemake.input
    tried = {name: pd.read_csv(file) for name, file in zip(described, files.alternatives, strict=True)}
    table = sensitivity.sensitivity(pd.read_csv(files.claims), tried, described)
    table.to_csv(output[0], index=False, float_format="%.10g", lineterminator="\n")
