"""Judge every stored path of a scale again."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.running import recheck

    # The files of a method together: its repeats have many paths in common.
    by_method = {}
    for problems, runs in snakemake.params.job:
        for file in runs:
            by_method.setdefault((problems, Path(file).parent), []).append(file)
    tasks = [recheck.Task(problems, "", tuple(files)) for (problems, _), files in by_method.items()]
    recheck.write(recheck.verify(tasks, snakemake.threads), output[0])
