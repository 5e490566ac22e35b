# Figures: the picture in three formats, exactly the data drawn in it, notes on the runs, and the
# caption.


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
        notes=f"{RESULTS}/{{tree}}/{{figure}}.notes.txt",
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


rule caption:
    input:
        claims=judged_by(of(captions.build_caption_file)),
    output:
        f"{RESULTS}/{{tree}}/{{figure}}.txt",
    log:
        f"{RESULTS}/logs/{{tree}}/{{figure}}.txt.log",
    wildcard_constraints:
        study=studies_with(DRAWN),
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(captions.build_caption_file),
    script:
        "../scripts/job.py"
