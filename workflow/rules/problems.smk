# Workspaces, starts and targets: drawn once, shared by all methods of an experiment. Runs do not depend on bounds.


rule problems:
    input:
        problem_maps,
    output:
        f"{RESULTS}/problems/{{experiment}}.parquet",
    log:
        f"{RESULTS}/logs/problems/{{experiment}}.log",
    params:
        job=problems_job,
        folder=study_folder,
        code=source_digest("bezierplan.problems"),
    script:
        "../scripts/problems.py"


rule bounds:
    input:
        rules.problems.output,
    output:
        f"{RESULTS}/problems/{{experiment}}.bounds.parquet",
    log:
        f"{RESULTS}/logs/bounds/{{experiment}}.log",
    params:
        code=source_digest("bezierplan.problems"),
    script:
        "../scripts/bounds.py"
