# Claims with their verdicts, the audit of the paper's own numbers, and which verdicts depend on
# which choice.


rule claims:
    input:
        runs=read(of(jobs.claims), f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.parquet"),
        judgements=read(of(jobs.claims), f"{RESULTS}/runs/{{experiment}}/{{method}}/judgement.json"),
        problems=read(of(jobs.claims), f"{RESULTS}/problems/{{experiment}}.parquet"),
        bounds=read(of(jobs.claims), f"{RESULTS}/problems/{{experiment}}.bounds.parquet"),
        sources=sources(of(jobs.claims)),
    output:
        claims=report(
            f"{RESULTS}/claims.csv",
            category="{study}",
            labels={"item": "claims", "shows": "one row a claim"},
            caption="../report/claims.rst",
        ),
        checks=f"{RESULTS}/claim_checks.csv",
    log:
        f"{RESULTS}/logs/claims.log",
    benchmark:
        f"{RESULTS}/logs/claims.tsv"
    priority: 3
    conda:
        "../envs/bezierplan.yaml"
    resources:
        mem_mb=more(2000),
        runtime=more(20),
    params:
        **params(jobs.claims),
    script:
        "../scripts/job.py"


rule audit:
    input:
        problems=read(of(jobs.audit), f"{RESULTS}/problems/{{experiment}}.parquet"),
        bounds=read(of(jobs.audit), f"{RESULTS}/problems/{{experiment}}.bounds.parquet"),
        sources=sources(of(jobs.audit)),
    output:
        report(
            f"{RESULTS}/audit.csv",
            category="{study}",
            labels={"item": "audit", "shows": "the paper's own numbers"},
            caption="../report/claims.rst",
        ),
    log:
        f"{RESULTS}/logs/audit.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.audit),
    script:
        "../scripts/job.py"


# One job per alternative: most of its chunks take less time than starting a process.
rule alternative:
    input:
        runs=read(
            of(jobs.alternative), f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.parquet"
        ),
        judgements=read(
            of(jobs.alternative), f"{RESULTS}/runs/{{experiment}}/{{method}}/judgement.json"
        ),
        problems=read(of(jobs.alternative), f"{RESULTS}/problems/{{experiment}}.parquet"),
        bounds=read(of(jobs.alternative), f"{RESULTS}/problems/{{experiment}}.bounds.parquet"),
        sources=sources(of(jobs.alternative)),
    output:
        runs=directory(f"{RESULTS}/sensitivity/{{alternative}}/runs"),
        claims=f"{RESULTS}/sensitivity/{{alternative}}/claims.csv",
        checks=f"{RESULTS}/sensitivity/{{alternative}}/claim_checks.csv",
    log:
        f"{RESULTS}/logs/sensitivity/{{alternative}}.log",
    conda:
        "../envs/bezierplan.yaml"
    resources:
        mem_mb=more(2000),
        runtime=more(20),
    params:
        **params(jobs.alternative),
    script:
        "../scripts/job.py"


rule sensitivity:
    input:
        claims=f"{RESULTS}/claims.csv",
        alternatives=collect(
            f"{RESULTS}/sensitivity/{{alternative}}/claims.csv",
            alternative=lambda wildcards: alternatives.tried(STUDIES[wildcards.study]),
            allow_missing=True,
        ),
    output:
        report(
            f"{RESULTS}/sensitivity.csv",
            category="{study}",
            labels={"item": "sensitivity", "shows": "which verdicts depend on which choice"},
            caption="../report/claims.rst",
        ),
    log:
        f"{RESULTS}/logs/sensitivity.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.sensitivity),
    script:
        "../scripts/job.py"
