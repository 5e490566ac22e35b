"""Write the tables of a study as LaTeX, with their captions."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    import pandas as pd

    from bezierplan.analysis import latex

    captions = snakemake.params.captions
    tables = [
        latex.Captioned(pd.read_csv(file, dtype=str, keep_default_na=False), captions[name], f"tab:{snakemake.wildcards.study}-{name}")
        for name, file in ((Path(file).stem, file) for file in snakemake.input)
    ]
    Path(output[0]).write_text(latex.document(tables), encoding="utf-8")
