# All studies together: the summary, and the page that shows everything.


rule worth:
    input:
        inputs(targets.worth_inputs),
    output:
        report(
            "results/{scale}/worth.csv",
            category="summary",
            labels={"item": "worth", "shows": "each method beside the exact shortest path with rounded corners"},
            caption="../report/summary.rst",
        ),
    log:
        "results/{scale}/worth.log",
    params:
        **params(targets.worth_params, "job", "code"),
    script:
        "../scripts/worth.py"


rule summary:
    input:
        inputs(targets.summary_inputs),
    output:
        numbers="results/{scale}/numbers.csv",
        claims="results/{scale}/claims.csv",
        summary=report(
            "results/{scale}/summary.md",
            category="summary",
            labels={"item": "summary", "shows": "the outcome of every study"},
            caption="../report/summary.rst",
        ),
    log:
        "results/{scale}/summary.log",
    params:
        **params(targets.summary_params, "job", "code"),
    script:
        "../scripts/summary.py"


# Every path that the page shows, judged again from its row, in processes that no planner was in.
rule verified:
    input:
        inputs(page.verified_inputs),
    output:
        "results/{scale}/verified.json",
    log:
        "results/{scale}/verified.log",
    threads: 2
    params:
        **params(page.verified_params, "job", "code"),
    script:
        "../scripts/verified.py"


rule page:
    input:
        inputs(page.inputs),
    output:
        # Not part of the report, which prints the params of what it shows without escaping the titles in them.
        page="results/{scale}/index.html",
    log:
        "results/{scale}/page.log",
    # The last job of a workflow, so the others leave it the cores.
    threads: 2
    params:
        **params(page.params, "job", "tried", "look", "code"),
    script:
        "../scripts/page.py"
