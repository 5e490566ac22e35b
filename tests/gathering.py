"""A study of any number of runs, and what the workflow's jobs need to gather them.

A few runs of each method are made; the other rows repeat them under other ids, for to gather runs
it does not matter where they come from.
"""

import contextlib
import multiprocessing
import resource
import runpy
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet
import yaml

from bezierplan.analysis.jobs import Job
from bezierplan.places import TREE
from bezierplan.running import execution, problems, rows
from bezierplan.running.inputs import experiments
from bezierplan.study import jobs, page, reading
from bezierplan.study.definition import Study
from bezierplan.study.experiments import SCALES
from bezierplan.study.jobs import Studies

METHODS = ("pso", "cpso1_singer", "cpso2_singer", "ferguson")
PLACES = ("equal", "public")
SCALE = "full"
MADE = 50
"""Runs of each method on each problem that are made; the others repeat them."""

ARTEFACTS = """
tables:
  lengths:
    {title: Lengths, kind: pivot, experiment: all, published: lengths.csv, index: [method],
    columns: [problem, value], values: [
      {metric: length, statistic: [mean, median, std, min], label: length, decimals: 2},
      {metric: feasible, statistic: share, label: feasible, decimals: 2}]}
figures:
  spread: {title: Lengths, columns: 2, panels: [
    {kind: boxes, experiment: all, metric: length},
    {kind: convergence, experiment: all, where: {problem: equal, method: [pso, ferguson]},
     hue: method}]}
  paths: {title: Paths, columns: 1, panels: [
    {kind: paths, experiment: all, where: {method: pso, problem: equal}, pick: {lowest: length}}]}
"""
FIGURE_FILES = {"svg": "svg", "png": "png", "pdf": "pdf", "data": "csv", "caption": "txt"}
THREADS = 2
"""Processes that a job may start."""
CLAIMS = """
claims:
  - {id: C1, place: invented, statement: The plain swarm is shorter., artefact: lengths, checks: [
      {test: lower, experiment: all, every: [problem], metric: length, groups: [pso],
       than: [ferguson], direction: lower, margin: 0.01}]}
"""
PUBLISHED = """problem,method,metric,statistic,n,unit,value
equal,pso,length,mean,30,unit,8.5
equal,ferguson,length,mean,30,unit,8.0
"""


def write_study(folder: Path, repeats: int, chunk: int) -> Path:
    """Write a study into a new folder and return it: four swarms of tharwat2018 and a baseline on
    two problems, so ten runs a repeat.
    """
    swarms = reading.load(reading.read_config({"studies": ["tharwat2018"]}))["tharwat2018"]
    sizes = {"repeats": dict.fromkeys(SCALES, repeats), "chunk": dict.fromkeys(SCALES, chunk)}
    described = {
        "title": "Swarms of tharwat2018",
        "methods": {
            name: {
                "planner": swarms.planner(name),
                "settings": swarms.resolved(name) | {"stall_limit": 0},
            }
            for name in METHODS
        },
        "baselines": {"shortest_path": {"planner": "shortest_path"}},
        "settings": {},
        "workspaces": {name: swarms.workspaces[name].plain() for name in PLACES},
        "problems": {
            name: {"workspace": name, "start": [0, 0], "target": [4, 6]} for name in PLACES
        },
        "experiments": {"all": {"problems": list(PLACES), "methods": list(METHODS), **sizes}},
        "baseline_comparison": {"baseline": "shortest_path", "experiments": ["all"]},
    }
    (folder / "published").mkdir(parents=True)
    (folder / "experiments.yaml").write_text(yaml.safe_dump(described, sort_keys=False))
    (folder / "artefacts.yaml").write_text(ARTEFACTS)
    (folder / "claims.yaml").write_text(CLAIMS)
    (folder / "published" / "lengths.csv").write_text(PUBLISHED)
    return folder


