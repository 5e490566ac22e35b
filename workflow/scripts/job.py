"""Do the work of a job (`bezierplan.study.jobs`): the script of all rules."""

from bezierplan.running.jobs import log

with log.run_job(snakemake) as output:
    snakemake.params.job.work(snakemake.input, output)
