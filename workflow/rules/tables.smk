# Tables, laid out like the paper's, and the comparison of each with the published numbers; tables without runs stand alone.


rule table:
    input:
        runs=artefact_runs,
        problems=artefact_problems,
        bounds=artefact_bounds,
        published=table_published,
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
            labels={"item": "{table}", "shows": "published numbers beside ours"},
            caption="../report/artefact.rst",
        ),
    log:
        f"{RESULTS}/logs/tables/{{table}}.log",
    wildcard_constraints:
        study=studies_with(COMPARED),
    params:
        job=table_job,
        caption=caption,
        code=source_digest("bezierplan.analysis.tables", "bezierplan.analysis.comparison"),
    script:
        "../scripts/table.py"


rule listing:
    input:
        published=listing_published,
    output:
        report(
            f"{RESULTS}/tables/{{listing}}.csv",
            category="{study}",
            labels={"item": "{listing}", "shows": "what the paper prints, or what follows from it"},
            caption="../report/artefact.rst",
        ),
    log:
        f"{RESULTS}/logs/tables/{{listing}}.log",
    wildcard_constraints:
        study=studies_with(LISTED),
    params:
        job=listing_job,
        caption=caption,
        code=listing_code,
    script:
        "../scripts/listing.py"
