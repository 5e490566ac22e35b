"""Measure the methods of all studies against the baselines that the studies name."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    import pandas as pd

    from bezierplan.analysis import results, worth

    # Folders between the file of a run, or of problems, and that of its study.
    files, tables, levels = snakemake.input, [], {"runs": 3, "problems": 1, "bounds": 1}
    for study, job in snakemake.params.job.items():
        own = [[file for file in files[part] if Path(file).parents[level].name == study] for part, level in levels.items()]
        found = results.read_all(own[0], job["repeats"], own[1], own[2])
        tables.append(worth.measured(found, job["baseline"]).assign(study=study))
    rows = pd.concat(tables) if tables else pd.DataFrame()
    rows.reindex(columns=worth.COLUMNS).to_csv(output[0], index=False, float_format="%.6g", lineterminator="\n")
