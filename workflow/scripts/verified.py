"""Judge every stored path of a scale again, and compute every bound again."""

from bezierplan.running import log

with log.job(snakemake) as output:
    from bezierplan.running import recheck

    tasks = []
    for problems, bounds, runs in snakemake.params.job:
        tasks += [
            recheck.Task(problems, "", tuple(runs)),
            recheck.Task(problems, bounds, ()),
        ]
    recheck.write(recheck.verify(tasks, snakemake.threads), output[0])
