# The configuration, checked, and the functions that rules take their input and params from.
import os
import sys
from pathlib import Path

# The package of this tree, whichever other is installed: for this process and for the scripts of jobs. Kernels use one thread; Snakemake
# does the parallel part.
SOURCE = str(Path(str(workflow.current_basedir)).parents[1] / "src")
sys.path.insert(0, SOURCE)
os.environ.update(PYTHONPATH=SOURCE, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1")

from bezierplan import checked, study as studies, study_file
from bezierplan.digest import source_digest

try:
    STUDIES = study_file.load(study_file.read_config(config))
except checked.Fault as fault:
    sys.exit(str(fault))

RESULTS = "results/{scale}/{study}"


wildcard_constraints:
    scale="|".join(studies.SCALES),
    study="|".join(STUDIES),
    experiment="|".join(sorted({name for study in STUDIES.values() for name in study.experiments})),
    method="|".join(sorted({name for study in STUDIES.values() for name in study.methods})),
    chunk="[0-9]+",
    table="|".join(sorted({name for study in STUDIES.values() for name in study.tables})) or "(?!)",
    figure="|".join(sorted({name for study in STUDIES.values() for name in study.figures})) or "(?!)",


def artefact(wildcards):
    """Name of the table or figure that a file belongs to."""
    return wildcards.get("table") or wildcards.figure


def problem_maps(wildcards):
    study = STUDIES[wildcards.study]
    return study.maps(studies.problems_job(study, wildcards.experiment)["workspaces"])


def problems_job(wildcards):
    return studies.problems_job(STUDIES[wildcards.study], wildcards.experiment)


def study_folder(wildcards):
    return studies.relative(STUDIES[wildcards.study].folder)


def run_job(wildcards):
    return studies.job(STUDIES[wildcards.study], wildcards.experiment, wildcards.method, wildcards.scale, int(wildcards.chunk))


def run_code(wildcards):
    planner = STUDIES[wildcards.study].planner(wildcards.method)
    return source_digest("bezierplan.running", planner if planner.endswith(".py") else f"bezierplan.planners.{planner}")


def chunk_files(wildcards, experiment, methods):
    """Runs of methods of an experiment: as the configuration says, whatever else lies in the folder."""
    runs = f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.parquet"
    chunks = studies.chunks(STUDIES[wildcards.study], experiment, wildcards.scale)
    return expand(runs, scale=wildcards.scale, study=wildcards.study, experiment=experiment, method=methods, chunk=chunks)


def artefact_runs(wildcards):
    study, name = STUDIES[wildcards.study], artefact(wildcards)
    needed = {experiment: studies.methods_of(study, name, experiment) for experiment in studies.experiments_of(study, name)}
    return [file for experiment, methods in needed.items() for file in chunk_files(wildcards, experiment, methods)]


def artefact_problems(wildcards):
    experiments = studies.experiments_of(STUDIES[wildcards.study], artefact(wildcards))
    return expand(f"{RESULTS}/problems/{{experiment}}.parquet", **wildcards, experiment=experiments)


def artefact_bounds(wildcards):
    experiments = studies.experiments_of(STUDIES[wildcards.study], artefact(wildcards))
    return expand(f"{RESULTS}/problems/{{experiment}}.bounds.parquet", **wildcards, experiment=experiments)


def table_published(wildcards):
    return STUDIES[wildcards.study].published_file(wildcards.table) or []


def table_job(wildcards):
    return studies.table_job(STUDIES[wildcards.study], wildcards.table, wildcards.scale)


def figure_maps(wildcards):
    return STUDIES[wildcards.study].maps(figure_job(wildcards)["workspaces"])


def figure_job(wildcards):
    return studies.figure_job(STUDIES[wildcards.study], wildcards.figure, wildcards.scale)


def figure_code(wildcards):
    kinds = {panel["kind"] for panel in figure_job(wildcards)["spec"]["panels"]}
    return source_digest("bezierplan.sheet", *(f"bezierplan.figures.{kind}" for kind in sorted(kinds)))


def caption(wildcards):
    return studies.caption(STUDIES[wildcards.study], artefact(wildcards), wildcards.scale)


def files_of(scale, study, name):
    """The files of a table or figure."""
    if name in STUDIES[study].tables:
        return [f"results/{scale}/{study}/tables/{name}{ending}" for ending in (".csv", ".comparison.csv")]
    return [f"results/{scale}/{study}/figures/{name}{ending}" for ending in (".svg", ".png", ".csv")]


def files_of_study(scale, study):
    return [file for name in [*STUDIES[study].tables, *STUDIES[study].figures] for file in files_of(scale, study, name)]


def files_of_smoke():
    artefacts, methods = studies.smoke(STUDIES)
    runs = [f"results/smoke/{study}/runs/{experiment}/{method}/0.parquet" for study, experiment, method in methods]
    return [file for study, name in artefacts for file in files_of("smoke", study, name)] + runs
