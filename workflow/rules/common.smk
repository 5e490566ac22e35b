# The checked configuration, and what rules share.
import os
import re
import shlex
import sys
from functools import cache
from pathlib import Path

# The package of this tree, even if another is installed: for this process and for the scripts of
# jobs. Kernels use one thread; Snakemake does the parallel part.
SOURCE = str(Path(str(workflow.current_basedir)).parents[1] / "src")
sys.path.insert(0, SOURCE)
os.environ.update(
    PYTHONPATH=SOURCE, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1"
)

from bezierplan.places import choose_machine_code

choose_machine_code()

from snakemake.cli import get_argument_parser
from snakemake.iocontainers import Wildcards

from bezierplan.analysis import rst
from bezierplan.running.jobs import forks, watchdog
from bezierplan.running.inputs import choose_tree
from bezierplan.schema import checked
from bezierplan.study import captions, experiments, jobs, page, loading, stored

# The directive `script` calls the function of this name: here a fork of one process with all
# libraries takes the place of a new interpreter. Snakemake has no public way to say so; it would
# cost each job one to two seconds.
FORKS = forks.Forks(sys.executable, script)
script = FORKS.script


def or_exit(work, *of):
    """What a function returns; faults end the program, each in one line."""
    try:
        return work(*of)
    except checked.Fault as fault:
        print(*fault.lines, sep="\n", file=sys.stderr)
        sys.exit(2)


CONFIG = loading.find_config_file()
# In a module, the configuration is that of the workflow which uses it.
if not config:
    or_exit(checked.read, CONFIG)


configfile: CONFIG


def targets():
    """What Snakemake was asked for, which it tells no workflow while that is read: targets, and
    of a job on a cluster its study. None of a workflow of which this one is a module.
    """
    program = Path(sys.argv[0])
    if workflow.modifier.namespace or "snakemake" not in (program.name, program.parent.name):
        return []
    words, _ = get_argument_parser().parse_known_args(sys.argv[1:])
    jobs = words.target_jobs or []
    return [*words.targets, *(job.wildcards_dict.get("study", "all") for job in jobs)]


# What a module that uses this workflow puts before each path of results: for the page, which looks
# what there is. Snakemake tells it nowhere else.
PREFIX = workflow.modifier.path_modifier.prefix or ""
# Files of a whole scale are of the studies that are asked for, and of those that they show already.
PAGES = {
    scale: loading.read_page_studies(f"{PREFIX}results/{scale}") for scale in experiments.SCALES
}
FOLDERS = or_exit(loading.read_config, config)
# A target of one study starts without the others.
NAMED = loading.select_studies(FOLDERS, targets())
ASKED = or_exit(loading.load, NAMED)
SHOWN = {key: word for listed in PAGES.values() for key, word in listed.items() if key not in ASKED}
STUDIES = ASKED | (loading.load_others(SHOWN, config) if len(NAMED) == len(FOLDERS) else {})
# In the order in which they came.
OF_SCALE = {
    scale: {key: STUDIES[key] for key in {**listed, **ASKED} if key in STUDIES}
    for scale, listed in PAGES.items()
}
# Snakemake puts the path of its interpreter into commands unquoted, and a folder may have any name.
# Planners of studies, which that interpreter reads, are known by now.
sys.executable = shlex.quote(sys.executable)
RESULTS = "results/{scale}/{study}"
# The folder of results: for the page, which looks what there is.
ROOT = f"{PREFIX}{page.RESULTS}"


PLACES = stored.list_places(STUDIES)
BELOW = f"(?:/(?:{stored.READINGS}|{stored.ALTERNATIVES})/[^/]+)"
"""Pattern of a place below that of a study."""


def under(key, folder):
    """The places in a folder of the results of a study."""
    return [place for place in PLACES if place.startswith(f"{key}/{folder}/")]


@cache
def home(place, scale, experiment, method=""):
    """Where the problems of an experiment are, or the runs of a method, for the study at a place."""
    return stored.find_home(PLACES, place, scale, experiment, method)


@cache
def judged_with(place, scale, experiment, method):
    """The methods whose runs, made at a place, are judged together with those of a method."""
    study = PLACES[place]
    own = [
        name
        for name in study.methods_of(experiment)
        if home(place, method=name, scale=scale, experiment=experiment) == place
    ]
    groups = jobs.group_methods(study, scale, experiment, own)
    return next(group for group in groups if method in group)


def one_of(names):
    """Pattern of names; without names, one that never matches."""
    return "|".join(map(re.escape, sorted(set(names)))) or "(?!)"


