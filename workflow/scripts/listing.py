"""Make a table without runs."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import importlib

    from bezierplan.analysis import listing, table_kinds
    from bezierplan.running import inputs

    job = snakemake.params.job
    functions = vars(importlib.import_module(job["module"])) if job["module"] else {}
    spec, published = (
        table_kinds.table_of(job["spec"]),
        inputs.part(snakemake.input, "published"),
    )
    table = listing.table(spec, published, functions, job["labels"])
    table.to_csv(output[0], index=False, float_format="%.10g", lineterminator="\n")
