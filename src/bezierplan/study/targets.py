"""What Snakemake needs for a job: its input files, its params, and the files that make up a target.

Each function takes the studies by name, and the parts of a job's output path as keyword arguments:
scale, study, experiment, method, chunk, table, listing, figure, alternative. Paths are relative to
the working folder.

Params hold everything that determines what a job writes, and nothing else: names and values
(`study`), digests of the code that it calls, and digests of the content of maps and published
numbers. So timestamps of sources do not matter.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeVar

from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.jobs import AuditJob, ListingJob, MeasuredJob, PivotJob, SummaryJob
from bezierplan.analysis.table_kinds import Comparison, Layout, Pivot
from bezierplan.places import TREE
from bezierplan.running.digest import content_digest, module_of, versioned_digest
from bezierplan.running.inputs import BOUNDS, PROBLEMS, Files, named, of_experiments, part
from bezierplan.schema.model import plain
from bezierplan.study import alternatives, definition, design, jobs
from bezierplan.study.definition import Study

Studies = dict[str, Study]

SCRIPTS = TREE / "workflow" / "scripts"


_HIDDEN = {ord(sign): chr(0xE000 + ord(sign)) for sign in "<>&"}
"""Signs of markup -> characters for private use, which no text of a study contains: they cannot be
printed.
"""
_SHOWN = {ord(hidden): chr(sign) for sign, hidden in _HIDDEN.items()}


def hidden(param: Any) -> Any:
    """A param without signs of markup in its words: Snakemake prints params into the script of its
    report as they are, and a browser would run what they say.
    """
    return _translated(param, _HIDDEN)


def unhidden_params(params: Any) -> Any:
    """Snakemake's params of a job, with the words as they were before `hidden`."""
    return type(params)(toclone=params, custom_map=lambda param: _translated(param, _SHOWN))


def _translated(value: Any, table: dict[int, str]) -> Any:
    if isinstance(value, str):
        return value.translate(table)
    if isinstance(value, dict):
        return {_translated(key, table): _translated(each, table) for key, each in value.items()}
    return (
        type(value)(_translated(each, table) for each in value)
        if isinstance(value, list | tuple)
        else value
    )


def _folder(scale: str, study: str, alternative: str | None = None) -> str:
    return f"results/{scale}/{study}" + (f"/sensitivity/{alternative}" if alternative else "")


def _files(study: Study, scale: str, experiment: str, methods: Iterable[str] = ()) -> Files:
    """Files of an experiment: chunks of methods as configured, problems and bounds, no others."""
    folder = _folder(study.home(experiment, scale), study.key)
    runs = {
        method: [
            f"{folder}/runs/{experiment}/{method}/{chunk}.parquet"
            for chunk in jobs.chunks(study, experiment, method, scale)
        ]
        for method in methods
    }
    return Files(
        runs,
        f"{folder}/problems/{experiment}.parquet",
        f"{folder}/problems/{experiment}.bounds.parquet",
    )


def _published(study: Study, table: str) -> dict[str, str]:
    """The input file of a table's published numbers, if it has one."""
    file = study.published_file(table)
    return named("published", {Path(file).stem: file}) if file else {}


def _all_published(study: Study) -> dict[str, str]:
    """Input files of all published numbers, by table."""
    return named("published", {Path(file).stem: file for file in study.published_files()})


def _code(script: str, *modules: str | None) -> str:
    """Digest of a script with everything that it imports, and of modules that it imports by name,
    with versions of what computes.
    """
    return versioned_digest(str(SCRIPTS / f"{script}.py"), *filter(None, modules))


# --------------------------------------------------------------------------------------------------
# Problems and runs