def repeated(made: pa.Table, repeats: range) -> pa.Table:
    """A table of runs or of their times with other repeats: the rows of each condition as often as
    needed, under new ids.

    made: rows in the order of conditions and repeats, `MADE` of each condition.
    """
    numbers = np.concatenate(
        [first + np.arange(len(repeats)) % MADE for first in range(0, len(made), MADE)]
    )
    stems = [name.rpartition("/")[0] for name in made["id"].to_pylist()[::MADE]]
    new = {
        "id": [f"{stem}/{repeat}" for stem in stems for repeat in repeats],
        "repeat": [*repeats] * len(stems),
    }
    table = made.take(numbers)
    for name in new.keys() & set(made.column_names):
        table = table.set_column(made.column_names.index(name), name, pa.array(new[name]))
    return table


def write_runs(study: Study) -> None:
    """Write problems, bounds and all chunks of runs of a study into `results` of the working
    folder.
    """
    described = jobs.problems_job(study, "all", SCALE)
    made = problems.build_all(described, study.folder)
    files = files_of(study)
    for file in (files.problems, *files.chunks):
        Path(file).parent.mkdir(parents=True, exist_ok=True)
    problems.write(made, described.homes, files.problems)
    rows.write(problems.bounds_of(problems.read(files.problems)), files.bounds)
    for method in study.methods_of("all"):
        runs, times = execution.run_chunk(
            made, jobs.job(study, "all", method, SCALE, 0)._replace(repeats=[0, MADE])
        )
        for file in map(Path, files.runs[method]):
            first, last = jobs.job(study, "all", method, SCALE, int(file.stem)).repeats
            rows.write(repeated(runs, range(first, last)), str(file))
            parquet.write_table(
                repeated(times, range(first, last)), file.with_suffix(".times.parquet")
            )


def given_to(job: Job, key: str, **more: Any) -> dict[str, Any]:
    """The input files of a job by their names in its rule: results in the working folder. key: the
    study of experiments that are named alone.
    """
    places = {name: name.split("/") if "/" in name else (key, name) for name in job.shows}
    folders = {name: f"results/{SCALE}/{study}" for name, (study, _) in places.items()}
    return {
        "problems": [
            f"{folders[name]}/problems/{own}.parquet" for name, (_, own) in places.items()
        ],
        "bounds": [
            f"{folders[name]}/problems/{own}.bounds.parquet" for name, (_, own) in places.items()
        ],
        "runs": [
            f"{folders[name]}/runs/{own}/{method}/{chunk}.parquet"
            for name, (_, own) in places.items()
            for method, number in job.shows[name].items()
            for chunk in range(number)
        ],
    } | more


def input_files(named: dict[str, Any]) -> Any:
    """Input files as a script gets them: one list, of which parts have names."""
    from snakemake.iocontainers import InputFiles

    files = InputFiles()
    for name, values in named.items():
        start, several = len(files), not isinstance(values, str)
        files.extend(values if several else [values])
        files._set_name(name, start, end=len(files) if several else None)
    return files


def files_of(study: Study) -> Any:
    """Files of all runs of a study, its problems and bounds, in the working folder."""
    methods = study.methods_of("all")
    job = SimpleNamespace(shows={"all": jobs.chunks_of(study, "all", methods, SCALE)})
    return experiments(job.shows, SimpleNamespace(**given_to(job, study.key)))["all"]


class Made(NamedTuple):
    """A job, and its files."""

    job: Job
    input: dict[str, Any]
    output: dict[str, str]


