# Workspaces, starts and targets are drawn once, shared by all methods of an experiment; runs do not
# depend on bounds. Runs are the only expensive rule: a method on every condition of an experiment,
# one block of repeats.
#
# Priorities: of the jobs that can start, problems come first, then claims, which take longest of all
# that follows the runs, then runs, bounds, and at last tables and figures, many short jobs, so that
# no core is left without work while another has a long job.


rule problems:
    input:
        sources=sources(of(jobs.build_problems)),
    output:
        f"{RESULTS}/problems/{{experiment}}.parquet",
    log:
        f"{RESULTS}/logs/problems/{{experiment}}.log",
    priority: 4
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.build_problems),
    script:
        "../scripts/job.py"


rule bounds:
    input:
        problems=f"{RESULTS}/problems/{{experiment}}.parquet",
    output:
        f"{RESULTS}/problems/{{experiment}}.bounds.parquet",
    log:
        f"{RESULTS}/logs/bounds/{{experiment}}.log",
    benchmark:
        f"{RESULTS}/logs/bounds/{{experiment}}.tsv"
    priority: 1
    conda:
        "../envs/bezierplan.yaml"
    resources:
        runtime=more(10),
    params:
        **params(jobs.build_bounds),
    script:
        "../scripts/job.py"


rule runs:
    input:
        problems=problems_of,
    output:
        runs=f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.parquet",
        times=f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.times.parquet",
    log:
        f"{RESULTS}/logs/runs/{{experiment}}/{{method}}/{{chunk}}.log",
    benchmark:
        f"{RESULTS}/logs/runs/{{experiment}}/{{method}}/{{chunk}}.tsv"
    wildcard_constraints:
        study=studies_with(STILL),
    priority: 2
    conda:
        "../envs/bezierplan.yaml"
    resources:
        runtime=more(20),
    params:
        **params(jobs.build_runs),
    script:
        "../scripts/job.py"


# Runs in worlds that move are simulated drives, with a trace of each.
use rule runs as drives with:
    output:
        runs=f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.parquet",
        times=f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.times.parquet",
        traces=f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.traces.parquet",
    wildcard_constraints:
        study=studies_with(MOVING),


# Nothing reads runs that were not judged again from their rows, in a process that no planner was in:
# one job for all methods that are shown together.
rule judgement:
    input:
        unpack(results(judgement, "runs", "problems")),
    output:
        f"{RESULTS}/runs/{{experiment}}/{{method}}/judgement.json",
    log:
        f"{RESULTS}/logs/runs/{{experiment}}/{{method}}/judgement.log",
    priority: 3
    conda:
        "../envs/bezierplan.yaml"
    resources:
        runtime=more(10),
    params:
        **params_of(judgement),
    script:
        "../scripts/job.py"
