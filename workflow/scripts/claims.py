"""Judge the claims of a study."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import importlib
    from pathlib import Path

    from bezierplan.analysis import results
    from bezierplan.analysis.claims.judge import judge

    job, files = snakemake.params.job, snakemake.input
    found = results.read_all(files.runs, job["repeats"], files.problems, files.bounds)
    published = {Path(file).stem: results.published_table(file) for file in files.published}
    functions = vars(importlib.import_module(job["module"])) if job["module"] else {}
    material = {"variant_of": job["variant_of"], "paired": job["paired"], "repeats": job["paper_repeats"], "labels": job["labels"]}
    judged, checks = judge(job["claims"], found, published, job["artefacts"], job["study"], functions, **material)
    judged.to_csv(output.claims, index=False, float_format="%.10g", lineterminator="\n")
    checks.to_csv(output.checks, index=False, float_format="%.10g", lineterminator="\n")
