"""What the page of a scale shows: its input files, its params, and the file itself."""

from pathlib import Path
from typing import Any

from bezierplan.figures import page
from bezierplan.figures.page.page_job import (
    AssumptionShown,
    ExperimentShown,
    FigureShown,
    MethodShown,
    PageJob,
    PaperCited,
    StudyShown,
    TableShown,
)
from bezierplan.places import STUDIES, TREE
from bezierplan.running.digest import content_digest, versioned_digest
from bezierplan.running.inputs import Files
from bezierplan.schema import checked
from bezierplan.schema.model import plain
from bezierplan.study import jobs, targets
from bezierplan.study.artefacts import in_printed_order
from bezierplan.study.claims import Assumption
from bezierplan.study.definition import Study
from bezierplan.study.targets import Studies

_END = b"</html>"


def file(scale: str) -> str:
    """The page of a scale."""
    return f"results/{scale}/index.html"


def is_whole(page_file: Path) -> bool:
    """Whether a page ends as it should: one cut short is as new as its inputs, and would stay."""
    with page_file.open("rb") as content:
        content.seek(max(0, page_file.stat().st_size - len(_END) - 2))
        return content.read().strip().endswith(_END)


def inputs(studies: Studies, scale: str) -> dict[str, list[str]]:
    """Input files of the page: everything that is made at the scale, and the runs behind it."""
    made = _made(studies, scale, _artefacts(studies, scale))
    tables = (
        [f"results/{scale}/{name}.csv" for name in ("numbers", "claims", "baseline_comparison")]
        if _summary(scale) in made
        else []
    )
    return {
        "made": made,
        "summary": tables,
        "verified": [f"results/{scale}/verified.json"],
    } | _shown(studies, scale)


def _shown(studies: Studies, scale: str) -> dict[str, list[str]]:
    """Files of all runs that the page shows, with their problems, bounds and traces."""
    shown: dict[str, list[str]] = {"runs": [], "problems": [], "bounds": [], "traces": []}
    for key, names in _artefacts(studies, scale).items():
        for experiment, files in _experiments_behind(studies, scale, key, names).items():
            shown["runs"] += files.chunks
            shown["problems"].append(files.problems)
            shown["bounds"].append(files.bounds)
            shown["traces"] += _traces(studies[key], experiment, files)
    return shown


def verified_inputs(studies: Studies, scale: str) -> dict[str, list[str]]:
    """Input files of the check of all runs and bounds that the page shows."""
    return _shown(studies, scale)


def verified_params(studies: Studies, scale: str, root: str = "") -> dict[str, Any]:
    """Params of the check: `job`, for each experiment its files of problems, of bounds and of the
    runs that the page shows. root: as in `params`.
    """
    job = [
        [root + files.problems, root + files.bounds, [root + file for file in files.chunks]]
        for key, names in _artefacts(studies, scale).items()
        for files in _experiments_behind(studies, scale, key, names).values()
    ]
    return {"job": job, "code": versioned_digest(str(targets.SCRIPTS / "verified.py"))}


def params(studies: Studies, scale: str, root: str = "") -> dict[str, Any]:
    """Params of the page. Alternatives are shown if they have been tried: the page does not ask for
    them.

    root: what stands before the paths of results, with the slash at its end, in a workflow of which
    this one is a module.
    """
    tried = {key: _tried(f"{root}results/{scale}/{key}") for key in studies}
    shown, outcome = _artefacts(studies, scale), _outcome(studies, scale)
    return {
        "job": plain(
            PageJob(
                scale,
                {
                    key: _study(studies, scale, key, names, tried[key], root)
                    for key, names in shown.items()
                },
                outcome=bool(outcome),
            )
        ),
        "tried": content_digest(*(file for files in tried.values() for file in files.values())),
        "look": content_digest(*page.files()),
        "outcome": content_digest(*outcome),
        "code": versioned_digest(str(targets.SCRIPTS / "page.py")),
    }


def _outcome(studies: Studies, scale: str) -> list[str]:
    """Files of the README's outcome, which the page of scale full shows next to its own, in a clone
    that has them; none if it shows none of the papers.
    """
    papers = any(study.folder.resolve().is_relative_to(STUDIES) for study in studies.values())
    shown = scale == "full" and papers and all(file.is_file() for file in page.OUTCOME)
    return [*map(str, page.OUTCOME)] if shown else []


def _tried(folder: str) -> dict[str, str]:
    """Tables of a study that are made only if asked for."""
    file = f"{folder}/sensitivity.csv"
    return {"sensitivity": file} if Path(file).is_file() else {}


def _artefacts(studies: Studies, scale: str) -> dict[str, list[str]]:
    """By study, the names of the tables and figures of a scale, also of a table that is as at
    `full` if the summary counts it.
    """
    if scale == "smoke":
        made = jobs.smoke(studies)[0]
        return {
            key: in_printed_order([name for study, name in made if study == key]) for key in studies
        }
    counted = (
        set(targets.comparison_files(studies, scale).values())
        if _summary(scale) in targets.files_of_scale(studies, scale)
        else set()
    )
    return {
        key: [
            name
            for name in in_printed_order([*study.tables, *study.figures])
            if name in targets.artefacts_of(study, scale)
            or counted.intersection(targets.files_of(studies, scale, key, name))
        ]
        for key, study in studies.items()
    }


