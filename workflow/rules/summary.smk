# All studies together.


rule summary:
    input:
        comparisons=all_comparisons,
        claims=all_claims,
    output:
        numbers="results/{scale}/numbers.csv",
        claims="results/{scale}/claims.csv",
        summary=report("results/{scale}/summary.md", category="summary", labels={"item": "summary", "shows": "the outcome of every study"}),
    log:
        "results/{scale}/summary.log",
    params:
        job=summary_job,
        code=source_digest("bezierplan.analysis.summary"),
    script:
        "../scripts/summary.py"