def problems_params(studies: Studies, scale: str, study: str, experiment: str) -> dict:
    """Params of the job that builds the problems of an experiment."""
    job = jobs.problems_job(studies[study], experiment, scale)
    return {
        "job": job._asdict(),
        "folder": definition.relative(studies[study].folder),
        "maps": content_digest(*problem_maps(studies, scale, study, experiment)),
        "code": _code(
            "worlds" if studies[study].moves(experiment) else "problems",
            *_kinds_of_workspace(job.workspaces),
        ),
    }


def _kinds_of_workspace(workspaces: dict[str, dict]) -> list[str]:
    """Modules of the kinds of some workspaces, which are imported by name."""
    return sorted(
        {f"bezierplan.workspaces.kinds.{described['kind']}" for described in workspaces.values()}
    )


def problem_maps(studies: Studies, scale: str, study: str, experiment: str) -> list[str]:
    """Map files of an experiment."""
    return studies[study].maps(jobs.problems_job(studies[study], experiment, scale).workspaces)


def bounds_params(script: str) -> dict:
    """Params of the job that computes the bounds of problems, by its script."""
    return {"code": _code(script)}


def run_params(
    studies: Studies, scale: str, study: str, experiment: str, method: str, chunk: str
) -> dict:
    """Params of a chunk of runs."""
    return {
        "job": jobs.job(studies[study], experiment, method, scale, int(chunk)).plain(),
        "code": _code(
            "drives" if studies[study].moves(experiment) else "runs",
            module_of(studies[study].planner(method)),
        ),
    }


def moving(studies: Studies, moves: bool) -> dict[str, list[str]]:
    """The experiments whose runs are simulated drives, or the others, by study."""
    return {
        key: [name for name in study.experiments if study.moves(name) == moves]
        for key, study in studies.items()
    }


# --------------------------------------------------------------------------------------------------
# Tables and figures


def shown_by(study: Study, scale: str, artefact: str) -> dict[str, Files]:
    """Files of the experiments that a table or figure shows."""
    methods = {
        name: jobs.methods_of(study, artefact, name)
        for name in jobs.experiments_of(study, artefact)
    }
    return {name: _files(study, scale, name, shown) for name, shown in methods.items()}


def table_inputs(studies: Studies, scale: str, study: str, table: str) -> dict[str, Any]:
    """Input files of a table of runs."""
    return of_experiments(shown_by(studies[study], scale, table)) | _published(
        studies[study], table
    )


def table_params(studies: Studies, scale: str, study: str, table: str) -> dict:
    """Params of a table of runs."""
    return {
        "job": plain(_shown(studies[study], table, jobs.table_job(studies[study], table, scale))),
        "published": content_digest(*filter(None, [studies[study].published_file(table)])),
        "code": _code("table"),
    }


def listing_inputs(studies: Studies, scale: str, study: str, listing: str) -> dict[str, str]:
    """The file that a transcribed table shows, the comparison files of a comparison table, or all
    published files for a function.
    """
    spec, own = studies[study].tables[listing], studies[study]
    if isinstance(spec, Comparison):
        return named("published", {name: _comparison_file(scale, study, name) for name in spec.of})
    return _published(own, listing) or _all_published(own)


def _comparison_file(scale: str, study: str, table: str) -> str:
    return f"{_folder(scale, study)}/tables/{table}.comparison.csv"


def listing_params(studies: Studies, scale: str, study: str, listing: str) -> dict:
    """Params of a table without runs."""
    job, kind = jobs.listing_job(studies[study], listing), studies[study].tables[listing].kind
    sources = (
        [] if kind == "comparison" else listing_inputs(studies, scale, study, listing).values()
    )
    return {
        "job": plain(_shown(studies[study], listing, job)),
        "published": content_digest(*sources),
        "code": _code("listing", job.module if kind == "function" else None),
    }


def latex_inputs(studies: Studies, scale: str, study: str) -> dict[str, str]:
    """The tables of a study that are made at a scale."""
    return named(
        "tables",
        {
            name: f"{_folder(scale, study)}/tables/{name}.csv"
            for name in tables_of(studies[study], scale)
        },
    )


