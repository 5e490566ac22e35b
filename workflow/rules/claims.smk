# Claims with their verdicts, the paper's own numbers against each other, and which verdicts depend on which choice.


rule claims:
    input:
        inputs(targets.claims_inputs),
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
        **params(targets.claims_params, "job", "published", "code"),
    script:
        "../scripts/claims.py"


rule audit:
    input:
        inputs(targets.audit_inputs),
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
        **params(targets.audit_params, "job", "published", "code"),
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
        **params(targets.run_params, "job", "code"),
    script:
        "../scripts/runs.py"


rule alternative_claims:
    input:
        inputs(targets.claims_inputs),
    output:
        claims=f"{ALTERNATIVE}/claims.csv",
        checks=f"{ALTERNATIVE}/claim_checks.csv",
    log:
        f"{RESULTS}/logs/sensitivity/{{alternative}}/claims.log",
    params:
        **params(targets.claims_params, "job", "published", "code"),
    script:
        "../scripts/claims.py"


rule sensitivity:
    input:
        inputs(targets.sensitivity_inputs),
    output:
        report(
            f"{RESULTS}/sensitivity.csv",
            category="{study}",
            labels={"item": "sensitivity", "shows": "which verdicts depend on which choice"},
            caption="../report/claims.rst",
        ),
    log:
        f"{RESULTS}/logs/sensitivity.log",
    params:
        **params(targets.sensitivity_params, "described", "code"),
    script:
        "../scripts/sensitivity.py"
