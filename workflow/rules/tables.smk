# Tables in the paper's form; published.csv holds the printed numbers in the same rows and columns,
# comparison.csv each printed number next to ours, with its position and place.


rule table:
    input:
        unpack(results(of(jobs.build_table_of_runs))),
        sources=sources(of(jobs.build_table_of_runs)),
    output:
        table=report(
            f"{RESULTS}/{{tree}}/{{table}}.csv",
            category="{study}",
            labels={"item": "{table}", "shows": "our numbers, laid out as in the paper"},
            caption="../report/artefact.rst",
        ),
        published=f"{RESULTS}/{{tree}}/{{table}}.published.csv",
        comparison=report(
            f"{RESULTS}/{{tree}}/{{table}}.comparison.csv",
            category="{study}",
            labels={"item": "{table}", "shows": "published numbers next to ours"},
            caption="../report/artefact.rst",
        ),
    log:
        f"{RESULTS}/logs/{{tree}}/{{table}}.log",
    wildcard_constraints:
        study=studies_with(PRINTED),
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.build_table_of_runs),
        caption=caption,
    script:
        "../scripts/job.py"


# Of numbers that no paper prints.
use rule table as unprinted_table with:
    input:
        unpack(results(of(jobs.build_table_of_runs))),
        sources=sources(of(jobs.build_table_of_runs)),
    output:
        table=report(
            f"{RESULTS}/{{tree}}/{{table}}.csv",
            category="{study}",
            labels={"item": "{table}", "shows": "our numbers"},
            caption="../report/artefact.rst",
        ),
    wildcard_constraints:
        study=studies_with(UNPRINTED),


# What a paper prints, and what follows from it.
rule listing:
    input:
        sources=sources(of(jobs.build_table_without_runs)),
    output:
        report(
            f"{RESULTS}/{{tree}}/{{table}}.csv",
            category="{study}",
            labels={"item": "{table}", "shows": "what the paper prints, or what follows from it"},
            caption="../report/artefact.rst",
        ),
    log:
        f"{RESULTS}/logs/{{tree}}/{{table}}.log",
    wildcard_constraints:
        study=studies_with(LISTED),
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.build_table_without_runs),
        caption=caption,
    script:
        "../scripts/job.py"


# A quick job, which a new title runs again instead of the table.
rule latex:
    input:
        table=f"{RESULTS}/{{tree}}/{{table}}.csv",
        beside=lambda wildcards: (
            [f"{RESULTS}/{{tree}}/{{table}}.comparison.csv"]
            if wildcards.table in STUDIES[wildcards.study].find_published_tables()
            else []
        ),
    output:
        f"{RESULTS}/{{tree}}/{{table}}.tex",
    log:
        f"{RESULTS}/logs/{{tree}}/{{table}}.tex.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.build_latex),
    script:
        "../scripts/job.py"