def tables_of(study: Study, scale: str) -> list[str]:
    """Names of the tables of a study that are made at a scale."""
    return [name for name in artefacts_of(study, scale) if name in study.tables]


def latex_params(studies: Studies, scale: str, study: str) -> dict:
    """Params of the tables of a study as LaTeX."""
    return {
        "captions": {
            name: jobs.caption(studies[study], name, scale)
            for name in tables_of(studies[study], scale)
        },
        "code": _code("latex"),
    }


def figure_inputs(studies: Studies, scale: str, study: str, figure: str) -> dict[str, Any]:
    """Input files of a figure: published numbers only for the kinds that draw them and the
    functions that ask for them.
    """
    published = (
        _all_published(studies[study]) if jobs.published_drawn(studies[study], figure) else {}
    )
    maps = {"maps": _maps_of_figure(studies[study], scale, figure)}
    return of_experiments(shown_by(studies[study], scale, figure)) | maps | published


def _maps_of_figure(study: Study, scale: str, figure: str) -> list[str]:
    return study.maps(jobs.figure_job(study, figure, scale).workspaces)


def narrow_inputs(studies: Studies, scale: str, study: str, figure: str) -> dict[str, Any]:
    """Input files of a figure on a sheet of one text column: what it draws, and the problems and
    map files that it is drawn on.
    """
    problems = {
        name: files.problems for name, files in shown_by(studies[study], scale, figure).items()
    }
    wide = {
        "data": f"{_folder(scale, study)}/figures/{figure}.csv",
        "maps": _maps_of_figure(studies[study], scale, figure),
    }
    return wide | named(PROBLEMS, problems)


def figure_params(studies: Studies, scale: str, study: str, figure: str) -> dict:
    """Params of a figure."""
    job = jobs.figure_job(studies[study], figure, scale)
    inputs = figure_inputs(studies, scale, study, figure)
    panels = studies[study].figures[figure].panels
    kinds = {f"bezierplan.figures.panels.{panel.kind}" for panel in panels}
    module = (
        studies[study].module() if any(getattr(panel, "data", None) for panel in panels) else None
    )
    again = {
        module_of(chunk.planner) for methods in job.chunks.values() for chunk in methods.values()
    }
    return {
        "job": plain(
            job._replace(
                labels=_labels(studies[study], figure),
                looks={
                    name: look
                    for name, look in job.looks.items()
                    if name in _shown_methods(studies[study], figure)
                },
            )
        ),
        "folder": definition.relative(studies[study].folder),
        "sources": content_digest(*inputs["maps"], *part(inputs, "published").values()),
        "code": _code(
            "figure", *sorted(kinds), module, *sorted(again), *_kinds_of_workspace(job.workspaces)
        ),
    }


def caption(
    studies: Studies, scale: str, study: str, table: str = "", listing: str = "", figure: str = ""
) -> str:
    """The report's caption of a table or figure, as reStructuredText; nothing from a study's files
    acts as markup.
    """
    return escaped(jobs.caption(studies[study], table or listing or figure, scale))


def escaped(text: str) -> str:
    """Text as one line of literal reStructuredText: no markup, no directive, no HTML."""
    return "".join(
        f"\\{sign}" if sign.isascii() and not sign.isalnum() and sign != " " else sign
        for sign in " ".join(text.split())
    )


J = TypeVar("J", PivotJob, ListingJob)


def _shown(study: Study, table: str, job: J) -> J:
    """The job of a table with the words that it prints: with its name for a title, which is in the
    caption alone, and without labels of items that it does not show.
    """
    return job._replace(spec=job.spec.but(title=table), labels=_labels(study, table))


def _shown_methods(study: Study, artefact: str) -> set[str]:
    """Methods that a figure can show: those of its experiments; all if it shows the table of a
    function, which may name any.
    """
    if any(hasattr(panel, "data") and panel.data for panel in study.figures[artefact].panels):
        return set(study.methods)
    return {
        method
        for experiment in jobs.experiments_of(study, artefact)
        for method in study.methods_of(experiment)
    }


