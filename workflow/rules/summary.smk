# All studies together: the summary, and the page that shows everything.


rule summary:
    input:
        inputs(targets.summary_inputs),
    output:
        numbers="results/{scale}/numbers.csv",
        claims="results/{scale}/claims.csv",
        summary=report("results/{scale}/summary.md", category="summary", labels={"item": "summary", "shows": "the outcome of every study"}),
    log:
        "results/{scale}/summary.log",
    params:
        **params(targets.summary_params, "job", "code"),
    script:
        "../scripts/summary.py"


rule page:
    input:
        inputs(page.inputs),
    output:
        page=report("results/{scale}/index.html", category="summary", labels={"item": "page", "shows": "everything, on one page"}),
    log:
        "results/{scale}/page.log",
    params:
        **params(page.params, "job", "tried", "look", "code"),
    script:
        "../scripts/page.py"
