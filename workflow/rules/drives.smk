# Experiments in worlds that move: the same files as those of the others, and the trace of every
# drive.


rule worlds:
    input:
        maps,
    output:
        f"{RESULTS}/problems/{{experiment}}.parquet",
    log:
        f"{RESULTS}/logs/problems/{{experiment}}.log",
    wildcard_constraints:
        study=studies_of(MOVING),
    priority: PROBLEMS
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.problems_params, "job", "folder", "maps", "code"),
    script:
        "../scripts/worlds.py"


rule arrivals:
    input:
        problems=f"{RESULTS}/problems/{{experiment}}.parquet",
    output:
        f"{RESULTS}/problems/{{experiment}}.bounds.parquet",
    log:
        f"{RESULTS}/logs/bounds/{{experiment}}.log",
    wildcard_constraints:
        study=studies_of(MOVING),
    priority: of_bounds
    conda:
        "../envs/bezierplan.yaml"
    params:
        **targets.bounds_params("arrivals"),
    script:
        "../scripts/arrivals.py"


rule drives:
    input:
        problems=f"{RESULTS}/problems/{{experiment}}.parquet",
    output:
        runs=f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.parquet",
        times=f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.times.parquet",
        traces=f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.traces.parquet",
    log:
        f"{RESULTS}/logs/runs/{{experiment}}/{{method}}/{{chunk}}.log",
    wildcard_constraints:
        study=studies_of(MOVING),
    priority: of_runs
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.run_params, "job", "code"),
    script:
        "../scripts/drives.py"