def _labels(study: Study, artefact: str) -> dict[str, str]:
    """Labels, except those of methods, problems and workspaces that a table or figure cannot show.
    A function may name any.
    """
    spec = (study.tables.get(artefact) or study.figures[artefact]).plain()
    if spec.get("kind") in ("function", "comparison") or any(
        "data" in panel for panel in spec.get("panels", [])
    ):
        return study.labels
    shown = {panel["method"] for panel in spec.get("panels", []) if "method" in panel}
    for experiment in jobs.experiments_of(study, artefact):
        content = study.experiments[experiment]
        described = [study.problems[name] for name in content.problems]
        shown |= {
            *study.methods_of(experiment),
            *content.problems,
            *(problem.workspace for problem in described),
        }
        shown |= {problem.route for problem in described if problem.route}
        shown |= {str(value) for values in content.vary.values() for value in values}
    names = study.methods.keys() | study.problems.keys() | study.workspaces.keys()
    return {
        name: label for name, label in study.labels.items() if name in shown or name not in names
    }


# --------------------------------------------------------------------------------------------------
# Claims, audit, alternatives


def judged_by_claims(study: Study, scale: str) -> dict[str, Files]:
    """Files of the experiments that claims judge."""
    experiments = alternatives.experiments_of_claims(study.claims)
    return {
        name: _files(study, scale, name, study.experiments[name].methods) for name in experiments
    }


def claims_inputs(studies: Studies, scale: str, study: str) -> dict[str, Any]:
    """Input files of claims."""
    return of_experiments(judged_by_claims(studies[study], scale)) | _all_published(studies[study])


def claims_params(studies: Studies, scale: str, study: str) -> dict:
    """Params of claims."""
    own = studies[study]
    return {
        "job": plain(jobs.claims_job(own, own.claims, scale)),
        "published": content_digest(*own.published_files()),
        "code": _code("claims", own.module(), *_kinds(own.claims)),
    }


def _kinds(claims: list[Claim]) -> list[str]:
    """Modules of the kinds of check used in claims, which are imported by name."""
    return sorted(
        {
            f"bezierplan.analysis.claims.kinds.{check.test}"
            for claim in claims
            for check in claim.checks
        }
    )


def alternative_inputs(
    studies: Studies, scale: str, study: str, alternative: str
) -> dict[str, Any]:
    """Input files of an alternative: runs of the methods that it does not change."""
    primary = studies[study]
    claims = alternatives.headline_claims(primary, alternative)
    changed = alternatives.methods_changed(primary, alternative)
    methods = {
        name: alternatives.methods_of_claims(primary, claims, name)
        for name in alternatives.experiments_of_claims(claims)
    }
    files = {
        name: _files(primary, scale, name, [method for method in known if method not in changed])
        for name, known in methods.items()
    }
    return of_experiments(files) | _all_published(primary)


def alternative_params(studies: Studies, scale: str, study: str, alternative: str) -> dict:
    """Params of an alternative: `chunks`, numbers and jobs of the chunks that it changes."""
    content, tried = studies[study], alternatives.with_alternative(studies[study], alternative)
    claims = alternatives.headline_claims(content, alternative)
    changed = alternatives.methods_changed(content, alternative)
    chunks = [
        (number, design.judged_only(jobs.job(tried, experiment, method, scale, number), claims))
        for experiment in alternatives.experiments_of_claims(claims)
        for method in alternatives.methods_of_claims(content, claims, experiment)
        if method in changed
        for number in jobs.chunks(content, experiment, method, scale)
    ]
    planners = sorted({module_of(chunk.planner) for _, chunk in chunks})
    return {
        "chunks": [[number, chunk.plain()] for number, chunk in chunks],
        "job": plain(
            jobs.claims_job(
                content, alternatives.claims_tried(content, alternative), scale, primary_alone=True
            )
        ),
        "published": content_digest(*content.published_files()),
        "code": _code("alternative", content.module(), *_kinds(claims), *planners),
    }


