"""Search for the interpretation of a paper that explains its published numbers, and draw the
specification curve.
"""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.analysis import interpretations
    from bezierplan.figures import sheet, specification
    from bezierplan.running import inputs

    job, params = snakemake.params.job, snakemake.params
    published = inputs.part(snakemake.input, "published")
    found = interpretations.found_by(
        job, published, Path(params.folder), Path(params.kept), snakemake.threads
    )
    for name, table in found.items():
        table.to_csv(output[name], index=False, float_format="%.10g", lineterminator="\n")
    choices = [choice["id"] for choice in job["screened"]["choices"]]
    sheet.save(specification.draw(found["interpretations"], choices), output.svg, output.png)
