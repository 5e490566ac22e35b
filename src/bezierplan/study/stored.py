"""The files of a scale, and the job that makes each: one account, by which the workflow runs jobs
again, and by which `verify` asks whether a file is still what its job makes.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from bezierplan.analysis.jobs import Job, Verification
from bezierplan.analysis.outcome.proof import LIST
from bezierplan.schema import checked
from bezierplan.schema.checked import check_known
from bezierplan.study import jobs, page
from bezierplan.study.definition import Study
from bezierplan.study.experiments import SCALES
from bezierplan.study.jobs import Studies

Made = tuple[Callable[..., Job], dict[str, Any], list[str]]
"""A function that makes a job of a study, or of all; the names that it gets, a study's among them
if it is of one; and the files that the job makes.
"""


def build_job(studies: Studies, make: Callable[..., Job], names: Mapping[str, Any]) -> Job:
    """Return the job that a function makes."""
    others = {name: value for name, value in names.items() if name != "study"}
    return make(studies[names["study"]] if "study" in names else studies, **others)


def made(studies: Studies, scale: str, root: str = page.RESULTS) -> Iterator[Made]:
    """Yield what the workflow can make at a scale. root: as for `page.shown_of`."""
    every = {"scale": scale}
    for key, study in studies.items():
        for make, names, files in _of_study(study, scale):
            yield make, names | every | {"study": key}, [f"{key}/{file}" for file in files]
    yield jobs.baseline_comparison, every, ["baseline_comparison.csv"]
    yield jobs.worth, every, ["worth.csv"]
    yield jobs.summary, every, ["numbers.csv", "claims.csv", "wholes.csv"]
    yield page.page, every | {"root": root}, ["index.html"]


def _of_study(study: Study, scale: str) -> Iterator[Made]:
    """Yield what is made of one study, with its files in its own folder."""
    for name in study.experiments:
        experiment = {"experiment": name}
        yield jobs.problems, experiment, [f"problems/{name}.parquet"]
        yield jobs.bounds, experiment, [f"problems/{name}.bounds.parquet"]
        for method in study.methods_of(name):
            runs, folder = experiment | {"method": method}, f"runs/{name}/{method}"
            ends = ("", ".times", ".traces") if study.moves(name) else ("", ".times")
            for number in jobs.chunks(study, name, method, scale):
                files = [f"{folder}/{number}{end}.parquet" for end in ends]
                yield jobs.runs, runs | {"chunk": str(number)}, files
            yield jobs.judgement, runs, [f"{folder}/judgement.json"]
    for table in study.tables:
        of_runs = table in study.compared()
        csv, tex, *others = study.files_of(table)
        make = jobs.table_of_runs if of_runs else jobs.table_without_runs
        yield make, {"table": table}, [csv, *others]
        yield jobs.latex, {"table": table}, [tex]
    for figure in study.figures:
        yield jobs.figure, {"figure": figure}, study.files_of(figure)
    if study.claims:
        yield jobs.claims, {}, ["claims.csv", "claim_checks.csv"]
    if page.has_audit(study):
        yield jobs.audit, {}, ["audit.csv"]
    if study.votes and scale == "extended":
        kinds = ("readings", "claims_by_reading", "numbers_by_reading")
        yield jobs.readings, {}, [f"{kind}.csv" for kind in kinds]
    if study.verdict_file():
        yield jobs.verdict, {}, ["verdict.md"]


def verified(
    studies: Studies, scale: str, root: str, files: Iterable[str], build: Callable[..., Job]
) -> Verification:
    """Return the job that lists files of a scale, with the account of each, and that of the page.
    build: `build_job` of these studies, which may remember jobs.
    """
    accounts = []
    for make, names, own in made(studies, scale, root):
        if make is page.page or not {*own}.isdisjoint(files):
            job = build(make, names)
            accounts.append((own, job.key, job.account))
    return Verification(f"{root}{scale}", accounts)


def jobs_of(studies: Studies, folder: Path, listed: Collection[str]) -> dict[str, Job]:
    """Return the job that makes each file of a scale. listed: the files of its list. What shows
    several studies shows those of these files.
    """
    scale, root = folder.resolve().name, f"{folder}/../"
    known = {name.split("/")[0] for name in listed}
    build = partial(build_job, {key: studies[key] for key in studies if key in known} or studies)
    found: dict[str, Job] = {LIST: verified(*build.args, scale, root, listed, build)}
    for make, names, files in made(studies, scale, root):
        job = build_job(studies, make, names) if "study" in names else build(make, names)
        found.update(dict.fromkeys(files, job))
    return found


def places_of(folder: Path, config: dict[str, Any], words: Iterable[str]) -> dict[str, str]:
    """Return where the studies lie whose results a scale's folder holds, by name: as a
    configuration or further words say, or in the working folder. Raises Fault for one that is in
    none of these, for a folder of no scale, and FileNotFoundError without runs.
    """
    known = {Path(word).resolve().name: word for word in (*config["studies"], *words)}
    found = {problems.parent.name for problems in folder.glob("*/problems")}
    if not found:
        raise FileNotFoundError(
            f"{folder}: no runs here; expected a folder of results, such as results/full"
        )
    check_known(folder.resolve().name, SCALES, f"{folder}: scale")
    for key in sorted(found - known.keys()):
        if not Path(key, "experiments.yaml").is_file():
            raise checked.Fault(
                f"{folder / key}: no study {key} in config/config.yaml or here; say where it lies: "
                f"--studies FOLDER/{key}"
            )
        known[key] = f"./{key}"
    return {key: word for key, word in known.items() if key in found}


def strangers(folder: Path, known: Collection[str]) -> list[Path]:
    """Return the files of a scale, but for logs, that are none of those that its jobs make."""
    files = (file.relative_to(folder) for file in sorted(folder.rglob("*")) if file.is_file())
    return [
        folder / file
        for file in files
        if str(file) not in known
        and file.suffix != ".log"
        and not any(part == "logs" or part.startswith(".") for part in file.parts)
    ]