def _audited(study: Study) -> dict[str, Pivot]:
    """Tables of published numbers, by the name of their file."""
    return {
        Path(table.published).stem: table for table in study.compared().values() if table.published
    }


def audit_inputs(studies: Studies, scale: str, study: str) -> dict[str, str]:
    """Input files of the audit."""
    tables = _audited(studies[study]).values()
    # Printed lengths are sought among those of paths of their problems.
    sought = {table.experiment for table in tables if table.identify}
    experiments = sorted({table.experiment for table in tables})
    files = {name: _files(studies[study], scale, name) for name in experiments}
    bounds = named(BOUNDS, {name: each.bounds for name, each in files.items()})
    problems = named(
        PROBLEMS, {name: each.problems for name, each in files.items() if name in sought}
    )
    return bounds | problems | _all_published(studies[study])


def audit_params(studies: Studies, scale: str, study: str) -> dict:
    """Params of the audit."""
    content, tables = studies[study], _audited(studies[study])
    job = AuditJob(
        study,
        content.module(),
        {name: table.experiment for name, table in tables.items()},
        {name: table.primary for name, table in tables.items()},
        {name: Layout.of(table) for name, table in tables.items()},
    )
    return {
        "job": plain(job),
        "published": content_digest(*content.published_files()),
        "code": _code("audit", content.module()),
    }


def sensitivity_inputs(studies: Studies, scale: str, study: str) -> dict[str, str]:
    """Input files of the table of alternatives."""
    tried = {
        name: f"{_folder(scale, study, name)}/claims.csv"
        for name in alternatives.tried(studies[study])
    }
    return {"claims": f"{_folder(scale, study)}/claims.csv"} | named("alternatives", tried)


def sensitivity_params(studies: Studies, scale: str, study: str) -> dict:
    """Params of the table of alternatives."""
    return {
        "described": plain(alternatives.alternatives_described(studies[study])),
        "code": _code("sensitivity"),
    }


# --------------------------------------------------------------------------------------------------
# All studies together


def published_tables(studies: Studies) -> dict[tuple[str, str], Pivot]:
    """The tables compared with published numbers, by study and table."""
    return {
        (key, name): table
        for key, study in studies.items()
        for name, table in study.compared().items()
        if table.published
    }


def comparison_files(studies: Studies, scale: str) -> dict[tuple[str, str], str]:
    """The comparison of each table with published numbers, by study and table."""
    return {
        (study, table): _comparison_file(scale, study, table)
        for study, table in published_tables(studies)
    }


def summary_inputs(studies: Studies, scale: str) -> dict[str, Any]:
    """Input files of the summary."""
    claims = {
        key: f"{_folder(scale, key)}/claims.csv" for key, study in studies.items() if study.claims
    }
    comparisons = {
        f"{study}/{table}": file
        for (study, table), file in comparison_files(studies, scale).items()
    }
    return (
        named("comparisons", comparisons)
        | named("claims", claims)
        | {"baseline_comparison": f"results/{scale}/baseline_comparison.csv"}
    )


def summary_params(studies: Studies, scale: str) -> dict:
    """Params of the summary."""
    titles = {key: study.title for key, study in studies.items()}
    job = SummaryJob([*published_tables(studies)], titles)
    return {"job": plain(job), "code": _code("summary")}


def baseline_comparison_inputs(studies: Studies, scale: str) -> dict[str, Any]:
    """Input files of the comparison with the baseline: experiments by study and name."""
    return of_experiments(
        {
            f"{key}/{name}": _files(
                study, scale, name, [*study.experiments[name].methods, measured.baseline]
            )
            for key, study in studies.items()
            if (measured := study.baseline_comparison)
            for name in measured.experiments
        }
    )


