# Claims with their verdicts, the audit of the paper's own numbers, and which verdicts depend on
# which choice.


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
    priority: CLAIMS
    conda:
        "../envs/bezierplan.yaml"
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
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.audit_params, "job", "published", "code"),
    script:
        "../scripts/audit.py"


# One job per alternative: most of its chunks take less time than starting a process.
rule alternative:
    input:
        inputs(targets.alternative_inputs),
    output:
        runs=directory(f"{ALTERNATIVE}/runs"),
        claims=f"{ALTERNATIVE}/claims.csv",
        checks=f"{ALTERNATIVE}/claim_checks.csv",
    log:
        f"{RESULTS}/logs/sensitivity/{{alternative}}.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.alternative_params, "chunks", "job", "published", "code"),
    script:
        "../scripts/alternative.py"


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
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.sensitivity_params, "described", "code"),
    script:
        "../scripts/sensitivity.py"
