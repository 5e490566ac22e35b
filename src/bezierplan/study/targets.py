"""What Snakemake needs for a job: its input files, its params, and the files that make up a target.

Each function takes the studies by name, and the parts of a job's output path as keyword arguments: scale, study, experiment, method, chunk,
table, listing, figure, alternative. Paths are relative to the working folder.

Params hold everything that determines what a job writes, and nothing else: names and values (`study`), digests of the code that it
calls, and digests of the content of maps and published numbers. So timestamps of sources do not matter.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from bezierplan.analysis.claims.claim import Claim
from bezierplan.places import TREE
from bezierplan.running.digest import content_digest, versioned_digest
from bezierplan.study import alternatives, choices, definition, design, jobs
from bezierplan.study.artefacts import Comparison, Pivot
from bezierplan.study.definition import Study

Studies = dict[str, Study]

SCRIPTS = TREE / "workflow" / "scripts"


_HIDDEN = {ord(sign): chr(0xE000 + ord(sign)) for sign in "<>&"}
"""Signs of markup -> characters for private use, which no text of a study contains: they cannot be printed."""
_SHOWN = {ord(hidden): chr(sign) for sign, hidden in _HIDDEN.items()}


def hidden(param: Any) -> Any:
    """A param without signs of markup in its words: Snakemake prints params into the script of its report as they are, and a browser would
    run what they say.
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
    return type(value)(_translated(each, table) for each in value) if isinstance(value, list | tuple) else value


def _folder(scale: str, study: str, alternative: str | None = None) -> str:
    return f"results/{scale}/{study}" + (f"/sensitivity/{alternative}" if alternative else "")


def _chunks(study: Study, scale: str, experiment: str, methods: Iterable[str]) -> list[str]:
    """Chunk files of an experiment's methods as configured, whatever else the folder contains."""
    folder = f"{_folder(study.home(experiment, scale), study.key)}/runs/{experiment}"
    return [f"{folder}/{method}/{chunk}.parquet" for method in methods for chunk in jobs.chunks(study, experiment, scale)]


def _problems(study: Study, scale: str, experiments: Iterable[str]) -> list[str]:
    return [f"{_folder(study.home(name, scale), study.key)}/problems/{name}.parquet" for name in experiments]


def _bounds(study: Study, scale: str, experiments: Iterable[str]) -> list[str]:
    return [f"{_folder(study.home(name, scale), study.key)}/problems/{name}.bounds.parquet" for name in experiments]


def _code(script: str, *modules: str | None) -> str:
    """Digest of a script with everything that it imports, and of modules that it imports by name, with versions of what computes."""
    return versioned_digest(str(SCRIPTS / f"{script}.py"), *filter(None, modules))


def _planner(planner: str) -> str:
    """A planner as an argument of `source_digest`."""
    return planner if planner.endswith(".py") else f"bezierplan.planners.{planner}"


# ---------------------------------------------------------------------------------------------------------------------
# Problems and runs


def problems_params(given: Studies, scale: str, study: str, experiment: str) -> dict:
    """Params of the job that builds the problems of an experiment."""
    job = jobs.problems_job(given[study], experiment, scale)
    return {
        "job": job,
        "folder": definition.relative(given[study].folder),
        "maps": content_digest(*problem_maps(given, scale, study, experiment)),
        "code": _code("worlds" if given[study].moves(experiment) else "problems", *_kinds_of_workspace(job)),
    }


def _kinds_of_workspace(job: dict) -> list[str]:
    """Modules of the kinds of a job's workspaces, which are imported by name."""
    return sorted({f"bezierplan.workspaces.kinds.{described['kind']}" for described in job["workspaces"].values()})


def problem_maps(given: Studies, scale: str, study: str, experiment: str) -> list[str]:
    """Map files of an experiment."""
    return given[study].maps(jobs.problems_job(given[study], experiment, scale)["workspaces"])


def bounds_params(script: str) -> dict:
    """Params of the job that computes the bounds of problems, by its script."""
    return {"code": _code(script)}


