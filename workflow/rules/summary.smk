# All studies together: the summary, and the page that shows everything.


rule methods:
    input:
        unpack(results(of(jobs.build_methods))),
    output:
        report(
            "results/{scale}/methods.csv",
            category="summary",
            labels={
                "item": "methods",
                "shows": "each method on each problem, beside the exact shortest path",
            },
            caption="../report/summary.rst",
        ),
    log:
        "results/{scale}/methods.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.build_methods),
    script:
        "../scripts/job.py"


rule summary:
    input:
        comparisons=lambda wildcards: compared(wildcards.scale, "comparison"),
        claims=lambda wildcards: of_studies(wildcards.scale, "claims.csv"),
    output:
        numbers="results/{scale}/numbers.csv",
        claims=report(
            "results/{scale}/claims.csv",
            category="summary",
            labels={"item": "claims", "shows": "every claim with its verdict"},
            caption="../report/summary.rst",
        ),
    log:
        "results/{scale}/summary.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.build_summary),
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
