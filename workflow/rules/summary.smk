# All studies together: the summary, and the page that shows everything.


rule baseline_comparison:
    input:
        inputs(targets.baseline_comparison_inputs),
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
    log:
        "results/{scale}/baseline_comparison.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.baseline_comparison_params, "job", "code"),
    script:
        "../scripts/baseline_comparison.py"


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
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.summary_params, "job", "code"),
    script:
        "../scripts/summary.py"


# Every path that the page shows, judged again from its row, and every bound, computed again, in
# processes that no planner was in.
rule verified:
    input:
        inputs(page.verified_inputs),
    output:
        "results/{scale}/verified.json",
    log:
        "results/{scale}/verified.log",
    conda:
        "../envs/bezierplan.yaml"
    threads: 2
    params:
        **params(partial(page.verified_params, root=PREFIX), "job", "code"),
    script:
        "../scripts/verified.py"


# A page that was cut short is missing.
for scale in () if workflow.output_settings.dryrun else experiments.SCALES:
    made = Path(PREFIX + page.file(scale))
    if made.is_file() and not page.is_whole(made):
        made.unlink()


rule page:
    input:
        inputs(page.inputs),
    output:
        # Not part of the report, which has a page of its own.
        page="results/{scale}/index.html",
    log:
        "results/{scale}/page.log",
    conda:
        "../envs/bezierplan.yaml"
    # The last job of a workflow, so the others leave it the cores.
    threads: 2
    params:
        **params(partial(page.params, root=PREFIX), "job", "tried", "look", "outcome", "code"),
    script:
        "../scripts/page.py"