def run_params(given: Studies, scale: str, study: str, experiment: str, method: str, chunk: str) -> dict:
    """Params of a chunk of runs."""
    return {
        "job": jobs.job(given[study], experiment, method, scale, int(chunk)),
        "code": _code("drives" if given[study].moves(experiment) else "runs", _planner(given[study].planner(method))),
    }


def drives(given: Studies, scale: str, study: str, experiment: str) -> list[str]:
    """All drives of an experiment."""
    return _chunks(given[study], scale, experiment, given[study].methods_of(experiment))


def clairvoyant_params(given: Studies, scale: str, study: str, experiment: str) -> dict:
    """Params of the job that computes the bounds of problems whose worlds move."""
    return {"repeats": given[study].experiments[experiment].repeats[scale], "code": _code("clairvoyant")}


def moving(given: Studies, moves: bool) -> dict[str, list[str]]:
    """The experiments whose runs are simulated drives, or the others, by study."""
    return {key: [name for name in study.experiments if study.moves(name) == moves] for key, study in given.items()}


# ---------------------------------------------------------------------------------------------------------------------
# Tables and figures


def artefact_inputs(given: Studies, scale: str, study: str, table: str = "", figure: str = "") -> dict[str, list[str]]:
    """Runs, problems and bounds that a table or figure shows."""
    name, own = table or figure, given[study]
    experiments = jobs.experiments_of(own, name)
    return {
        "runs": [file for experiment in experiments for file in _chunks(own, scale, experiment, jobs.methods_of(own, name, experiment))],
        "problems": _problems(own, scale, experiments),
        "bounds": _bounds(own, scale, experiments),
    }


def table_inputs(given: Studies, scale: str, study: str, table: str) -> dict[str, str | list[str]]:
    """Input files of a table of runs."""
    return artefact_inputs(given, scale, study, table=table) | {"published": given[study].published_file(table) or []}


def table_params(given: Studies, scale: str, study: str, table: str) -> dict:
    """Params of a table of runs."""
    return {
        "job": _shown(given[study], table, jobs.table_job(given[study], table, scale)),
        "published": content_digest(*filter(None, [given[study].published_file(table)])),
        "code": _code("table"),
    }


def listing_published(given: Studies, scale: str, study: str, listing: str) -> list[str]:
    """The file that a transcribed table shows, the comparison files of a comparison table, or all published files for a function."""
    spec, own = given[study].tables[listing], given[study]
    if spec.kind == "comparison":
        return [f"{_folder(scale, study)}/tables/{name}.comparison.csv" for name in spec.of]
    file = own.published_file(listing)
    return [file] if file else own.published_files()


def listing_params(given: Studies, scale: str, study: str, listing: str) -> dict:
    """Params of a table without runs."""
    job, kind = jobs.listing_job(given[study], listing), given[study].tables[listing].kind
    sources = [] if kind == "comparison" else listing_published(given, scale, study, listing)
    return {
        "job": _shown(given[study], listing, job),
        "published": content_digest(*sources),
        "code": _code("listing", job["module"] if kind == "function" else None),
    }


def latex_inputs(given: Studies, scale: str, study: str) -> dict[str, list[str]]:
    """The tables of a study that are made at a scale."""
    names = [name for name in artefacts_of(given[study], scale) if name in given[study].tables]
    return {"tables": [f"{_folder(scale, study)}/tables/{name}.csv" for name in names]}


def latex_params(given: Studies, scale: str, study: str) -> dict:
    """Params of the tables of a study as LaTeX."""
    names = [Path(file).stem for file in latex_inputs(given, scale, study)["tables"]]
    return {"captions": {name: jobs.caption(given[study], name, scale) for name in names}, "code": _code("latex")}


def figure_inputs(given: Studies, scale: str, study: str, figure: str) -> dict[str, list[str]]:
    """Input files of a figure: published numbers only for the kinds that draw them and the functions that ask for them."""
    drawn = jobs.published_drawn(given[study], figure)
    bare = jobs.figure_job(given[study], figure, scale)["workspaces"]
    sources = {"maps": given[study].maps(bare), "published": given[study].published_files() if drawn else []}
    return artefact_inputs(given, scale, study, figure=figure) | sources


