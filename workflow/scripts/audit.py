"""Check a paper's own numbers against each other and against exact bounds."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import importlib
    from pathlib import Path

    import pandas as pd

    from bezierplan.analysis import audit, identified
    from bezierplan.running import problems as problem_files

    job, files = snakemake.params.job, snakemake.input
    published = {Path(file).stem: audit.read_published(file) for file in files.published}
    bounds = {name: pd.read_parquet(file).set_index("problem") for name, file in zip(job["experiments"], files.bounds, strict=True)}
    of_tables = {table: bounds[experiment] for table, experiment in job["tables"].items()}
    compared = {table: published[table] for table in of_tables}
    # Numbers to which a workspace was fitted lie above its bound by construction.
    independent = {name: table for name, table in compared.items() if not job["layouts"][name]["fitted"]}
    rows = audit.below_bound(independent, of_tables, job["primary"]) + audit.of_any_paper(compared, job["layouts"])
    problems = {name: problem_files.read(file) for name, file in zip(job["identified"], files.problems, strict=True)}
    for name, layout in job["layouts"].items():
        rows += identified.of_table(name, published[name], layout["identify"], problems.get(job["tables"][name], {}))
    if job["module"]:
        rows += importlib.import_module(job["module"]).audit(published)
    audit.table(job["study"], rows).to_csv(output[0], index=False, float_format="%.10g", lineterminator="\n")