def _summary(scale: str) -> str:
    return f"results/{scale}/summary.md"


def _made(studies: Studies, scale: str, shown: dict[str, list[str]]) -> list[str]:
    files = [
        each
        for study, names in shown.items()
        for name in names
        for each in targets.files_of(studies, scale, study, name)
    ]
    return (
        files
        if scale == "smoke"
        else list(dict.fromkeys([*targets.files_of_scale(studies, scale), *files]))
    )


def _experiments_behind(
    studies: Studies, scale: str, key: str, names: list[str]
) -> dict[str, Files]:
    """Files of the experiments behind some tables and figures of a study and its claims, with the
    methods that these show.
    """
    shown = [targets.shown_by(studies[key], scale, name) for name in names]
    if scale != "smoke" and studies[key].claims:
        shown.append(targets.judged_by_claims(studies[key], scale))
    behind: dict[str, Files] = {}
    for experiments in shown:
        for name, files in experiments.items():
            behind[name] = files._replace(
                runs=(behind[name].runs if name in behind else {}) | files.runs
            )
    return behind


def _traces(study: Study, experiment: str, files: Files) -> list[str]:
    """Traces of the runs of an experiment, if these are drives."""
    return (
        [str(Path(chunk).with_suffix(".traces.parquet")) for chunk in files.chunks]
        if study.moves(experiment)
        else []
    )


def _study(
    studies: Studies, scale: str, key: str, made: list[str], tried: dict[str, str], root: str
) -> StudyShown:
    """What the page needs of a study beside its results. made: names of its tables and figures."""
    study, folder = studies[key], f"{root}results/{scale}/{key}"
    judged = scale != "smoke" and study.claims
    files = (
        {"claims": f"{folder}/claims.csv", "checks": f"{folder}/claim_checks.csv"} if judged else {}
    )
    audit = f"{folder}/audit.csv"
    files |= (
        {"audit": audit}
        if scale != "smoke" and audit in targets.files_of_study(studies, scale, key)
        else {}
    )
    tables = {name: study.tables[name] for name in made if name in study.tables}
    figures = {name: study.figures[name] for name in made if name in study.figures}
    return StudyShown(
        title=study.title,
        paper=_paper(key),
        labels=study.labels,
        methods={
            name: MethodShown(study.planner(name), study.resolved(name)) for name in study.methods
        },
        checks={claim.id: claim.checks for claim in study.claims} if judged else {},
        repeats={each: _repeats(study, each) for each in (scale, "extended")},
        tables={
            name: TableShown(table.title, jobs.caption(study, name, scale), table)
            for name, table in tables.items()
        },
        figures={
            name: FigureShown(figure.title, jobs.caption(study, name, scale))
            for name, figure in figures.items()
        },
        assumptions=[_assumption(each) for each in study.assumptions],
        files=files | (tried if judged else {}),
        latex=f"{key}/tables.tex" if scale != "smoke" and targets.tables_of(study, scale) else "",
        experiments=_experiments(studies, scale, key, made, root),
    )


def _assumption(assumption: Assumption) -> AssumptionShown:
    return AssumptionShown(**{name: getattr(assumption, name) for name in AssumptionShown._fields})


def _repeats(study: Study, scale: str) -> list[int]:
    """The least and the largest number of runs of a method under a condition."""
    counts = [experiment.repeats[scale] for experiment in study.experiments.values()]
    if scale == "extended":
        counts += [
            count
            for experiment in study.experiments.values()
            for fewer in experiment.fewer.values()
            for count in fewer.values()
        ]
    return [min(counts), max(counts)] if counts else []


def _paper(key: str) -> PaperCited | None:
    """The paper of a study, as CITATION.cff cites it: its entry's notes begin with the study's
    name. None for any other study.
    """
    file = TREE / "CITATION.cff"
    cited = checked.read(file)["references"] if file.is_file() else []
    entry = next(
        (each for each in cited if each.get("notes", "").split(":")[0].strip() == key), None
    )
    if entry is None:
        return None
    where = ", ".join(str(entry[name]) for name in ("journal", "year") if name in entry)
    return PaperCited(entry["title"], where, entry.get("doi"))


def _experiments(
    studies: Studies, scale: str, key: str, made: list[str], root: str
) -> dict[str, ExperimentShown]:
    """The experiments whose runs the page shows: methods but baselines, repeats, and files."""
    study, experiments = studies[key], {}
    for name, files in _experiments_behind(studies, scale, key, made).items():
        if files.chunks:
            experiments[name] = ExperimentShown(
                [method for method in study.methods_of(name) if method not in study.baselines],
                study.experiments[name].repeats[scale],
                [f"{root}{chunk}" for chunk in files.chunks],
                f"{root}{files.problems}",
                f"{root}{files.bounds}",
                [f"{root}{trace}" for trace in _traces(study, name, files)],
            )
    return experiments
