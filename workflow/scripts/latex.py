"""Write the tables of a study as LaTeX, with their captions."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.analysis import latex
    from bezierplan.running import inputs

    tables = latex.captioned(
        inputs.part(snakemake.input, "tables"), snakemake.params.captions, snakemake.wildcards.study
    )
    Path(output[0]).write_text(latex.document(tables), encoding="utf-8")
