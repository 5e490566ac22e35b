# The configuration, checked, and the functions that rules take their input and params from.
import os
import re
import sys
from pathlib import Path

# The package of this tree, whichever other is installed: for this process and for the scripts of jobs. Kernels use one thread; Snakemake
# does the parallel part.
SOURCE = str(Path(str(workflow.current_basedir)).parents[1] / "src")
sys.path.insert(0, SOURCE)
os.environ.update(PYTHONPATH=SOURCE, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1")

from bezierplan import checked, study as studies
from bezierplan.digest import source_digest
from bezierplan.study import reading

try:
    STUDIES = reading.load(reading.read_config(config))
except checked.Fault as fault:
    sys.exit(str(fault))

RESULTS = "results/{scale}/{study}"
ALTERNATIVE = f"{RESULTS}/sensitivity/{{alternative}}"


wildcard_constraints:
    scale="|".join(studies.SCALES),
    study="|".join(STUDIES),
    experiment="|".join(sorted({name for study in STUDIES.values() for name in study.experiments})),
    method="|".join(sorted({name for study in STUDIES.values() for name in study.methods})),
    chunk="[0-9]+",
    table="|".join(sorted({name for study in STUDIES.values() for name in study.compared()})) or "(?!)",
    listing="|".join(sorted({name for study in STUDIES.values() for name in study.tables.keys() - study.compared().keys()})) or "(?!)",
    figure="|".join(sorted({name for study in STUDIES.values() for name in study.figures})) or "(?!)",
    alternative="|".join(re.escape(name) for study in STUDIES.values() for name in studies.tried(study)) or "(?!)",


def studies_with(tables):
    """Pattern of the names of studies in paths of tables: the same name may be one kind of table here and another there."""
    return "|".join(f"{key}(?=/tables/(?:{'|'.join(names)})[.])" for key, names in tables.items() if names) or "(?!)"


COMPARED = {key: list(study.compared()) for key, study in STUDIES.items()}
LISTED = {key: [name for name in study.tables if name not in COMPARED[key]] for key, study in STUDIES.items()}


def artefact(wildcards):
    """Name of the table or figure that a file belongs to."""
    return wildcards.get("table") or wildcards.get("listing") or wildcards.figure


def problem_maps(wildcards):
    study = STUDIES[wildcards.study]
    return study.maps(studies.problems_job(study, wildcards.experiment, wildcards.scale)["workspaces"])


def problems_job(wildcards):
    return studies.problems_job(STUDIES[wildcards.study], wildcards.experiment, wildcards.scale)


def study_folder(wildcards):
    return studies.relative(STUDIES[wildcards.study].folder)


def run_job(wildcards):
    return studies.job(STUDIES[wildcards.study], wildcards.experiment, wildcards.method, wildcards.scale, int(wildcards.chunk))


def planner_file(planner):
    """A planner as `source_digest` takes it."""
    return planner if planner.endswith(".py") else f"bezierplan.planners.{planner}"


def run_code(wildcards):
    return source_digest("bezierplan.running", planner_file(STUDIES[wildcards.study].planner(wildcards.method)))


def chunk_files(wildcards, experiment, methods, folder=RESULTS):
    """Runs of methods of an experiment: as the configuration says, whatever else lies in the folder."""
    runs = f"{folder}/runs/{{experiment}}/{{method}}/{{chunk}}.parquet"
    chunks = studies.chunks(STUDIES[wildcards.study], experiment, wildcards.scale)
    names = {key: wildcards.get(key) for key in ("scale", "study", "alternative")}
    return expand(runs, **names, experiment=experiment, method=methods, chunk=chunks)


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


def listing_job(wildcards):
    return studies.listing_job(STUDIES[wildcards.study], wildcards.listing)


def listing_published(wildcards):
    """The file that a transcribed table shows, the comparisons that one is of, or all files of published numbers for a function."""
    spec, study = listing_job(wildcards)["spec"], STUDIES[wildcards.study]
    if spec["kind"] == "comparison":
        return [f"results/{wildcards.scale}/{wildcards.study}/tables/{name}.comparison.csv" for name in spec["of"]]
    file = study.published_file(wildcards.listing)
    return [file] if file else published_files(wildcards)


def listing_code(wildcards):
    job = listing_job(wildcards)
    return source_digest("bezierplan.analysis.listing", *([job["module"]] if "function" in job["spec"] else []))


def figure_maps(wildcards):
    return STUDIES[wildcards.study].maps(figure_job(wildcards)["workspaces"])


def figure_job(wildcards):
    return studies.figure_job(STUDIES[wildcards.study], wildcards.figure, wildcards.scale)


def figure_code(wildcards):
    job = figure_job(wildcards)
    panels = job["spec"]["panels"]
    kinds = [f"bezierplan.figures.{kind}" for kind in sorted({panel["kind"] for panel in panels})]
    own = [STUDIES[wildcards.study].module()] if any("data" in panel for panel in panels) else []
    again = {run_job["planner"] for methods in job["jobs"].values() for run_job in methods.values()}
    return source_digest("bezierplan.sheet", *kinds, *own, *map(planner_file, sorted(again)))


def figure_published(wildcards):
    """Published numbers, for the kinds that draw them and the functions that ask for them."""
    drawn = studies.published_drawn(STUDIES[wildcards.study], wildcards.figure)
    return published_files(wildcards) if drawn else []


def caption(wildcards):
    return studies.caption(STUDIES[wildcards.study], artefact(wildcards), wildcards.scale)


def claims_in_force(wildcards):
    """All claims of a study, or under an alternative those on which it is tried."""
    study, alternative = STUDIES[wildcards.study], wildcards.get("alternative")
    return studies.headline_claims(study, alternative) if alternative else study.claims


def claims_job(wildcards):
    study = STUDIES[wildcards.study]
    job = studies.claims_job(study, claims_in_force(wildcards))
    return job | {"repeats": {name: study.experiments[name].repeats[wildcards.scale] for name in job["paired"]}}


def claims_code(wildcards):
    own = STUDIES[wildcards.study].module()
    return source_digest("bezierplan.analysis.claims", *([own] if own else []))


def claims_experiments(wildcards):
    return studies.experiments_of_claims(claims_in_force(wildcards))


def claims_runs(wildcards):
    methods = {name: STUDIES[wildcards.study].experiments[name].methods for name in claims_experiments(wildcards)}
    return [file for experiment, names in methods.items() for file in chunk_files(wildcards, experiment, names)]


def claims_problems(wildcards):
    return expand(f"{RESULTS}/problems/{{experiment}}.parquet", **wildcards, experiment=claims_experiments(wildcards))


def claims_bounds(wildcards):
    return expand(f"{RESULTS}/problems/{{experiment}}.bounds.parquet", **wildcards, experiment=claims_experiments(wildcards))


def published_files(wildcards):
    return STUDIES[wildcards.study].published_files()


def audit_job(wildcards):
    study = STUDIES[wildcards.study]
    tables = {Path(table.published).stem: table.experiment for table in study.compared().values() if table.published}
    return {"study": study.key, "module": study.module(), "tables": tables, "experiments": sorted(set(tables.values()))}


def audit_bounds(wildcards):
    return expand(f"{RESULTS}/problems/{{experiment}}.bounds.parquet", **wildcards, experiment=audit_job(wildcards)["experiments"])


def audit_code(wildcards):
    own = STUDIES[wildcards.study].module()
    return source_digest("bezierplan.analysis.audit", *([own] if own else []))


def alternative_job(wildcards):
    changed = studies.with_alternative(STUDIES[wildcards.study], wildcards.alternative)
    return studies.job(changed, wildcards.experiment, wildcards.method, wildcards.scale, int(wildcards.chunk))


def alternative_runs(wildcards):
    """Runs under an alternative of the methods whose settings it changes, and those with all values in force of the others."""
    study = STUDIES[wildcards.study]
    changed = studies.methods_changed(study, wildcards.alternative)
    files = []
    for experiment in claims_experiments(wildcards):
        methods = studies.methods_of_claims(study, claims_in_force(wildcards), experiment)
        files += chunk_files(wildcards, experiment, [name for name in methods if name not in changed])
        files += chunk_files(wildcards, experiment, [name for name in methods if name in changed], folder=ALTERNATIVE)
    return files


def alternatives_claims(wildcards):
    return expand(f"{ALTERNATIVE}/claims.csv", **wildcards, alternative=studies.tried(STUDIES[wildcards.study]))


def alternatives_described(wildcards):
    return studies.alternatives_described(STUDIES[wildcards.study])


def all_comparisons(wildcards):
    return [f"results/{wildcards.scale}/{study}/tables/{table}.comparison.csv" for study, table in summary_job(wildcards)["tables"]]


def all_claims(wildcards):
    return [f"results/{wildcards.scale}/{key}/claims.csv" for key, study in STUDIES.items() if study.claims]


def summary_job(wildcards):
    return {
        "tables": [[key, name] for key, study in STUDIES.items() for name, table in study.compared().items() if table.published],
        "deciding": [table.decides for study in STUDIES.values() for table in study.compared().values() if table.published],
        "variants": {key: list(study.variants()) for key, study in STUDIES.items()},
        "titles": {key: study.title for key, study in STUDIES.items()},
    }


def files_of(scale, study, name):
    """The files of a table or figure."""
    if name in STUDIES[study].tables:
        endings = (".csv", ".comparison.csv") if name in STUDIES[study].compared() else (".csv",)
        return [f"results/{scale}/{study}/tables/{name}{ending}" for ending in endings]
    return [f"results/{scale}/{study}/figures/{name}{ending}" for ending in (".svg", ".png", ".csv")]


def files_of_study(scale, study):
    files = [file for name in [*STUDIES[study].tables, *STUDIES[study].figures] for file in files_of(scale, study, name)]
    if STUDIES[study].claims:
        files += [f"results/{scale}/{study}/{name}.csv" for name in ("claims", "audit")]
    return files


def files_of_summary(scale):
    """Needs claims of at least one study and published numbers of at least one table."""
    named = any(study.claims for study in STUDIES.values()) and summary_job(None)["tables"]
    return [f"results/{scale}/summary.md"] if named else []


def files_of_sensitivity(scale):
    return [f"results/{scale}/{key}/sensitivity.csv" for key, study in STUDIES.items() if studies.tried(study)]


def files_of_smoke():
    artefacts, methods = studies.smoke(STUDIES)
    runs = [f"results/smoke/{study}/runs/{experiment}/{method}/0.parquet" for study, experiment, method in methods]
    return [file for study, name in artefacts for file in files_of("smoke", study, name)] + runs
