"""Compare the verdicts under each alternative with those under the defaults."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import pandas as pd

    from bezierplan.analysis import sensitivity
    from bezierplan.analysis.jobs import Tried
    from bezierplan.running import inputs
    from bezierplan.schema import model

    described = model.job(dict[str, Tried], snakemake.params.described)
    files = inputs.part(snakemake.input, "alternatives")
    tried = {name: pd.read_csv(files[name]) for name in described}
    table = sensitivity.sensitivity(pd.read_csv(snakemake.input.claims), tried, described)
    table.to_csv(output[0], index=False, float_format="%.10g", lineterminator="\n")
