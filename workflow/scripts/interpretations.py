"""Search for the interpretation of a paper that explains its published numbers, and draw the
specification curve.
"""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.analysis import interpretations
    from bezierplan.analysis.search_job import Search
    from bezierplan.figures import sheet, specification
    from bezierplan.running import inputs
    from bezierplan.schema import model

    params = snakemake.params
    job = model.job(Search, params.job)
    published = inputs.part(snakemake.input, "published")
    found = interpretations.found_by(
        job, published, Path(params.folder), Path(params.kept), snakemake.threads
    )
    for name, table in found.items():
        table.to_csv(output[name], index=False, float_format="%.10g", lineterminator="\n")
    choices = [choice.id for choice in job.choices]
    sheet.save(specification.draw(found["interpretations"], choices), output.svg, output.png)
