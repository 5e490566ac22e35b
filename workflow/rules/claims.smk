# Claims with their verdicts, the audit of the paper's own numbers, and which verdicts depend on
# which reading.


rule claims:
    input:
        unpack(results(of(jobs.claims))),
        readings=lambda wildcards: of_readings(
            wildcards.scale, {wildcards.study}, "readings", "claims_by_reading"
        ),
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
        unpack(results(of(jobs.audit))),
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


# How well each reading of a paper fits its printed numbers, and what it makes of its claims.
rule readings_of_study:
    input:
        unpack(results(of(jobs.readings))),
        sources=sources(of(jobs.readings)),
    output:
        readings=f"{RESULTS}/readings.csv",
        claims=f"{RESULTS}/claims_by_reading.csv",
        numbers=f"{RESULTS}/numbers_by_reading.csv",
    log:
        f"{RESULTS}/logs/readings.log",
    wildcard_constraints:
        study=one_of(READ),
    conda:
        "../envs/bezierplan.yaml"
    resources:
        mem_mb=more(2000),
        runtime=more(60),
    params:
        **params(jobs.readings),
    script:
        "../scripts/job.py"
