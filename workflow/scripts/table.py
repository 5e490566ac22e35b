"""Make a table and its comparison with the published numbers."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.analysis import comparison, results, tables

    job, files = snakemake.params.job, snakemake.input
    found = results.read(files.runs, job["repeats"], files.problems[0], files.bounds[0])
    published = comparison.read_published(files.published or None, job["spec"])
    compared = comparison.compare(found, job["spec"], published, job["variants"], job["baselines"], job["name"])
    tables.pivot(found, job["spec"], job["labels"]).to_csv(output.table, lineterminator="\n")
    compared.to_csv(output.comparison, index=False, float_format="%.10g", lineterminator="\n")