def narrow_inputs(given: Studies, scale: str, study: str, figure: str) -> dict[str, str | list[str]]:
    """Input files of a figure on a sheet of one text column: what it draws, and the problems and map files that it is drawn on."""
    wide = figure_inputs(given, scale, study, figure)
    return {"data": f"{_folder(scale, study)}/figures/{figure}.csv", "problems": wide["problems"], "maps": wide["maps"]}


def figure_params(given: Studies, scale: str, study: str, figure: str) -> dict:
    """Params of a figure."""
    job, inputs = jobs.figure_job(given[study], figure, scale), figure_inputs(given, scale, study, figure)
    panels = job["spec"]["panels"]
    kinds = {f"bezierplan.figures.panels.{panel['kind']}" for panel in panels}
    module = given[study].module() if any("data" in panel for panel in panels) else None
    again = {_planner(each["planner"]) for methods in job["jobs"].values() for each in methods.values()}
    return {
        "job": _shown(given[study], figure, job),
        "folder": definition.relative(given[study].folder),
        "sources": content_digest(*inputs["maps"], *inputs["published"]),
        "code": _code("figure", *sorted(kinds), module, *sorted(again), *_kinds_of_workspace(job)),
    }


def caption(given: Studies, scale: str, study: str, table: str = "", listing: str = "", figure: str = "") -> str:
    """The report's caption of a table or figure, as reStructuredText; nothing from a study's files acts as markup."""
    return escaped(jobs.caption(given[study], table or listing or figure, scale))


def escaped(text: str) -> str:
    """Text as one line of literal reStructuredText: no markup, no directive, no HTML."""
    return "".join(f"\\{sign}" if sign.isascii() and not sign.isalnum() and sign != " " else sign for sign in " ".join(text.split()))


def _shown(study: Study, artefact: str, job: dict) -> dict:
    """The job of a table or figure with the words that it prints: without its title, which is in the caption, and without labels of items
    that it does not show.
    """
    spec = {key: value for key, value in job["spec"].items() if key != "title"}
    shown = job | {"spec": spec, "labels": _labels(study, artefact)}
    if "looks" in job:
        methods = _shown_methods(study, artefact)
        shown["looks"] = {name: look for name, look in job["looks"].items() if name in methods}
    return shown


def _shown_methods(study: Study, artefact: str) -> set[str]:
    """Methods that a figure can show: those of its experiments; all if it shows the table of a function, which may name any."""
    if any(hasattr(panel, "data") and panel.data for panel in study.figures[artefact].panels):
        return set(study.methods)
    return {method for experiment in jobs.experiments_of(study, artefact) for method in study.methods_of(experiment)}


def _labels(study: Study, artefact: str) -> dict[str, str]:
    """Labels, except those of methods, problems and workspaces that a table or figure cannot show. A function may name any."""
    spec = (study.tables.get(artefact) or study.figures[artefact]).plain()
    if spec.get("kind") in ("function", "comparison") or any("data" in panel for panel in spec.get("panels", [])):
        return study.labels
    shown = {panel["method"] for panel in spec.get("panels", []) if "method" in panel}
    for experiment in jobs.experiments_of(study, artefact):
        content = study.experiments[experiment]
        described = [study.problems[name] for name in content.problems]
        shown |= {*study.methods_of(experiment), *content.problems, *(problem.workspace for problem in described)}
        shown |= {problem.route for problem in described if problem.route}
        shown |= {str(value) for values in content.vary.values() for value in values}
    names = study.methods.keys() | study.problems.keys() | study.workspaces.keys()
    return {name: label for name, label in study.labels.items() if name in shown or name not in names}


# ---------------------------------------------------------------------------------------------------------------------
# Claims, audit, alternatives


def claims_inputs(given: Studies, scale: str, study: str) -> dict[str, list[str]]:
    """Input files of claims."""
    own = given[study]
    experiments = alternatives.experiments_of_claims(own.claims)
    runs = [file for name in experiments for file in _chunks(own, scale, name, own.experiments[name].methods)]
    return {"runs": runs} | _judged_with(own, scale, experiments)


