# Claims with their verdicts, the paper's own numbers against each other, and which verdicts hang on which choice.


rule claims:
    input:
        runs=claims_runs,
        problems=claims_problems,
        bounds=claims_bounds,
        published=published_files,
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
    params:
        job=claims_job,
        code=claims_code,
    script:
        "../scripts/claims.py"


rule audit:
    input:
        bounds=audit_bounds,
        published=published_files,
    output:
        report(
            f"{RESULTS}/audit.csv",
            category="{study}",
            labels={"item": "audit", "shows": "the paper's own numbers"},
            caption="../report/claims.rst",
        ),
    log:
        f"{RESULTS}/logs/audit.log",
    params:
        job=audit_job,
        code=audit_code,
    script:
        "../scripts/audit.py"


rule alternative_runs:
    input:
        problems=f"{RESULTS}/problems/{{experiment}}.parquet",
    output:
        runs=f"{ALTERNATIVE}/runs/{{experiment}}/{{method}}/{{chunk}}.parquet",
        times=f"{ALTERNATIVE}/runs/{{experiment}}/{{method}}/{{chunk}}.times.parquet",
    log:
        f"{RESULTS}/logs/sensitivity/{{alternative}}/{{experiment}}/{{method}}/{{chunk}}.log",
    params:
        job=alternative_job,
        code=run_code,
    script:
        "../scripts/runs.py"


rule alternative_claims:
    input:
        runs=alternative_runs,
        problems=claims_problems,
        bounds=claims_bounds,
        published=published_files,
    output:
        claims=f"{ALTERNATIVE}/claims.csv",
        checks=f"{ALTERNATIVE}/claim_checks.csv",
    log:
        f"{RESULTS}/logs/sensitivity/{{alternative}}/claims.log",
    params:
        job=claims_job,
        code=claims_code,
    script:
        "../scripts/claims.py"


rule sensitivity:
    input:
        claims=f"{RESULTS}/claims.csv",
        alternatives=alternatives_claims,
    output:
        report(
            f"{RESULTS}/sensitivity.csv",
            category="{study}",
            labels={"item": "sensitivity", "shows": "which verdicts hang on which choice"},
            caption="../report/claims.rst",
        ),
    log:
        f"{RESULTS}/logs/sensitivity.log",
    params:
        described=alternatives_described,
        code=source_digest("bezierplan.analysis.sensitivity"),
    script:
        "../scripts/sensitivity.py"
