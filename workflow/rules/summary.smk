# All studies together: the summary, and the page that shows everything.


rule baseline_comparison:
    input:
        unpack(results(of(jobs.build_baseline_comparison))),
    output:
        report(
            "results/{scale}/baseline_comparison.csv",
            category="summary",
            labels={
                "item": "comparison with the baseline",
                "shows": "each method compared with the exact shortest path with rounded corners",
            },
            caption="../report/summary.rst",
        ),
        "results/{scale}/methods.csv",
    log:
        "results/{scale}/baseline_comparison.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.build_baseline_comparison),
    script:
        "../scripts/job.py"


# Beside a generic optimiser, which no paper has.
use rule baseline_comparison as worth with:
    input:
        unpack(results(of(jobs.build_worth))),
    output:
        "results/{scale}/worth.csv",
    log:
        "results/{scale}/worth.log",
    params:
        **params(jobs.build_worth),


rule summary:
    input:
        comparisons=lambda wildcards: compared(wildcards.scale, "comparison"),
        wholes=lambda wildcards: compared(wildcards.scale, "wholes"),
        claims=lambda wildcards: of_studies(wildcards.scale, "claims.csv"),
    output:
        numbers="results/{scale}/numbers.csv",
        claims=report(
            "results/{scale}/claims.csv",
            category="summary",
            labels={"item": "claims", "shows": "every claim with its verdict"},
            caption="../report/summary.rst",
        ),
        wholes="results/{scale}/wholes.csv",
    log:
        "results/{scale}/summary.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.build_summary),
    script:
        "../scripts/job.py"


# A few sentences and a small table for each paper.
rule verdict:
    input:
        summary=[
            f"results/{{scale}}/{name}.csv"
            for name in ("numbers", "claims", "baseline_comparison", "wholes")
        ],
        audit=f"{RESULTS}/audit.csv",
        worth=lambda wildcards: (
            [f"results/{wildcards.scale}/worth.csv"] if wildcards.scale == "extended" else []
        ),
        sources=sources(of(jobs.build_verdict)),
    output:
        report(
            f"{RESULTS}/verdict.md",
            category="{study}",
            labels={"item": "verdict", "shows": "what follows for the paper"},
            caption="../report/summary.rst",
        ),
    log:
        f"{RESULTS}/logs/verdict.log",
    wildcard_constraints:
        study=one_of(FOLLOWING),
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.build_verdict),
    script:
        "../scripts/job.py"


# What was judged again of all that the page shows, and a digest of every file.
rule verified:
    input:
        unpack(listed),
    output:
        # It says which studies the page shows, so it stays if its job is killed.
        update("results/{scale}/verified.json"),
    log:
        "results/{scale}/verified.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params_of(verified),
    script:
        "../scripts/job.py"


rule page:
    input:
        unpack(results(of(page.build_page, root=ROOT))),
        shown=shown,
        summary=lambda wildcards: summed(wildcards.scale),
        # Last, for it is of all these files.
        verified="results/{scale}/verified.json",
    output:
        # Not part of the report, which has a page of its own.
        page="results/{scale}/index.html",
    log:
        "results/{scale}/page.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(page.build_page, root=ROOT),
    script:
        "../scripts/job.py"