def gathering(given: Studies) -> Iterator[Made]:
    """The jobs that gather the runs of studies, in an order in which they can be made."""
    for key in given:
        yield from _gathering_one(given, key)
    folder = f"results/{SCALE}"
    compared, summary, shown = (
        make(given, SCALE) for make in (jobs.baseline_comparison, jobs.summary, page.page)
    )
    baseline = f"{folder}/baseline_comparison.csv"
    yield Made(compared, given_to(compared, ""), {"made": baseline})
    output = {"numbers": "numbers.csv", "claims": "claims.csv", "wholes": "wholes.csv"}
    output = {name: f"{folder}/{file}" for name, file in output.items()}
    output["summary"] = f"{folder}/summary.md"
    files = {
        "comparisons": [f"{folder}/{key}/beyond/lengths.comparison.csv" for key in given],
        "wholes": [f"{folder}/{key}/beyond/lengths.wholes.csv" for key in given],
        "claims": [f"{folder}/{key}/claims.csv" for key in given],
        "baseline_comparison": baseline,
        "audits": [],
        "readings": [],
        "sources": [],
    }
    yield Made(summary, files, output)
    judgements = []
    for key, study in given.items():
        for method in study.methods_of("all"):
            judgement = jobs.judgement(study, SCALE, "all", method)
            judgements.append(f"{folder}/{key}/runs/all/{method}/judgement.json")
            yield Made(judgement, given_to(judgement, key), {"made": judgements[-1]})
    verified = page.verified(given, SCALE)
    files = given_to(verified, "", judgements=judgements)
    yield Made(verified, files, {"made": f"{folder}/verified.json"})
    files = given_to(
        shown,
        "",
        summary=[output["numbers"], output["claims"], baseline],
        verified=f"{folder}/verified.json",
    )
    yield Made(shown, files, {"page": f"{folder}/index.html"})


def _gathering_one(given: Studies, key: str) -> Iterator[Made]:
    """Tables, figures, claims and audit of a study."""
    study, folder = given[key], f"results/{SCALE}/{key}"
    for name in study.tables:
        job = jobs.table_of_runs(study, SCALE, name)
        output = {
            part: f"{folder}/beyond/{name}.{ending}"
            for part, ending in (
                ("table", "csv"),
                ("comparison", "comparison.csv"),
                ("published", "published.csv"),
                ("wholes", "wholes.csv"),
            )
        }
        yield Made(job, given_to(job, key, sources=job.sources), output)
    for name in study.figures:
        job = jobs.figure(study, SCALE, name)
        output = {part: f"{folder}/beyond/{name}.{ending}" for part, ending in FIGURE_FILES.items()}
        yield Made(job, given_to(job, key, sources=job.sources), output)
    claims, audit = jobs.claims(study, SCALE), jobs.audit(study, SCALE)
    output = {"claims": f"{folder}/claims.csv", "checks": f"{folder}/claim_checks.csv"}
    yield Made(claims, given_to(claims, key, sources=claims.sources, beside=[]), output)
    yield Made(audit, given_to(audit, key, sources=audit.sources), {"made": f"{folder}/audit.csv"})


def peaks(repeats: int, chunk: int) -> dict[str, float]:
    """Peak resident memory, in bytes, of the jobs that gather a study of ten times as many runs as
    repeats: of each kind the largest.
    """
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        given = reading.load([write_study(Path(folder, "many"), repeats, chunk)])
        write_runs(given["many"])
        # A fork of a small process: one that was started from this process would count this one's
        # memory as its own.
        context = multiprocessing.get_context("forkserver")
        found: dict[str, float] = {}
        for job in gathering(given):
            with ProcessPoolExecutor(1, context) as pool:
                name = type(job.job).__name__
                found[name] = max(found.get(name, 0.0), pool.submit(_peak, job, folder).result())
    return found


def _peak(job: Made, folder: str) -> float:
    """Run a job in this process, and return the most memory that it ever had, in bytes, with that
    of each process that it starts.
    """
    from snakemake.iocontainers import OutputFiles, Params

    with contextlib.chdir(folder):
        for file in job.output.values():
            Path(file).parent.mkdir(parents=True, exist_ok=True)
        given = SimpleNamespace(
            input=input_files(job.input),
            output=OutputFiles(fromdict=job.output),
            params=Params(fromdict={"job": job.job}),
            log=["job.log"],
            threads=THREADS,
        )
        runpy.run_path(str(TREE / "workflow/scripts/job.py"), {"snakemake": given})
    own, largest = (
        resource.getrusage(whose).ru_maxrss
        for whose in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return (own + THREADS * largest) * (1 if sys.platform == "darwin" else 1024)
