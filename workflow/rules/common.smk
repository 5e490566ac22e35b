# The checked configuration, and what rules share. What a job reads and depends on is in
# src/bezierplan/study/targets.py.
import gc
import os
import re
import shlex
import sys
from functools import cache, partial
from pathlib import Path

# The package of this tree, even if another is installed: for this process and for the scripts of
# jobs. Kernels use one thread; Snakemake does the parallel part.
SOURCE = str(Path(str(workflow.current_basedir)).parents[1] / "src")
sys.path.insert(0, SOURCE)
os.environ.update(
    PYTHONPATH=SOURCE, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1"
)
INTERPRETER = sys.executable
# Snakemake puts the path of its interpreter into shell commands unquoted; here the folder may have
# any name.
sys.executable = shlex.quote(sys.executable)
# Snakemake writes a message and its end apart, and flushes then. What a job says between the two
# would stand on the message's line, so both are to be one write.
if hasattr(sys.stderr, "reconfigure"):
    sys.stderr.reconfigure(line_buffering=False, write_through=False)

from snakemake.cli import get_argument_parser
from snakemake.iocontainers import Params

from bezierplan.running import forks
from bezierplan.schema import checked
from bezierplan.study import alternatives, experiments, jobs, page, reading, targets

FORKS, in_an_interpreter = forks.Forks(INTERPRETER, script), script


def script(*given):
    """What the directive of this name calls: a fork of one process with all libraries, instead of a
    new interpreter. But a process that a cluster starts for one job imports only what that job
    needs.
    """
    alone = len(workflow.dag_settings.target_jobs) == 1
    # A script gets the words of a study as they are.
    given = [targets.unhidden_params(each) if isinstance(each, Params) else each for each in given]
    (in_an_interpreter if alone else FORKS.script)(*given)


def at_changes():
    """Jobs are to come, so import for them beside the checks. If nothing has changed, there may be
    none.
    """
    if sys.platform == "linux" and not workflow.output_settings.dryrun:
        FORKS.start()


@cache
def targets_given():
    """What Snakemake was asked for, which it tells a workflow only when that has been read; nothing
    if this process is not Snakemake's own, or if the workflow that it runs includes this one.
    """
    program = Path(sys.argv[0])
    if workflow.modifier.namespace is None and "snakemake" in (program.name, program.parent.name):
        return get_argument_parser().parse_known_args(sys.argv[1:])[0].targets
    return []


try:
    FOLDERS = reading.read_config(config, alone=workflow.modifier.namespace is not None)
    # In a new clone, the checks of all studies would take longer than a figure.
    STUDIES = reading.load(
        FOLDERS, at_changes, lambda folder: reading.asked_for(folder, targets_given(), FOLDERS)
    )
    reading.check_start(workflow.resource_settings.cores)
except checked.Fault as fault:
    print(fault, file=sys.stderr)
    sys.exit(2)
# All this stays until the end: to look for garbage in it takes a tenth of a start.
gc.freeze()

# Priorities. Of the jobs that can start, the one with the highest does: problems; a chunk of runs
# of each planner (`first_runs`); claims, which take longest of all that follows the runs; one study
# after the other, its runs, then its bounds. Tables and figures, many short jobs, come last (0), so
# that no core is left without work while another has a long job.
OF_STUDY = dict(zip(STUDIES, range(len(STUDIES), 0, -1)))
CLAIMS = len(STUDIES) + 1
PROBLEMS = CLAIMS + 2


def of_runs(wildcards):
    """Priority of a chunk of runs. Jobs of one planner need the same kernels, which one of them
    compiles while the others wait, so each planner has a job that comes before all others; planners
    of one study share kernels as well, so in that the studies take turns.
    """
    place = first_runs(wildcards.scale).get(
        (wildcards.study, wildcards.experiment, wildcards.method)
    )
    if place is None or wildcards.chunk != "0":
        return OF_STUDY[wildcards.study]
    return CLAIMS + 1 / (1 + place)


def of_bounds(wildcards):
    """Priority of a study's bounds."""
    return OF_STUDY[wildcards.study] - 0.5


@cache
def first_runs(scale):
    return jobs.leaders(STUDIES, scale)


RESULTS = "results/{scale}/{study}"
ALTERNATIVE = f"{RESULTS}/sensitivity/{{alternative}}"


def one_of(names):
    """Pattern of names; without names, one that never matches."""
    return "|".join(map(re.escape, sorted(set(names)))) or "(?!)"


wildcard_constraints:
    scale=one_of(experiments.SCALES),
    study=one_of(STUDIES),
    experiment=one_of(name for study in STUDIES.values() for name in study.experiments),
    method=one_of(name for study in STUDIES.values() for name in study.methods),
    chunk="[0-9]+",
    table=one_of(name for study in STUDIES.values() for name in study.compared()),
    listing=one_of(
        name
        for study in STUDIES.values()
        for name in study.tables.keys() - study.compared().keys()
    ),
    figure=one_of(name for study in STUDIES.values() for name in study.figures),
    alternative=one_of(name for study in STUDIES.values() for name in alternatives.tried(study)),


def studies_with(tables):
    """Pattern of the names of studies in paths of tables: a name may be one kind of table in one
    study and another kind in another.
    """
    return (
        "|".join(
            f"{re.escape(key)}(?=/tables/(?:{one_of(names)})[.])" for key, names in tables.items()
        )
        or "(?!)"
    )


def studies_of(experiments):
    """Pattern of the names of studies in paths of experiments: runs of one experiment may be
    simulated drives, those of another not.
    """
    places = {
        key: rf"(?=/(?:problems|runs)/(?:{one_of(names)})(?:[.]|/))"
        for key, names in experiments.items()
    }
    return "|".join(re.escape(key) + place for key, place in places.items()) or "(?!)"


STILL, MOVING = targets.moving(STUDIES, False), targets.moving(STUDIES, True)
COMPARED = {key: study.compared().keys() for key, study in STUDIES.items()}
LISTED = {key: study.tables.keys() - study.compared().keys() for key, study in STUDIES.items()}


# What a module that uses this workflow puts before each path of results; it stands in no path that
# rules write.
PREFIX = workflow.modifier.path_modifier.prefix or ""


def placed(files):
    """Files that a job reads. Those of a study stay where they are, wherever a module has its
    results.
    """
    if isinstance(files, dict):
        return {name: placed(each) for name, each in files.items()}
    if isinstance(files, str):
        return files if files.startswith("results/") else local(files)
    return [placed(each) for each in files]


def inputs(function):
    """Input files from `targets`, for the wildcards of a job."""
    return unpack(lambda wildcards: placed(function(STUDIES, **wildcards)))


def maps(wildcards):
    """Map files of an experiment."""
    return placed(targets.problem_maps(STUDIES, **wildcards))


def params(function, *names):
    """Params from `targets`, for the wildcards of a job. Snakemake prints them into its report as
    they are, so no words in them are markup.
    """

    def param(name, wildcards):
        return targets.hidden(function(STUDIES, **wildcards)[name])

    return {name: partial(param, name) for name in names}


def caption(wildcards, output):
    """The report's caption of a table or figure. Snakemake does not compare params derived from
    `output`: no file depends on it.
    """
    return targets.caption(STUDIES, **wildcards)
