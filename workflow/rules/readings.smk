# Which reading of what a paper leaves open explains its published numbers? One job per study, which keeps the runs of each reading, so that
# an interrupted search goes on where it was. A search is a hundred steps, each of which follows from the one before and is a batch of runs: the
# threads of the job share it, and the result does not depend on their number.


rule readings_of:
    input:
        inputs(targets.readings_inputs),
    output:
        readings=report(
            f"{RESULTS}/readings.csv",
            category="{study}",
            labels={"item": "readings", "shows": "readings of the paper by what they explain"},
            caption="../report/claims.rst",
        ),
        explained=f"{RESULTS}/explained.csv",
        held_out=f"{RESULTS}/held_out.csv",
        svg=report(
            f"{RESULTS}/readings.svg",
            category="{study}",
            labels={"item": "readings", "shows": "specification curve"},
            caption="../report/claims.rst",
        ),
        png=f"{RESULTS}/readings.png",
    log:
        f"{RESULTS}/logs/readings.log",
    threads: 4
    params:
        **params(targets.readings_params, "job", "folder", "published", "code"),
        kept=f"{RESULTS}/readings",
    script:
        "../scripts/readings.py"
