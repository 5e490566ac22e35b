"""The files of a scale, and the job that makes each: one account, by which the workflow runs jobs
again, and by which `verify` asks whether a file is still what its job makes.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any

from bezierplan.analysis.jobs import Job, Verification
from bezierplan.analysis.outcome.proof import LIST
from bezierplan.schema import checked
from bezierplan.schema.checked import check_known
from bezierplan.study import alternatives, jobs, page
from bezierplan.study.definition import Study
from bezierplan.study.experiments import SCALES
from bezierplan.study.jobs import Studies

Made = tuple[Callable[..., Job], dict[str, Any], list[str]]
"""A function that makes a job of a study, or of all; the names that it gets, a study's among them
if it is of one; and the files that the job makes.
"""


READINGS, ALTERNATIVES = "readings", "alternatives"
"""Folders in the results of a study, of those of the study under other values."""


def places(studies: Studies) -> Studies:
    """Return studies, also under other values of their assumptions, by the place of results."""
    found = dict(studies)
    for key, study in studies.items():
        for folder, under in (
            (READINGS, alternatives.joint_readings(study)),
            (ALTERNATIVES, alternatives.single_alternatives(study)),
        ):
            found |= {f"{key}/{folder}/{name}": own for name, own in under.items()}
    return found


def home(places: Studies, place: str, scale: str, experiment: str, method: str = "") -> str:
    """Return where the problems of an experiment are, or the runs of a method, for the study at a
    place. What a reading does not change, it shares with the study; what an alternative does not,
    with the default among the alternatives, which has as few runs.
    """
    key, *below = place.split("/")
    default = f"{key}/{ALTERNATIVES}/{alternatives.DEFAULT}" if ALTERNATIVES in below else key
    if place == default:
        return place
    shared = jobs.is_shared(places[place], places[default], scale, experiment, method)
    return default if shared else place


def build_job(places: Studies, make: Callable[..., Job], names: Mapping[str, Any]) -> Job:
    """Return the job that a function makes."""
    others = {name: value for name, value in names.items() if name != "study"}
    own = {key: study for key, study in places.items() if key == study.key}
    return make(places[names["study"]] if "study" in names else own, **others)


def made(
    places: Studies, scale: str, below: Collection[str], root: str = page.RESULTS
) -> Iterator[Made]:
    """Yield what the workflow can make at a scale. below: places of studies under other values that
    count. root: as for `page.shown_of`.
    """
    every = {"scale": scale}
    for place, study in places.items():
        if place == study.key:
            parts = chain(_results(places, place, scale, study.experiments), _of_study(study))
        elif place in below:
            behind = alternatives.experiments_of_claims(study.claims)
            claims = jobs.claims, {}, ["claims.csv", "claim_checks.csv"]
            parts = chain(_results(places, place, scale, behind), [claims])
        else:
            continue
        for make, names, files in parts:
            yield make, names | every | {"study": place}, [f"{place}/{file}" for file in files]
    yield jobs.baseline_comparison, every, ["baseline_comparison.csv"]
    yield jobs.worth, every, ["worth.csv"]
    yield jobs.summary, every, ["numbers.csv", "claims.csv", "wholes.csv"]
    yield page.page, every | {"root": root}, ["index.html"]


def _results(places: Studies, place: str, scale: str, experiments: Iterable[str]) -> Iterator[Made]:
    """Yield problems and runs of experiments that are made at a place, with files in its folder."""
    study = places[place]
    for name in experiments:
        experiment = {"experiment": name}
        if home(places, place, scale, name) == place:
            yield jobs.problems, experiment, [f"problems/{name}.parquet"]
            yield jobs.bounds, experiment, [f"problems/{name}.bounds.parquet"]
        for method in study.methods_of(name):
            if home(places, place, scale, name, method) != place:
                continue
            runs, folder = experiment | {"method": method}, f"runs/{name}/{method}"
            ends = ("", ".times", ".traces") if study.moves(name) else ("", ".times")
            for number in jobs.chunks(study, name, method, scale):
                files = [f"{folder}/{number}{end}.parquet" for end in ends]
                yield jobs.runs, runs | {"chunk": str(number)}, files
            yield jobs.judgement, runs, [f"{folder}/judgement.json"]


def _of_study(study: Study) -> Iterator[Made]:
    """Yield what shows the runs of a study, with files in its folder."""
    for table in study.tables:
        of_runs = table in study.compared()
        csv, tex, *others = study.files_of(table)
        make = jobs.table_of_runs if of_runs else jobs.table_without_runs
        yield make, {"table": table}, [csv, *others]
        yield jobs.latex, {"table": table}, [tex]
    for figure in study.figures:
        yield jobs.figure, {"figure": figure}, study.files_of(figure)
    if study.claims:
        yield jobs.claims, {}, ["claims.csv", "claim_checks.csv", "claims_by_reading.csv"]
    if page.has_audit(study):
        yield jobs.audit, {}, ["audit.csv"]
    if study.verdict_file():
        yield jobs.verdict, {}, ["verdict.md"]


def verified(
    places: Studies, scale: str, root: str, files: Collection[str], build: Callable[..., Job]
) -> Verification:
    """Return the job that lists files of a scale, with the account of each, and that of the page.
    build: `build_job` of these places, which may remember jobs.
    """
    accounts = []
    below = {"/".join(file.split("/")[:3]) for file in files}
    for make, names, own in made(places, scale, below, root):
        if make is page.page or not {*own}.isdisjoint(files):
            job = build(make, names)
            accounts.append((own, job.key, job.account))
    return Verification(f"{root}{scale}", accounts)


def jobs_of(places: Studies, folder: Path, listed: Collection[str]) -> dict[str, Job]:
    """Return the job that makes each file of a scale. listed: the files of its list. What shows
    several studies shows those of these files.
    """
    scale, root = folder.resolve().name, f"{folder}/../"
    known = {name.split("/")[0] for name in listed}
    shown = {place: own for place, own in places.items() if own.key in known} or places
    build = partial(build_job, shown)
    found: dict[str, Job] = {LIST: verified(shown, scale, root, listed, build)}
    below = [place for place in places if (folder / place).is_dir()]
    for make, names, files in made(places, scale, below, root):
        job = build_job(places, make, names) if "study" in names else build(make, names)
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
