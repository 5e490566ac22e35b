# Figures: the picture in three formats, what its caption says of the runs, and exactly the data
# drawn in it.


rule figure:
    input:
        inputs(targets.figure_inputs),
    output:
        svg=report(
            f"{RESULTS}/figures/{{figure}}.svg",
            category="{study}",
            labels={"item": "{figure}", "shows": "figure"},
            caption="../report/artefact.rst",
        ),
        png=f"{RESULTS}/figures/{{figure}}.png",
        pdf=f"{RESULTS}/figures/{{figure}}.pdf",
        caption=f"{RESULTS}/figures/{{figure}}.txt",
        data=f"{RESULTS}/figures/{{figure}}.csv",
    log:
        f"{RESULTS}/logs/figures/{{figure}}.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.figure_params, "job", "folder", "sources", "code"),
        caption=caption,
    script:
        "../scripts/figure.py"


# The same on a sheet of one text column: `snakemake narrow`.
rule narrow_figure:
    input:
        inputs(targets.narrow_inputs),
    output:
        svg=f"{RESULTS}/figures/{{figure}}.narrow.svg",
        pdf=f"{RESULTS}/figures/{{figure}}.narrow.pdf",
    log:
        f"{RESULTS}/logs/figures/{{figure}}.narrow.log",
    conda:
        "../envs/bezierplan.yaml"
    params:
        **params(targets.figure_params, "job", "folder", "code"),
    script:
        "../scripts/narrow_figure.py"
