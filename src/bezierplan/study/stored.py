"""The files of a scale, and the job that makes each. By this one account the workflow runs jobs
again, and `verify` asks whether a file is what its job makes.
"""

import os
from collections.abc import Collection, Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any

from bezierplan.analysis.jobs import Job, Verification
from bezierplan.analysis.outcome.verification import LIST, PAGE
from bezierplan.places import shorten_path
from bezierplan.schema.checked import Fault, check_known
from bezierplan.study import alternatives, jobs, loading, page
from bezierplan.study.definition import Study
from bezierplan.study.experiments import SCALES
from bezierplan.study.jobs import Studies

Made = tuple[Job, list[str]]
"""A job, and the files that it makes, relative to the folder of a scale."""

READINGS, ALTERNATIVES = "readings", "alternatives"
"""Folders in the results of a study that hold those under other values of its assumptions."""


def list_places(studies: Studies) -> Studies:
    """Return the studies by place of results, also those under other values of assumptions."""
    by_place = dict(studies)
    for key, study in studies.items():
        for folder, under in (
            (READINGS, alternatives.build_joint_readings(study)),
            (ALTERNATIVES, alternatives.build_single_alternatives(study)),
        ):
            by_place |= {f"{key}/{folder}/{name}": own for name, own in under.items()}
    return by_place


def find_home(
    places: Studies, own_place: str, scale: str, experiment: str, method: str = ""
) -> str:
    """Return the place where the problems of an experiment lie, or the runs of a method, for the
    study at `own_place`.

    A reading shares what it does not change with the study. An alternative shares it with the
    default among the alternatives, which has as few runs.
    """
    key, *below = own_place.split("/")
    default = f"{key}/{ALTERNATIVES}/{alternatives.DEFAULT}" if ALTERNATIVES in below else key
    if own_place == default:
        return own_place
    shared = jobs.is_shared(places[own_place], places[default], scale, experiment, method)
    return default if shared else own_place


def yield_jobs(
    places: Studies, scale: str, below: Collection[str], root: str = page.RESULTS
) -> Iterator[Made]:
    """Yield all jobs of a scale with their files.

    below: the places of studies under other values that count. root: the folder of all scales, as
    in `page.list_artefacts`.
    """
    studies = {own_place: study for own_place, study in places.items() if own_place == study.key}
    for own_place, study in places.items():
        if own_place in studies:
            parts = chain(
                _yield_results(places, own_place, scale, study.experiments),
                _yield_artefacts(study, scale),
            )
        elif own_place in below:
            behind = alternatives.list_experiments(study.claims)
            claims = jobs.build_claims(study, scale), ["claims.csv", "claim_checks.csv"]
            parts = chain(_yield_results(places, own_place, scale, behind), [claims])
        else:
            continue
        yield from ((job, [f"{own_place}/{file}" for file in files]) for job, files in parts)
    yield jobs.build_methods(studies, scale), ["methods.csv"]
    yield jobs.build_summary(studies, scale), ["numbers.csv", "claims.csv"]
    yield page.build_page(studies, scale, root), [PAGE]


def _yield_results(
    places: Studies, own_place: str, scale: str, experiments: Iterable[str]
) -> Iterator[Made]:
    """Yield the jobs of problems and runs whose files lie at a place, with paths relative to it."""
    study = places[own_place]
    for name in experiments:
        if find_home(places, own_place, scale, name) == own_place:
            yield jobs.build_problems(study, scale, name), [f"problems/{name}.parquet"]
            yield jobs.build_bounds(study, scale, name), [f"problems/{name}.bounds.parquet"]
        ends = ("", ".times", ".traces") if study.moves(name) else ("", ".times")
        own = [
            method
            for method in study.methods_of(name)
            if find_home(places, own_place, scale, name, method) == own_place
        ]
        for group in jobs.group_methods(study, scale, name, own):
            for method in group:
                for number in jobs.list_chunks(study, name, method, scale):
                    files = [f"runs/{name}/{method}/{number}{end}.parquet" for end in ends]
                    yield jobs.build_runs(study, scale, name, method, str(number)), files
            judgement = jobs.build_judgement(study, scale, name, group)
            yield judgement, [f"runs/{name}/{group[0]}/judgement.json"]


