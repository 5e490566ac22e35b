# The only expensive rule: a method on every condition of an experiment, one block of repeats.


rule runs:
    input:
        problems=f"{RESULTS}/problems/{{experiment}}.parquet",
    output:
        runs=f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.parquet",
        times=f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.times.parquet",
    log:
        f"{RESULTS}/logs/runs/{{experiment}}/{{method}}/{{chunk}}.log",
    wildcard_constraints:
        study=studies_of(STILL),
    priority: of_runs
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.run_params, "job", "code"),
    script:
        "../scripts/runs.py"
