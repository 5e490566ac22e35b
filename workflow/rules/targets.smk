# Names for what a user may want: everything, a scale, a study, a table or figure. `snakemake
# --list-target-rules` lists them. What takes time to find is a function, which only a start for
# that target calls.

try:
    reading.check_names(
        STUDIES,
        [
            *(rule.name for rule in workflow.rules),
            "all",
            "smoke",
            "extended",
            "alternatives",
            "published",
            "narrow",
            "default",
        ],
    )
except checked.Fault as fault:
    sys.exit(str(fault))


rule all:
    input:
        targets.files_of_scale(STUDIES, "full"),
        page.file("full"),


rule smoke:
    input:
        lambda wildcards: targets.files_of_smoke(STUDIES),
        page.file("smoke"),


rule extended:
    input:
        targets.files_of_scale(STUDIES, "extended"),
        page.file("extended"),


rule narrow:
    input:
        targets.files_of_narrow(STUDIES, "full"),


rule alternatives:
    input:
        targets.files_of_sensitivity(STUDIES, "full"),


# What `make verify-outcome` compares with docs/outcome.
rule published:
    input:
        lambda wildcards: [
            file
            for study, table in targets.published_tables(STUDIES)
            for file in targets.files_of(STUDIES, "full", study, table)
        ],


for study in STUDIES:

    rule:
        name:
            study
        input:
            targets.files_of_study(STUDIES, "full", study),

    for item in [*STUDIES[study].tables, *STUDIES[study].figures]:

        rule:
            name:
                f"{study}_{item}"
            input:
                targets.files_of(STUDIES, "full", study, item),


# Our logger, if it is the one in use, tells the nearest name of a mistyped one.
if told_by := sys.modules.get("snakemake_logger_plugin_bezierplan"):
    told_by.KNOWN.update(rule.name for rule in workflow.rules)
