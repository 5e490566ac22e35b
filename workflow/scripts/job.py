"""Do the work of a job (`bezierplan.study.jobs`): the script of all rules."""

from bezierplan.running.jobs import log

with log.run_job(snakemake) as output:
    snakemake.params.job.run_recorded(snakemake.input, output)