def studies_with(files):
    """Pattern of the names of studies, each before those of its files alone: what is one kind of
    table in one study may be another kind in another.
    """
    return (
        "|".join(
            f"{re.escape(key)}(?:{BELOW})?(?=/(?:{one_of(names)})[./])"
            for key, names in files.items()
        )
        or "(?!)"
    )


STILL, MOVING = (
    {
        key: [f"runs/{name}" for name in study.experiments if study.moves(name) == moves]
        for key, study in STUDIES.items()
    }
    for moves in (False, True)
)


def files_in(scale, folder, study=None):
    """Files of all tables and figures of one tree: of a study, or of all."""
    return [
        file
        for own in OF_SCALE[scale].values()
        if study in (None, own.key)
        for name in own.list_names(folder)
        for file in files_of(scale, own, name)
    ]


def in_trees(names):
    return [f"{choose_tree(name)}/{name}" for name in names]


def files_of(scale, study, name):
    """The files of a table or figure."""
    return [f"results/{scale}/{study.key}/{file}" for file in study.files_of(name)]


PRINTED = {key: in_trees(study.find_published_tables()) for key, study in STUDIES.items()}
UNPRINTED = {
    key: in_trees(study.find_tables_of_runs().keys() - study.find_published_tables().keys())
    for key, study in STUDIES.items()
}
LISTED = {
    key: in_trees(study.tables.keys() - study.find_tables_of_runs().keys())
    for key, study in STUDIES.items()
}
DRAWN = {key: in_trees(study.figures) for key, study in STUDIES.items()}


wildcard_constraints:
    scale=one_of(experiments.SCALES),
    study=f"(?:{one_of(STUDIES)})(?:{BELOW})?",
    experiment=one_of(name for study in STUDIES.values() for name in study.experiments),
    method=one_of(name for study in STUDIES.values() for name in study.methods),
    chunk="[0-9]+",
    tree=one_of(["paper", "beyond"]),
    table=one_of(name for study in STUDIES.values() for name in study.tables),
    figure=one_of(name for study in STUDIES.values() for name in study.figures),


def params(make, **more):
    """Params of a rule: its job, and the account by which Snakemake sees that it is another one."""
    return params_of(of(make, **more))


def params_of(job):
    return {"job": job, "account": lambda wildcards: job(wildcards).grounds}


@cache
def build(make, scale, study=None, tree=None, **names):
    """The job that a function makes of the study at a place, or of all those of a scale."""
    return make(PLACES[study] if study else OF_SCALE[scale], scale=scale, **names)


def of(make, **more):
    """The same for the wildcards of a rule."""
    return lambda wildcards: build(make, **dict(wildcards), **more)


@cache
def judgement_of(scale, study, experiment, method):
    """The job that judges runs."""
    methods = judged_with(study, scale, experiment, method)
    return jobs.build_judgement(PLACES[study], scale, experiment, methods)


def judgement(wildcards):
    """The same for the wildcards of its rule."""
    return judgement_of(**dict(wildcards))


KINDS = {
    "runs": f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.parquet",
    "times": f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.times.parquet",
    "traces": f"{RESULTS}/runs/{{experiment}}/{{method}}/{{chunk}}.traces.parquet",
    "judgements": f"{RESULTS}/runs/{{experiment}}/{{method}}/judgement.json",
    "problems": f"{RESULTS}/problems/{{experiment}}.parquet",
    "bounds": f"{RESULTS}/problems/{{experiment}}.bounds.parquet",
}
"""Results by kind: files of each experiment, some of its methods, or each chunk of runs."""


def results(job, *kinds):
    """Files of the results that a job reads, of all kinds or some: it knows the experiments, their
    methods, and the number of chunks. Only drives have traces.
    """
    return lambda wildcards: {kind: files_read(job, kind, wildcards) for kind in kinds or KINDS}


def problems_of(wildcards):
    """The file of the problems of runs."""
    own = home(wildcards.study, wildcards.scale, wildcards.experiment)
    return KINDS["problems"].format(
        scale=wildcards.scale, study=own, experiment=wildcards.experiment
    )


def files_read(job, kind, wildcards):
    """Those of one kind."""
    found = []
    for name, methods in job(wildcards).shows.items():
        study, _, experiment = name.rpartition("/")
        study = study or wildcards.study
        if kind == "traces" and not PLACES[study].moves(experiment):
            continue
        place = {"scale": wildcards.scale, "experiment": experiment}
        chunks = [(method, n) for method in methods for n in range(methods[method])]
        # Problems have no methods.
        of_runs = chunks if "{method}" in KINDS[kind] else [("", 0)]
        for method, n in of_runs:
            own = home(study, method=method, **place)
            if kind == "judgements":
                method = judged_with(own, method=method, **place)[0]
            found.append(KINDS[kind].format(**place, study=own, method=method, chunk=n))
    return [*dict.fromkeys(found)]


