# Figures: the picture in two formats, and exactly the data drawn in it.


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
        data=f"{RESULTS}/figures/{{figure}}.csv",
    log:
        f"{RESULTS}/logs/figures/{{figure}}.log",
    params:
        **params(targets.figure_params, "job", "folder", "sources", "code"),
        caption=caption,
    script:
        "../scripts/figure.py"
