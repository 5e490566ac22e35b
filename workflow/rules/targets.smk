# Names for what a user may want: the papers, what goes beyond them, a scale, a study, a table or
# figure. `snakemake --list-target-rules` lists them.

or_exit(loading.check_names, STUDIES)


rule all:
    input:
        files_in("full", "paper"),
        "results/full/index.html",


rule smoke:
    input:
        files_in("smoke", "paper"),
        "results/smoke/index.html",


# The page shows them when it is made again: `make beyond` does.
rule beyond:
    input:
        files_in("full", "beyond"),


rule extended:
    input:
        files_in("extended", "paper"),
        files_in("extended", "beyond"),
        "results/extended/index.html",


# Claims under joint readings. `extended` makes them too.
rule readings:
    input:
        of_studies("extended", "claims_by_reading.csv", lambda study: study.readings),


for study in STUDIES:

    rule:
        name:
            study
        input:
            files_in("full", "paper", study),
            of_studies("full", "claims.csv", lambda own: own.key == study and own.claims),

    rule:
        name:
            f"{study}_beyond"
        input:
            files_in("full", "beyond", study),

    for item in [*STUDIES[study].tables, *STUDIES[study].figures]:

        rule:
            name:
                f"{study}_{item}"
            input:
                files_of("full", STUDIES[study], item),


# Our logger, if it is the one in use, tells the nearest name of a mistyped one.
if told_by := sys.modules.get("snakemake_logger_plugin_bezierplan"):
    told_by.KNOWN.update(rule.name for rule in workflow.rules)
