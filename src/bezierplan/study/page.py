"""The job that makes the page of a scale."""

from pathlib import Path

from bezierplan.figures.jobs import Page
from bezierplan.figures.page import EVIDENCE, PICTURES, list_files, sort_as_printed
from bezierplan.figures.page.page_job import MethodView, PageJob, StudyView
from bezierplan.machine.digest import name_module, read_docstring
from bezierplan.running.inputs import BEYOND, PAPER, Shows
from bezierplan.study import captions, evidence, jobs
from bezierplan.study.alternatives import find_default
from bezierplan.study.definition import Study
from bezierplan.study.jobs import Studies

RESULTS = "results/"


def list_artefacts(study: Study, scale: str, root: str = RESULTS) -> list[str]:
    """Return the names of the tables and figures of a study that the page shows: all of the paper,
    and those of the others that exist (at scale extended all).

    root: the folder of all scales, with a slash at its end.
    """
    folder = Path(f"{root}{scale}/{study.key}/{BEYOND}")
    return sort_as_printed(
        [
            *study.list_names(PAPER),
            *(
                name
                for name in study.list_names(BEYOND)
                if scale == "extended" or (folder / f"{name}.csv").is_file()
            ),
        ]
    )


def find_results(studies: Studies, scale: str, root: str = RESULTS) -> Shows:
    """Return the results behind all tables, figures and claims that the page shows."""
    behind: Shows = {}
    for key, study in studies.items():
        parts = [
            jobs.find_results(study, name, scale) for name in list_artefacts(study, scale, root)
        ]
        if study.claims:
            parts.append(jobs.build_claims(study, scale).shows)
        for part in parts:
            for name, methods in part.items():
                # Another table or figure may show other methods of the same experiment.
                behind.setdefault(f"{key}/{name}", {}).update(methods)
    return behind


def build_page(studies: Studies, scale: str, root: str = RESULTS) -> Page:
    """Build the job that makes the page of a scale."""
    shown = {key: _describe_study(own, scale, root) for key, own in studies.items()}
    # The evidence comes from scale extended, whose own page has the results themselves.
    known = [
        key
        for key, own in studies.items()
        if scale != "extended" and evidence.is_of_project(own) and not shown[key].changes
    ]
    return Page(
        PageJob(scale, shown, known),
        sources=[*list_files(), *([*EVIDENCE, *PICTURES.values()] if known else [])],
        # The page reads none of them; its list of verified files has them.
        shows=find_results(studies, scale, root),
        code=[module for own in studies.values() for module in own.code_for("metrics")],
    )


def _describe_study(study: Study, scale: str, root: str) -> StudyView:
    """Return what the page needs to know of a study beside its results."""
    shown = {
        name: captions.build_caption(study, name, scale)
        for name in list_artefacts(study, scale, root)
    }
    methods = {
        name: MethodView(
            study.planner(name),
            study.resolve_settings(name),
            read_docstring(name_module(study.planner(name))),
        )
        for name in study.methods
    }
    answers = evidence.read_kept(study, "texts")
    return StudyView(
        title=study.title,
        paper=study.paper,
        labels=study.labels,
        methods=methods,
        claims={claim.id: claim for claim in study.claims},
        repeats=_count_repeats(study, scale),
        tables={
            name: (caption, study.tables[name])
            for name, caption in shown.items()
            if name in study.tables
        },
        figures={name: caption for name, caption in shown.items() if name in study.figures},
        assumptions=[
            dict(each) | {"default": find_default(study, each)} for each in study.assumptions
        ],
        files=[
            *(("claims", "claim_checks") if study.claims else ()),
            *(("audit",) if has_audit(study) else ()),
        ],
        changes=evidence.list_changes(study),
        answer=(answers[0]["title"], answers[0]["text"]) if answers else None,
    )


def has_audit(study: Study) -> bool:
    """Return whether a study has claims or published numbers."""
    return bool(study.claims or study.find_published_tables())


def _count_repeats(study: Study, scale: str) -> list[int]:
    """Return the least and the largest number of runs of a method under a condition."""
    counts = []
    for experiment in study.experiments.values():
        fewer = experiment.fewer.values() if scale == "extended" else ()
        counts += [experiment.repeats[scale], *(n for each in fewer for n in each.values())]
    return [min(counts), max(counts)]
