"""Run what an alternative of an assumption changes, and judge its claims on these runs and the
other methods' runs by default.
"""

from bezierplan.running import log

with log.job(snakemake) as output:
    from pathlib import Path

    from bezierplan.analysis.claims import job
    from bezierplan.analysis.jobs import ClaimsJob
    from bezierplan.running import again, inputs
    from bezierplan.schema import model

    files = again.with_chunks(
        inputs.experiments(snakemake.input), snakemake.params.chunks, Path(output.runs)
    )
    job.run(
        model.job(ClaimsJob, snakemake.params.job),
        files,
        inputs.part(snakemake.input, "published"),
        output.claims,
        output.checks,
    )
