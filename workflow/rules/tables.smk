# Tables, laid out like the paper's, and the comparison of each with the published numbers; tables
# without runs have no comparison.


rule table:
    input:
        inputs(targets.table_inputs),
    output:
        table=report(
            f"{RESULTS}/tables/{{table}}.csv",
            category="{study}",
            labels={"item": "{table}", "shows": "our numbers, laid out as in the paper"},
            caption="../report/artefact.rst",
        ),
        comparison=report(
            f"{RESULTS}/tables/{{table}}.comparison.csv",
            category="{study}",
            labels={"item": "{table}", "shows": "published numbers next to ours"},
            caption="../report/artefact.rst",
        ),
    log:
        f"{RESULTS}/logs/tables/{{table}}.log",
    wildcard_constraints:
        study=studies_with(COMPARED),
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.table_params, "job", "published", "code"),
        caption=caption,
    script:
        "../scripts/table.py"


rule listing:
    input:
        inputs(targets.listing_inputs),
    output:
        report(
            f"{RESULTS}/tables/{{listing}}.csv",
            category="{study}",
            labels={
                "item": "{listing}",
                "shows": "what the paper prints, or what follows from it",
            },
            caption="../report/artefact.rst",
        ),
    log:
        f"{RESULTS}/logs/tables/{{listing}}.log",
    wildcard_constraints:
        study=studies_with(LISTED),
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.listing_params, "job", "published", "code"),
        caption=caption,
    script:
        "../scripts/listing.py"


# All tables of a study as LaTeX, with their captions: one quick job, which a new title runs again
# instead of the tables.
rule latex:
    input:
        inputs(targets.latex_inputs),
    output:
        f"{RESULTS}/tables.tex",
    log:
        f"{RESULTS}/logs/latex.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.latex_params, "captions", "code"),
    script:
        "../scripts/latex.py"
