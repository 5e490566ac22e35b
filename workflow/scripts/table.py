"""Make a table and its comparison with the published numbers."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis import comparison, results, table_kinds, tables
    from bezierplan.running import inputs

    job = snakemake.params.job
    spec = table_kinds.Pivot.model_validate(job["spec"])
    found = results.read(
        inputs.experiments(snakemake.input)[spec.experiment], job["repeats"], spec.experiment
    )
    published = comparison.read_published(
        next(iter(inputs.part(snakemake.input, "published").values()), None), spec
    )
    compared = comparison.compare(
        found, spec, published, job["variants"], job["baselines"], job["name"]
    )
    tables.pivot(found, spec, job["labels"]).to_csv(output.table, lineterminator="\n")
    compared.to_csv(output.comparison, index=False, float_format="%.10g", lineterminator="\n")