def sources(job):
    """Files of the folders of studies that a job reads: they stay where they are, wherever a module
    has its results.
    """
    return lambda wildcards: [local(file) for file in job(wildcards).sources]


def more(least):
    """A resource, of which each further attempt gets more."""
    return lambda wildcards, attempt: least * attempt


def caption(wildcards, output):
    """The report's caption of a table or figure. Snakemake does not compare params derived from
    `output`: no file depends on it.
    """
    name = wildcards.get("table") or wildcards.figure
    return rst.escape_rst(
        captions.build_caption(STUDIES[wildcards.study], name, wildcards.scale).write()
    )


def compared(scale, ending):
    """Files of one kind of all tables of a scale that have published numbers."""
    return [
        f"results/{scale}/{key}/{choose_tree(name)}/{name}.{ending}.csv"
        for key, study in OF_SCALE[scale].items()
        for name in study.find_published_tables()
    ]


def of_studies(scale, name, has=lambda study: study.claims):
    """Files of a name of all studies of a scale that have it."""
    keys = [key for key, study in OF_SCALE[scale].items() if has(study)]
    return [f"results/{scale}/{key}/{name}" for key in keys]


def summed(scale):
    """Files of all studies of a scale together."""
    names = ["numbers", "claims", "methods"] if compared(scale, "published") else []
    return [f"results/{scale}/{name}.csv" for name in names]


def of_readings(file):
    """A file of each joint reading of a study, at the scale at which claims are judged so."""
    return lambda wildcards: [
        f"results/{wildcards.scale}/{place}/{file}"
        for place in under(wildcards.study, stored.READINGS)
        if wildcards.scale == jobs.JUDGED_AT
    ]


def of_alternatives(wildcards):
    """The comparisons of claims by default and under each alternative, if a figure draws them."""
    drawn = STUDIES[wildcards.study].figures[wildcards.figure].claims
    places = under(wildcards.study, stored.ALTERNATIVES) if drawn else ()
    return [f"results/{wildcards.scale}/{place}/claim_checks.csv" for place in places]


def below(scale):
    """Places of studies under other values on whose claims the page rests."""
    found = []
    for key, study in OF_SCALE[scale].items():
        figures = study.figures.keys() & {*page.list_artefacts(study, scale, ROOT)}
        drawn = any(study.figures[name].claims for name in figures)
        found += under(key, stored.READINGS) if scale == jobs.JUDGED_AT else []
        found += under(key, stored.ALTERNATIVES) if drawn else []
    return found


def shown(wildcards):
    """Files of a scale that the page shows: what the papers have, and of the rest what there is."""
    scale = wildcards.scale
    artefacts = [
        file
        for study in OF_SCALE[scale].values()
        for name in page.list_artefacts(study, scale, ROOT)
        for file in files_of(scale, study, name)
    ]
    return [
        *artefacts,
        *of_studies(scale, "claims.csv"),
        *of_studies(scale, "claim_checks.csv"),
        *of_studies(scale, "claims_by_reading.csv"),
        *of_studies(scale, "audit.csv", page.has_audit),
    ]


def judged(wildcards):
    """Files of the results that the page shows, and of those that the summary compares with the
    baseline.
    """
    makes = [of(page.build_page, root=ROOT)]
    makes += [of(jobs.build_methods)] if summed(wildcards.scale) else []
    parts = [results(job)(wildcards) for job in makes]
    for place in below(wildcards.scale):
        names = Wildcards(fromdict={"scale": wildcards.scale, "study": place})
        parts.append(results(of(jobs.build_claims))(names))
    return {kind: [*dict.fromkeys(file for part in parts for file in part[kind])] for kind in KINDS}


def listed(wildcards):
    """All files behind the page, by kind."""
    return {
        **judged(wildcards),
        "shown": shown(wildcards),
        "summary": summed(wildcards.scale),
        "below": [
            f"results/{wildcards.scale}/{place}/{name}.csv"
            for place in below(wildcards.scale)
            for name in ("claims", "claim_checks")
        ],
    }


def verified(wildcards):
    """The job that lists them."""
    folder = f"results/{wildcards.scale}/"
    files = {file.removeprefix(folder) for kind in listed(wildcards).values() for file in kind}
    places = {
        place: study for place, study in PLACES.items() if study.key in OF_SCALE[wildcards.scale]
    }
    return stored.build_verification(places, wildcards.scale, ROOT, files)
