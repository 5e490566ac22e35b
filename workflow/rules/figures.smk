# Figures: the picture in three formats, what its caption says of the runs, and exactly the data
# drawn in it.


rule figure:
    input:
        unpack(results(of(jobs.build_figure))),
        sources=sources(of(jobs.build_figure)),
        alternatives=of_alternatives,
    output:
        svg=report(
            f"{RESULTS}/{{tree}}/{{figure}}.svg",
            category="{study}",
            labels={"item": "{figure}", "shows": "figure"},
            caption="../report/artefact.rst",
        ),
        png=f"{RESULTS}/{{tree}}/{{figure}}.png",
        pdf=f"{RESULTS}/{{tree}}/{{figure}}.pdf",
        caption=f"{RESULTS}/{{tree}}/{{figure}}.txt",
        data=f"{RESULTS}/{{tree}}/{{figure}}.csv",
    log:
        f"{RESULTS}/logs/{{tree}}/{{figure}}.log",
    wildcard_constraints:
        study=studies_with(DRAWN),
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(jobs.build_figure),
        caption=caption,
    script:
        "../scripts/job.py"