def _judged_with(study: Study, scale: str, experiments: list[str]) -> dict[str, list[str]]:
    problems, bounds = _problems(study, scale, experiments), _bounds(study, scale, experiments)
    return {"problems": problems, "bounds": bounds, "published": study.published_files()}


def claims_params(given: Studies, scale: str, study: str) -> dict:
    """Params of claims."""
    own = given[study]
    return {
        "job": _claims_job(own, scale, own.claims, primary_alone=False),
        "published": content_digest(*own.published_files()),
        "code": _code("claims", own.module(), *_kinds(own.claims)),
    }


def _kinds(claims: list[Claim]) -> list[str]:
    """Modules of the kinds of check used in claims, which are imported by name."""
    return sorted({f"bezierplan.analysis.claims.kinds.{check.test}" for claim in claims for check in claim.checks})


def _claims_job(study: Study, scale: str, claims: list[Claim], primary_alone: bool) -> dict:
    job = jobs.claims_job(study, claims, primary_alone)
    artefacts = {name: {key: value for key, value in spec.items() if key != "title"} for name, spec in job["artefacts"].items()}
    return job | {"artefacts": artefacts, "repeats": {name: study.experiments[name].repeats[scale] for name in job["paired"]}}


def alternative_inputs(given: Studies, scale: str, study: str, alternative: str) -> dict[str, list[str]]:
    """Input files of an alternative: runs of the methods that it does not change."""
    own = given[study]
    claims, changed = alternatives.headline_claims(own, alternative), alternatives.methods_changed(own, alternative)
    experiments = alternatives.experiments_of_claims(claims)
    runs = []
    for experiment in experiments:
        methods = alternatives.methods_of_claims(own, claims, experiment)
        runs += _chunks(own, scale, experiment, [name for name in methods if name not in changed])
    return {"runs": runs} | _judged_with(own, scale, experiments)


def alternative_params(given: Studies, scale: str, study: str, alternative: str) -> dict:
    """Params of an alternative: `chunks`, the jobs of the runs that it changes, keyed by output file."""
    own, tried = given[study], alternatives.with_alternative(given[study], alternative)
    claims, changed = alternatives.headline_claims(own, alternative), alternatives.methods_changed(own, alternative)
    chunks = {
        f"{experiment}/{method}/{chunk}.parquet": design.judged_only(jobs.job(tried, experiment, method, scale, chunk), claims)
        for experiment in alternatives.experiments_of_claims(claims)
        for method in alternatives.methods_of_claims(own, claims, experiment)
        if method in changed
        for chunk in jobs.chunks(own, experiment, scale)
    }
    planners = sorted({_planner(job["planner"]) for job in chunks.values()})
    return {
        "chunks": chunks,
        "job": _claims_job(own, scale, alternatives.claims_tried(own, alternative), primary_alone=True),
        "published": content_digest(*own.published_files()),
        "code": _code("alternative", own.module(), *_kinds(claims), *planners),
    }


def _audited(study: Study) -> dict[str, Pivot]:
    """Tables of published numbers, by the stem of their file."""
    return {Path(table.published).stem: table for table in study.compared().values() if table.published}


def _layout(table: Pivot) -> dict:
    """What the audit needs to know of a table: columns within whose values rows are ranked, metrics of only some runs, required orders,
    and whether its workspaces were fitted to it.
    """
    return {
        "columns": [name for name in table.columns if name not in ("value", "statistic")],
        "selected": sorted({entry.metric for entry in table.values if entry.where}),
        "monotone": [rule.plain() for rule in table.monotone],
        "fitted": table.fitted,
        "identify": [entry.plain() for entry in table.identify],
    }


def _audited_experiments(study: Study) -> list[str]:
    return sorted({table.experiment for table in _audited(study).values()})