def baseline_comparison_params(studies: Studies, scale: str) -> dict:
    """Params of the comparison with the baseline: `job`, study -> baseline, and experiment ->
    repeats."""
    job = {
        key: MeasuredJob(
            measured.baseline,
            {name: study.experiments[name].repeats[scale] for name in measured.experiments},
        )
        for key, study in studies.items()
        if (measured := study.baseline_comparison)
    }
    return {"job": plain(job), "code": _code("baseline_comparison")}


# --------------------------------------------------------------------------------------------------
# Targets


def files_of(studies: Studies, scale: str, study: str, name: str) -> list[str]:
    """The files of a table or figure."""
    if name in studies[study].tables:
        endings = (".csv", ".comparison.csv") if name in studies[study].compared() else (".csv",)
        return [f"{_folder(scale, study)}/tables/{name}{ending}" for ending in endings]
    return [
        f"{_folder(scale, study)}/figures/{name}{ending}"
        for ending in (".svg", ".png", ".pdf", ".csv", ".txt")
    ]


def artefacts_of(study: Study, scale: str) -> list[str]:
    """Tables and figures of a study that are made at a scale: at `extended` those that differ from
    what they are at `full`.
    """
    made = [*study.tables, *study.figures]
    if scale != "extended":
        return made
    return [
        name
        for name in made
        if any(
            study.home(experiment, scale) == scale
            for experiment in _experiments_behind(study, name)
        )
    ]


def _experiments_behind(study: Study, artefact: str) -> list[str]:
    """Names of the experiments that a table or figure shows, for a table of comparisons those of
    the tables that it compares.
    """
    spec = study.tables.get(artefact)
    if isinstance(spec, Comparison):
        return [experiment for name in spec.of for experiment in jobs.experiments_of(study, name)]
    return jobs.experiments_of(study, artefact)


def files_of_narrow(studies: Studies, scale: str) -> list[str]:
    """All figures of a scale, each on a sheet of one text column."""
    return [
        f"{_folder(scale, key)}/figures/{name}.narrow{ending}"
        for key, study in studies.items()
        for name in artefacts_of(study, scale)
        if name in study.figures
        for ending in (".svg", ".pdf")
    ]


def files_of_study(studies: Studies, scale: str, study: str) -> list[str]:
    """All tables and figures of a study that are made at a scale, its claims, and its audit if it
    has claims or published numbers.
    """
    files = [
        file
        for name in artefacts_of(studies[study], scale)
        for file in files_of(studies, scale, study, name)
    ]
    if tables_of(studies[study], scale):
        files.append(f"{_folder(scale, study)}/tables.tex")
    if studies[study].claims:
        files.append(f"{_folder(scale, study)}/claims.csv")
    if studies[study].claims or _audited(studies[study]):
        files.append(f"{_folder(scale, study)}/audit.csv")
    return files


def files_of_scale(studies: Studies, scale: str) -> list[str]:
    """Everything that is made at a scale; a summary if some table has published numbers."""
    files = [file for study in studies for file in files_of_study(studies, scale, study)]
    return files + ([f"results/{scale}/summary.md"] if published_tables(studies) else [])


def files_of_sensitivity(studies: Studies, scale: str) -> list[str]:
    """The table of alternatives of each study that has any."""
    return [
        f"{_folder(scale, key)}/sensitivity.csv"
        for key, study in studies.items()
        if alternatives.tried(study)
    ]


def files_of_smoke(studies: Studies) -> list[str]:
    """The small subset."""
    artefacts, methods = jobs.smoke(studies)
    files = [file for study, name in artefacts for file in files_of(studies, "smoke", study, name)]
    return files + [
        f"{_folder('smoke', study)}/runs/{experiment}/{method}/0.parquet"
        for study, experiment, method in methods
    ]
