# Names for what a reader may want: everything, a scale, a study, a table or figure. `snakemake --list-target-rules` lists them.


rule all:
    input:
        [files_of_study("full", study) for study in STUDIES],
        files_of_summary("full"),


rule smoke:
    input:
        files_of_smoke(),


rule extended:
    input:
        [files_of_study("extended", study) for study in STUDIES],
        files_of_summary("extended"),


rule alternatives:
    input:
        files_of_sensitivity("full"),


for study in STUDIES:

    rule:
        name:
            study
        input:
            files_of_study("full", study),

    for item in [*STUDIES[study].tables, *STUDIES[study].figures]:

        rule:
            name:
                f"{study}_{item}"
            input:
                files_of("full", study, item),