def audit_inputs(given: Studies, scale: str, study: str) -> dict[str, list[str]]:
    """Input files of the audit."""
    own, experiments = given[study], _audited_experiments(given[study])
    found = {"bounds": _bounds(own, scale, experiments), "published": own.published_files()}
    return found | {"problems": _problems(own, scale, [name for name in experiments if _identifies(own, name)])}


def _identifies(study: Study, experiment: str) -> bool:
    """Whether printed lengths are sought among those of paths of an experiment's problems."""
    return any(table.identify and table.experiment == experiment for table in _audited(study).values())


def audit_params(given: Studies, scale: str, study: str) -> dict:
    """Params of the audit."""
    own = given[study]
    return {
        "job": {
            "study": study,
            "module": own.module(),
            "tables": {name: table.experiment for name, table in _audited(own).items()},
            "primary": {name: table.primary for name, table in _audited(own).items()},
            "layouts": {name: _layout(table) for name, table in _audited(own).items()},
            "experiments": _audited_experiments(own),
            "identified": [name for name in _audited_experiments(own) if _identifies(own, name)],
        },
        "published": content_digest(*own.published_files()),
        "code": _code("audit", own.module()),
    }


def sensitivity_inputs(given: Studies, scale: str, study: str) -> dict[str, str | list[str]]:
    """Input files of the table of alternatives."""
    tried = alternatives.tried(given[study])
    return {
        "claims": f"{_folder(scale, study)}/claims.csv",
        "alternatives": [f"{_folder(scale, study, name)}/claims.csv" for name in tried],
    }


def sensitivity_params(given: Studies, scale: str, study: str) -> dict:
    """Params of the table of alternatives."""
    return {"described": alternatives.alternatives_described(given[study]), "code": _code("sensitivity")}


def interpretations_inputs(given: Studies, scale: str, study: str) -> dict[str, list[str]]:
    """Input files of the search for an interpretation, which makes problems and runs of its own."""
    own = given[study]
    return {"maps": choices.maps(own), "published": [own.published_file(name) for name in choices.printed_tables(own)]}


def interpretations_params(given: Studies, scale: str, study: str) -> dict:
    """Params of the search for an interpretation."""
    job = choices.search_job(given[study])
    planners = {_planner(each["planner"]) for table in job["screened"]["tables"].values() for each in table["jobs"].values()}
    kinds = {module for world in job["screened"]["worlds"].values() for module in _kinds_of_workspace(world)}
    return {
        "job": job,
        "folder": definition.relative(given[study].folder),
        "published": content_digest(*(given[study].published_file(name) for name in choices.printed_tables(given[study]))),
        "code": _code("interpretations", *sorted(planners), *sorted(kinds)),
    }


# ---------------------------------------------------------------------------------------------------------------------
# All studies together


def _published_tables(given: Studies) -> dict[tuple[str, str], Pivot]:
    """The tables compared with published numbers, by study and table."""
    return {(key, name): table for key, study in given.items() for name, table in study.compared().items() if table.published}


def summary_inputs(given: Studies, scale: str) -> dict[str, list[str]]:
    """Input files of the summary."""
    return {
        "comparisons": [f"{_folder(scale, study)}/tables/{table}.comparison.csv" for study, table in _published_tables(given)],
        "claims": [f"{_folder(scale, key)}/claims.csv" for key, study in given.items() if study.claims],
        "worth": f"results/{scale}/worth.csv",
    }


def summary_params(given: Studies, scale: str) -> dict:
    """Params of the summary."""
    tables = _published_tables(given)
    job = {
        "tables": [list(name) for name in tables],
        "titles": {key: study.title for key, study in given.items()},
    }
    return {"job": job, "code": _code("summary")}


def worth_inputs(given: Studies, scale: str) -> dict[str, list[str]]:
    """Input files of the table `worth`."""
    found: dict[str, list[str]] = {"runs": [], "problems": [], "bounds": []}
    for study in given.values():
        experiments = study.worth.experiments if study.worth else []
        found["runs"] += [file for name in experiments for file in _chunks(study, scale, name, _measured(study, name))]
        found["problems"] += _problems(study, scale, experiments)
        found["bounds"] += _bounds(study, scale, experiments)
    return found


