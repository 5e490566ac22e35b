# Figures: the picture in three formats, what its caption says of the runs, and exactly the data
# drawn in it.


rule figure:
    input:
        runs=read(of(jobs.figure), f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.parquet"),
        judgements=read(of(jobs.figure), f"{RESULTS}/runs/{{experiment}}/{{method}}/judgement.json"),
        problems=read(of(jobs.figure), f"{RESULTS}/problems/{{experiment}}.parquet"),
        bounds=read(of(jobs.figure), f"{RESULTS}/problems/{{experiment}}.bounds.parquet"),
        sources=sources(of(jobs.figure)),
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
    resources:
        mem_mb=more(1500),
        runtime=more(5),
    params:
        **params(jobs.figure),
        caption=caption,
    script:
        "../scripts/job.py"
