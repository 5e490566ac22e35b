# Workspaces, starts and targets: drawn once, shared by all methods of an experiment. Runs do not
# depend on bounds.


rule problems:
    input:
        maps,
    output:
        f"{RESULTS}/problems/{{experiment}}.parquet",
    log:
        f"{RESULTS}/logs/problems/{{experiment}}.log",
    wildcard_constraints:
        study=studies_of(STILL),
    priority: PROBLEMS
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.problems_params, "job", "folder", "maps", "code"),
    script:
        "../scripts/problems.py"


rule bounds:
    input:
        rules.problems.output,
    output:
        f"{RESULTS}/problems/{{experiment}}.bounds.parquet",
    log:
        f"{RESULTS}/logs/bounds/{{experiment}}.log",
    wildcard_constraints:
        study=studies_of(STILL),
    priority: of_bounds
    conda:
        "../envs/bezierplan.yaml"
    params:
        **targets.bounds_params("bounds"),
    script:
        "../scripts/bounds.py"
