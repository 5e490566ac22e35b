# Claims with their verdicts, also under readings, and the audit of the paper's own numbers.


rule claims:
    input:
        unpack(results(of(jobs.build_claims))),
        readings=of_readings("claims.csv"),
        checks=of_readings("claim_checks.csv"),
        sources=sources(of(jobs.build_claims)),
    output:
        claims=report(
            f"{RESULTS}/claims.csv",
            category="{study}",
            labels={"item": "claims", "shows": "one row a claim"},
            caption="../report/claims.rst",
        ),
        checks=f"{RESULTS}/claim_checks.csv",
        by_reading=f"{RESULTS}/claims_by_reading.csv",
    log:
        f"{RESULTS}/logs/claims.log",
    benchmark:
        f"{RESULTS}/logs/claims.tsv"
    wildcard_constraints:
        study=one_of(STUDIES),
    priority: 3
    conda:
        "../envs/bezierplan.yaml"
    resources:
        mem_mb=more(2000),
        runtime=more(20),
    params:
        **params(jobs.build_claims),
    script:
        "../scripts/job.py"


# The claims that are judged under a reading, or drawn under each alternative.
use rule claims as claims_of_reading with:
    input:
        unpack(results(of(jobs.build_claims))),
        sources=sources(of(jobs.build_claims)),
    output:
        claims=f"{RESULTS}/claims.csv",
        checks=f"{RESULTS}/claim_checks.csv",
    wildcard_constraints:
        study=f"(?:{one_of(STUDIES)}){BELOW}",


rule audit:
    input:
        unpack(results(of(jobs.build_audit))),
        sources=sources(of(jobs.build_audit)),
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
        **params(jobs.build_audit),
    script:
        "../scripts/job.py"
