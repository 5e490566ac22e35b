"""Measure the methods of all studies against the baselines that the studies name."""

from bezierplan.running import log

with log.job(snakemake) as output:
    import pandas as pd

    from bezierplan.analysis import results, worth

    files, tables = snakemake.input, []
    for study, job in snakemake.params.job.items():
        own = [[file for file in part if file.split("/")[2] == study] for part in (files.runs, files.problems, files.bounds)]
        found = results.read_all(own[0], job["repeats"], own[1], own[2])
        tables.append(worth.measured(found, job["baseline"]).assign(study=study))
    rows = pd.concat(tables) if tables else pd.DataFrame()
    rows.reindex(columns=worth.COLUMNS).to_csv(output[0], index=False, float_format="%.6g", lineterminator="\n")
