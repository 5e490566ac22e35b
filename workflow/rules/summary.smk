# All studies together.


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
