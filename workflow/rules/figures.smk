# Figures: the picture twice, and exactly the data drawn in it.


rule figure:
    input:
        runs=artefact_runs,
        problems=artefact_problems,
        bounds=artefact_bounds,
        maps=figure_maps,
        published=figure_published,
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
        job=figure_job,
        folder=study_folder,
        caption=caption,
        code=figure_code,
    script:
        "../scripts/figure.py"
