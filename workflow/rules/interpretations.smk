# Which interpretation of what a paper leaves open explains its published numbers? One job per
# study, which keeps the runs of each interpretation, so that an interrupted search goes on where it
# was. A search is a hundred steps, each of which follows from the one before and is a batch of
# runs: the threads of the job share it, and the result does not depend on their number.


rule interpretations_of:
    input:
        inputs(targets.interpretations_inputs),
    output:
        interpretations=report(
            f"{RESULTS}/interpretations.csv",
            category="{study}",
            labels={
                "item": "interpretations",
                "shows": "interpretations of the paper by what they explain",
            },
            caption="../report/claims.rst",
        ),
        explained=f"{RESULTS}/explained.csv",
        leave_one_table_out=f"{RESULTS}/leave_one_table_out.csv",
        svg=report(
            f"{RESULTS}/interpretations.svg",
            category="{study}",
            labels={"item": "interpretations", "shows": "specification curve"},
            caption="../report/claims.rst",
        ),
        png=f"{RESULTS}/interpretations.png",
    log:
        f"{RESULTS}/logs/interpretations.log",
    conda:
        "../envs/bezierplan.yaml"
    threads: 4
    params:
        **params(targets.interpretations_params, "job", "folder", "published", "code"),
        kept=f"{RESULTS}/interpretations",
    script:
        "../scripts/interpretations.py"