def _measured(study: Study, experiment: str) -> list[str]:
    """Methods of an experiment, and the baseline that they are measured against."""
    return [*study.experiments[experiment].methods, study.worth.baseline]


def worth_params(given: Studies, scale: str) -> dict:
    """Params of the table `worth`: `job`, study -> baseline, and experiment -> repeats."""
    job = {
        key: {
            "baseline": study.worth.baseline,
            "repeats": {name: study.experiments[name].repeats[scale] for name in study.worth.experiments},
        }
        for key, study in given.items()
        if study.worth
    }
    return {"job": job, "code": _code("worth")}


# ---------------------------------------------------------------------------------------------------------------------
# Targets


def files_of(given: Studies, scale: str, study: str, name: str) -> list[str]:
    """The files of a table or figure."""
    if name in given[study].tables:
        endings = (".csv", ".comparison.csv") if name in given[study].compared() else (".csv",)
        return [f"{_folder(scale, study)}/tables/{name}{ending}" for ending in endings]
    return [f"{_folder(scale, study)}/figures/{name}{ending}" for ending in (".svg", ".png", ".pdf", ".csv", ".txt")]


def artefacts_of(study: Study, scale: str) -> list[str]:
    """Tables and figures of a study that are made at a scale: at `extended` those that differ from what they are at `full`."""
    made = [*study.tables, *study.figures]
    if scale != "extended":
        return made
    return [name for name in made if any(study.home(experiment, scale) == scale for experiment in _experiments_behind(study, name))]


def _experiments_behind(study: Study, artefact: str) -> list[str]:
    """Names of the experiments that a table or figure shows, for a table of comparisons those of the tables that it compares."""
    spec = study.tables.get(artefact)
    if isinstance(spec, Comparison):
        return [experiment for name in spec.of for experiment in jobs.experiments_of(study, name)]
    return jobs.experiments_of(study, artefact)


def files_of_narrow(given: Studies, scale: str) -> list[str]:
    """All figures of a scale, each on a sheet of one text column."""
    return [
        f"{_folder(scale, key)}/figures/{name}.narrow{ending}"
        for key, study in given.items()
        for name in artefacts_of(study, scale)
        if name in study.figures
        for ending in (".svg", ".pdf")
    ]


def files_of_study(given: Studies, scale: str, study: str) -> list[str]:
    """All tables and figures of a study that are made at a scale, its claims, and its audit if it has claims or published numbers."""
    files = [file for name in artefacts_of(given[study], scale) for file in files_of(given, scale, study, name)]
    if latex_inputs(given, scale, study)["tables"]:
        files.append(f"{_folder(scale, study)}/tables.tex")
    if given[study].claims:
        files.append(f"{_folder(scale, study)}/claims.csv")
    if given[study].claims or _audited(given[study]):
        files.append(f"{_folder(scale, study)}/audit.csv")
    return files


def files_of_scale(given: Studies, scale: str) -> list[str]:
    """Everything that is made at a scale; a summary if some table has published numbers."""
    summary = _published_tables(given)
    return [file for study in given for file in files_of_study(given, scale, study)] + ([f"results/{scale}/summary.md"] if summary else [])


def files_of_sensitivity(given: Studies, scale: str) -> list[str]:
    """The table of alternatives of each study that has any."""
    return [f"{_folder(scale, key)}/sensitivity.csv" for key, study in given.items() if alternatives.tried(study)]


def files_of_interpretations(given: Studies, scale: str) -> list[str]:
    """The interpretations of each study that has published numbers and leaves choices open."""
    return [
        f"{_folder(scale, key)}/interpretations.csv"
        for key, study in given.items()
        if choices.printed_tables(study) and choices.choices(study)
    ]


def files_of_smoke(given: Studies) -> list[str]:
    """The small subset."""
    artefacts, methods = jobs.smoke(given)
    files = [file for study, name in artefacts for file in files_of(given, "smoke", study, name)]
    return files + [f"{_folder('smoke', study)}/runs/{experiment}/{method}/0.parquet" for study, experiment, method in methods]