def _yield_artefacts(study: Study, scale: str) -> Iterator[Made]:
    """Yield the jobs that show the runs of a study, with files relative to its folder."""
    for table in study.tables:
        csv, tex, *others = study.files_of(table)
        of_runs = table in study.find_tables_of_runs()
        make = jobs.build_table_of_runs if of_runs else jobs.build_table_without_runs
        yield make(study, scale, table), [csv, *others]
        yield jobs.build_latex(study, scale, table), [tex]
    for figure in study.figures:
        yield jobs.build_figure(study, scale, figure), study.files_of(figure)
    if study.claims:
        files = ["claims.csv", "claim_checks.csv", "claims_by_reading.csv"]
        yield jobs.build_claims(study, scale), files
    if page.has_audit(study):
        yield jobs.build_audit(study, scale), ["audit.csv"]


def build_verification(
    places: Studies, scale: str, root: str, files: Collection[str]
) -> Verification:
    """Build the job that lists the files of a scale, with the account of each and of the page."""
    # A study under other values lies three folders deep: study/readings/name.
    below = {"/".join(file.split("/")[:3]) for file in files}
    accounts = [
        (own, job.key, job.account)
        for job, own in yield_jobs(places, scale, below, root)
        # The page holds the digest of the list, so it is no file of the list; its account is.
        if own == [PAGE] or not {*own}.isdisjoint(files)
    ]
    words = {
        # With a slash, because a word without one names a study of this project.
        place: os.path.join(".", shorten_path(study.folder))
        for place, study in places.items()
        if place == study.key
    }
    return Verification(f"{root}{scale}", words, accounts)


def find_jobs(places: Studies, folder: Path, files: Collection[str]) -> dict[str, Job]:
    """Return the job that makes each file of a scale, by file.

    files: those in the scale's list. Files that show several studies show those of these files.
    """
    scale, root = folder.resolve().name, f"{folder}/../"
    keys = {name.split("/")[0] for name in files}
    on_page = {place: study for place, study in places.items() if study.key in keys} or places
    below = [place for place in places if (folder / place).is_dir()]
    job_of = {
        file: job
        # The later jobs win: files above the studies are those of the studies on the page.
        for studies in (places, on_page)
        for job, job_files in yield_jobs(studies, scale, below, root)
        for file in job_files
    }
    return job_of | {LIST: build_verification(on_page, scale, root, files)}


def read_places(folder: Path, config: dict[str, Any], words: Iterable[str]) -> dict[str, str]:
    """Return the word that locates each study with results in a scale's folder, by study.

    config, words: where studies lie; then the page says it, and the working folder is searched
    last. Raises Fault for a study that is in none of these and for a folder of no scale, and
    FileNotFoundError if there are no runs.
    """
    named = {Path(word).resolve().name: word for word in (*config["studies"], *words)}
    on_page = loading.read_page_studies(folder).items()
    words_by_key = {
        key: word for key, word in on_page if Path(word, "experiments.yaml").is_file()
    } | named
    keys = {problems.parent.name for problems in folder.glob("*/problems")}
    if not keys:
        raise FileNotFoundError(
            f"{folder}: no runs here; expected a folder of results, such as results/full"
        )
    check_known(folder.resolve().name, SCALES, f"{folder}: scale")
    for key in sorted(keys - words_by_key.keys()):
        if not Path(key, "experiments.yaml").is_file():
            raise Fault(
                f"{folder / key}: no study {key} in config/config.yaml or here; say where it lies: "
                f"--studies FOLDER/{key}"
            )
        words_by_key[key] = f"./{key}"
    return {key: word for key, word in words_by_key.items() if key in keys}


def find_strangers(folder: Path, names: Collection[str]) -> list[Path]:
    """Return the files of a scale, logs excepted, that none of its jobs makes."""
    files = (file.relative_to(folder) for file in sorted(folder.rglob("*")) if file.is_file())
    return [
        folder / file
        for file in files
        if str(file) not in names
        and file.suffix != ".log"
        and not any(part == "logs" or part.startswith(".") for part in file.parts)
    ]
