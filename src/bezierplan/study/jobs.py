"""The jobs of the workflow (`analysis.jobs`, `figures.jobs`) that follow from studies: a function
for each rule makes its job from a study, or all, and the rule's wildcards.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from bezierplan.analysis.claims.material import Display, StudyForClaims
from bezierplan.analysis.jobs import (
    Audit,
    BaselineTable,
    Bounds,
    Claims,
    Problems,
    Recheck,
    Runs,
    Summary,
    TableOfRuns,
    TableWithoutRuns,
    VerdictText,
)
from bezierplan.analysis.table_kinds import TableEntry
from bezierplan.figures import style
from bezierplan.figures.figure import Figure
from bezierplan.figures.jobs import FigureFiles, Latex
from bezierplan.places import shorten_path
from bezierplan.planners import PLACE
from bezierplan.running.chunk import Chunk
from bezierplan.running.inputs import Shows
from bezierplan.schema.model import convert_to_list, list_keys
from bezierplan.study import alternatives
from bezierplan.study.definition import Study
from bezierplan.study.experiments import build_descriptions, build_problems_job

Studies = dict[str, Study]


# --------------------------------------------------------------------------------------------------
# Problems, bounds and runs


def build_problems(study: Study, scale: str, experiment: str) -> Problems:
    """The problems of an experiment."""
    described = build_problems_job(study, experiment, scale)
    maps = study.maps(described.workspaces)
    return Problems(described, shorten_path(study.folder), sources=maps)


def build_bounds(study: Study, scale: str, experiment: str) -> Bounds:
    """The bounds of an experiment."""
    return Bounds()


def build_chunk(study: Study, experiment: str, method: str, scale: str, number: int) -> Chunk:
    """A chunk of runs, which always runs whole, whatever the number of requested repeats."""
    content = study.experiments[experiment]
    size = content.chunk[scale] if study.draws(method) else 1
    settings = study.resolved(method).items()
    first = number * size
    vary = {
        name: [value for value in values if content.runs_of(scale, name, value) > first]
        for name, values in content.vary.items()
    }
    return Chunk(
        study=study.key,
        experiment=experiment,
        method=method,
        planner=study.planner(method),
        settings={name: value for name, value in settings if name not in content.vary},
        problems=_list_problems(study, experiment, method, scale, first),
        vary=vary,
        presets={name: preset for name, preset in study.presets.items() if name in content.vary},
        seeds=content.seeds,
        repeats=[first, first + size],
        time_limit=content.time_limit,
        policy=study.policies[study.methods[method].policy].model_dump()
        if study.moves(experiment)
        else None,
    )


def _list_problems(
    study: Study, experiment: str, method: str, scale: str, first: int
) -> dict[str, dict]:
    """Places of an experiment's problems that have the repeat `first`, by name, with those of their
    settings that a method leaves open.
    """
    accepted = study.accepted(method).keys() - study.methods[method].settings.keys()
    met = {}
    for name, problem in study.problems_of(experiment, scale, first).items():
        settings = {
            key: value for key, value in problem.get("settings", {}).items() if key in accepted
        } | study.changed(method, name)
        place = {key: problem[key] for key in PLACE if key in problem}
        met[name] = place | ({"settings": settings} if settings else {})
    return met


def list_chunks(study: Study, experiment: str, method: str, scale: str) -> range:
    """Numbers of the chunks that contain a method's repeats in an experiment at a scale, under the
    condition with the most: one of a method that draws no random numbers.
    """
    content = study.experiments[experiment]
    if not study.draws(method):
        return range(1)
    factors = {"method": [method], "problem": content.problems} | content.vary
    repeats = min(
        max(content.runs_of(scale, factor, value) for value in values)
        for factor, values in factors.items()
    )
    return range(-(-repeats // content.chunk[scale]))


def count_chunks(
    study: Study, experiment: str, methods: Iterable[str], scale: str
) -> dict[str, int]:
    """Number of chunks of each of some methods."""
    return {method: len(list_chunks(study, experiment, method, scale)) for method in methods}


def build_runs(study: Study, scale: str, experiment: str, method: str, chunk: str) -> Runs:
    """A chunk of runs."""
    return Runs(build_chunk(study, experiment, method, scale, int(chunk)))


def build_judgement(study: Study, scale: str, experiment: str, methods: Iterable[str]) -> Recheck:
    """All chunks of the scale, of some methods."""
    numbers = count_chunks(study, experiment, methods, scale)
    return Recheck(
        [
            build_chunk(study, experiment, method, scale, number)
            for method in numbers
            for number in range(numbers[method])
        ],
        shows={experiment: numbers},
    )


def group_methods(
    study: Study, scale: str, experiment: str, methods: Iterable[str]
) -> list[list[str]]:
    """Methods of an experiment in groups, each judged by one job whose file lies with the first:
    those that the same tables, figures and claims show, so that none waits for runs which it does
    not need.
    """
    shown = [list_methods(study, name) for name in (*study.compared(), *study.figures)]
    claims = [claim for claim in study.claims if claim.scale in (None, scale)]
    if experiment in alternatives.list_experiments(claims):
        shown.append({experiment: list(study.experiments[experiment].methods)})
    groups: dict[tuple, list[str]] = {}
    for method in methods:
        users = [n for n, by in enumerate(shown) if method in by.get(experiment, ())]
        alone = method if method in study.baselines else ""
        groups.setdefault((alone, *users), []).append(method)
    return [*groups.values()]


# --------------------------------------------------------------------------------------------------
# Tables and figures


def _list_parts(artefact: TableEntry | Figure) -> list[Any]:
    """What of a table or figure shows runs: the table, or some panels."""
    parts = getattr(artefact, "panels", [artefact])
    return [part for part in parts if getattr(part, "experiment", None)]


def list_methods(study: Study, artefact: str) -> dict[str, list[str]]:
    """By experiment, the methods whose runs an artefact needs: for a table of the paper's form
    those it selects, for another all (the comparison shows them), for a figure those it selects,
    including baselines if named.
    """
    if spec := study.compared().get(artefact):
        methods = study.methods_of(spec.experiment)
        if spec.printed:
            methods = convert_to_list(
                spec.where.get("method", study.own_methods(spec.experiment, artefact))
            )
        return {spec.experiment: methods}
    needed: dict[str, set[str]] = {}
    for panel in _list_parts(study.artefact(artefact)):
        methods = panel.where.get("method", study.own_methods(panel.experiment, artefact))
        needed.setdefault(panel.experiment, set()).update(convert_to_list(methods))
    return {
        name: [method for method in study.methods_of(name) if method in shown]
        for name, shown in needed.items()
    }


def find_results(study: Study, artefact: str, scale: str) -> Shows:
    """The results that a table or figure shows."""
    return {
        name: count_chunks(study, name, methods, scale)
        for name, methods in list_methods(study, artefact).items()
    }


def choose_looks(study: Study) -> dict[str, str]:
    """Method -> the name of its look in every figure."""
    return style.looks_of({method: study.planner(method) for method in study.methods}, study.looks)


def build_labels(study: Study, artefact: str) -> dict[str, str]:
    """Labels, except those of methods, problems and workspaces that a table or figure does not
    show.
    """
    spec = study.artefact(artefact)
    layout = study.layout.get(artefact)
    printed = getattr(spec, "labels", {}) | (layout.names if layout else {})
    if getattr(spec, "names_any", False):
        return study.labels | printed
    shown = set()
    for part in _list_parts(spec):
        content = study.experiments[part.experiment]
        shown |= {*convert_to_list(part.where.get("method", content.methods)), *content.problems}
        shown |= {str(value) for values in content.vary.values() for value in values}
        for problem in (study.problems[each] for each in content.problems):
            shown |= {problem.workspace, problem.route}
    hidden = (study.methods.keys() | study.problems.keys() | study.workspaces.keys()) - shown
    return {name: label for name, label in study.labels.items() if name not in hidden} | printed


def build_table_of_runs(study: Study, scale: str, table: str) -> TableOfRuns:
    """The table of a name."""
    spec = study.whole(table)
    experiment = study.experiments[spec.experiment]
    # Baselines appear only in the comparison, and there with variants, unless the table has the
    # paper's form.
    where = {"method": study.own_methods(spec.experiment, table)} | spec.where
    if spec.printed:
        where |= spec.primary
    beside = [] if spec.printed else study.methods_of(spec.experiment)
    file = study.published_file(table)
    return TableOfRuns(
        name=f"{study.key}/{spec.extends or table}",
        spec=spec.but(title=table, note=None, labels={}, monotone=[], where=where),
        labels=build_labels(study, table),
        variants={name: method for name, method in study.variants().items() if name in beside},
        baselines=[name for name in beside if name in study.baselines],
        reconstructed=study.reconstructed(spec),
        fitted=study.fitted.get(spec.extends or table, {}),
        paired=experiment.paired,
        repeats=experiment.repeats[scale],
        sources=[file] if file else [],
        shows=find_results(study, table, scale),
        code=study.code_for("metrics"),
    )


def build_table_without_runs(study: Study, scale: str, table: str) -> TableWithoutRuns:
    """The table of a name."""
    spec = study.tables[table].but(title=table)
    code = study.code_for("functions") if spec.kind == "function" else []
    file = study.published_file(table)
    return TableWithoutRuns(spec, sources=[file] if file else study.published_files(), code=code)


def build_latex(study: Study, scale: str, table: str) -> Latex:
    """The table of a name."""
    spec, printed = study.tables[table], study.with_published().get(table)
    heads = len(printed.index) if printed else 0
    return Latex(f"{study.key}-{table}", build_caption(study, table, scale), spec.note, heads)


def build_figure(study: Study, scale: str, figure: str) -> FigureFiles:
    """The figure of a name."""
    spec, behind = study.figures[figure], list_methods(study, figure)
    methods = {method for name in behind for method in study.methods_of(name)}
    homes = [study.problems[study.experiments[name].problems[0]].workspace for name in behind]
    every = study.every_problem() if spec.problems else {}
    problems = build_descriptions(study, {name: every[name] for name in spec.problems})
    homes += problems.workspaces
    return FigureFiles(
        study=study.key,
        columns=spec.columns,
        width=spec.width,
        panels=spec.panels,
        layout=study.layout.get(figure),
        labels=build_labels(study, figure),
        looks={
            name: look
            for name, look in choose_looks(study).items()
            if spec.names_any or name in methods
        },
        workspaces={name: study.workspaces[name].plain() for name in spec.workspaces},
        problems=problems,
        repeats={name: study.experiments[name].repeats[scale] for name in behind},
        chunks={
            name: {method: build_chunk(study, name, method, scale, 0) for method in behind[name]}
            for name in spec.rerun
        },
        unit=study.workspaces[[*homes, *spec.workspaces, *study.workspaces][0]].unit,
        folder=shorten_path(study.folder),
        alternatives=_list_alternatives(study) if spec.claims else [],
        sources=[
            *study.maps([*spec.workspaces, *problems.workspaces]),
            *(file for file in study.published_files() if spec.draws(Path(file).stem)),
        ],
        shows=find_results(study, figure, scale),
        code=study.code_for(*spec.code),
    )


def _list_alternatives(study: Study) -> list[dict[str, str]]:
    """Return what the default and each single alternative is: assumption, its detail, value."""
    details = {each.id: each.detail for each in study.assumptions}
    default = alternatives.DEFAULT
    rows = [{"assumption": default, "detail": "The reading behind all tables", "value": default}]
    for own in alternatives.build_single_alternatives(study).values():
        rows += [
            {"assumption": name, "detail": details[name], "value": str(value)}
            for name, value in own.values.items()
        ]
    return rows


def build_caption(study: Study, artefact: str, scale: str) -> str:
    """The caption of a table or figure: title, what the paper says of its own, and the runs behind
    it. The page has the settings of each method, and the verdicts of claims.
    """
    title = study.artefact(artefact).title
    words = quote_paper(study, artefact)
    parts = [title, words and f"In print: {words}", find_runs_behind(study, artefact, scale)]
    return ". ".join(filter(None, parts)) + "."


def quote_paper(study: Study, artefact: str) -> str:
    """What the paper says of its table or figure."""
    return study.layout[artefact].says if artefact in study.layout else ""


def find_runs_behind(study: Study, artefact: str, scale: str) -> str:
    """The runs of each method behind a table or figure."""
    parts, told = _list_parts(study.artefact(artefact)), []
    for experiment in list_methods(study, artefact):
        content = study.experiments[experiment]
        own = [part.where for part in parts if part.experiment == experiment]
        listed = max(len(convert_to_list(where.get("repeat", []))) for where in own)
        repeats = listed or content.repeats[scale]
        drawn = [study.problems[name].layouts or {scale: 1} for name in content.problems]
        layouts = max(each[scale] for each in drawn)
        told.append(
            f"{experiment}: {'at most ' if scale == 'extended' and content.fewer else ''}{repeats} "
            f"run{'s' if repeats > 1 else ''} of each method on each "
            + (f"of {layouts} layouts, {repeats * layouts} together" if layouts > 1 else "problem")
        )
    return "; ".join(told)


# --------------------------------------------------------------------------------------------------
# Claims, also under readings; audit


JUDGED_AT = "extended"
"""The scale at which claims are judged under readings."""


def is_shared(study: Study, default: Study, scale: str, experiment: str, method: str = "") -> bool:
    """Return whether an experiment has the same problems in a study under other values of its
    assumptions and by default, and a method the same runs.
    """
    own, other = (
        build_problems_job(each, experiment, scale).workspaces for each in (study, default)
    )
    if any(other[name] != home for name, home in own.items()):
        return False
    if not method:
        return True
    made, known = (build_chunk(each, experiment, method, scale, 0) for each in (study, default))
    places = all(known.problems[name] == place for name, place in made.problems.items())
    return places and made.settings == known.settings


def build_claims(study: Study, scale: str) -> Claims:
    """The claims of a study."""
    claims = [claim for claim in study.claims if claim.scale in (None, scale)]
    experiments = {name: study.experiments[name] for name in alternatives.list_experiments(claims)}
    return Claims(
        StudyForClaims(
            study.key,
            claims,
            {name: _describe_runs(each) for name, each in (study.tables | study.figures).items()},
            study.variants(),
            {name: experiment.paired for name, experiment in experiments.items()},
            {name: experiment.repeats["full"] for name, experiment in experiments.items()},
            study.labels,
        ),
        {name: experiment.repeats[scale] for name, experiment in experiments.items()},
        {
            each.name: alternatives.describe_values(study, each.values)
            for each in study.readings
            if scale == JUDGED_AT and not study.values
        },
        sources=study.published_files(),
        code=study.code_for("metrics", "functions"),
        shows={
            name: count_chunks(study, name, experiment.methods, scale)
            for name, experiment in experiments.items()
        },
    )


def _describe_runs(artefact: TableEntry | Figure) -> list[Display]:
    """What a table or figure shows of runs."""
    return [
        Display(**{name: each for name, each in part.plain().items() if name in list_keys(Display)})
        for part in _list_parts(artefact)
    ]


def build_audit(study: Study, scale: str) -> Audit:
    """The audit of a study."""
    tables = {
        Path(each.published).stem: each.but(title=name, note=None, labels={})
        for name, each in study.with_published().items()
    }
    return Audit(
        study.key,
        tables,
        [name for name, table in tables.items() if study.reconstructed(table)],
        sources=study.published_files(),
        code=study.code_for("metrics", "audit"),
        shows={name: {} for name in sorted({each.experiment for each in tables.values()})},
    )


# --------------------------------------------------------------------------------------------------
# All studies together


def build_worth(studies: Studies, scale: str) -> BaselineTable:
    """The studies that have a generic optimiser beside their methods; with all baselines."""
    return build_baseline_comparison(studies, scale, with_baselines=True)


def build_baseline_comparison(
    studies: Studies, scale: str, with_baselines: bool = False
) -> BaselineTable:
    """The methods of studies beside the baseline that these name, if they do. with_baselines:
    `build_worth`.
    """
    baselines, families, repeats, shows = {}, {}, {}, {}
    for key, study in studies.items():
        if not (beside := study.baseline_comparison):
            continue
        for name in convert_to_list(beside.worth or []) if with_baselines else beside.experiments:
            baselines[key] = (beside.baseline, beside.proposed)
            families[key] = {} if with_baselines else beside.plain().get("families", {})
            methods = [*study.experiments[name].methods, beside.baseline]
            if with_baselines:
                methods = study.methods_of(name)
            repeats[f"{key}/{name}"] = study.experiments[name].repeats[scale]
            shows[f"{key}/{name}"] = count_chunks(study, name, methods, scale)
    return BaselineTable(baselines, families, repeats, with_baselines, shows=shows)


def build_summary(studies: Studies, scale: str) -> Summary:
    """All studies."""
    tables = [(key, name) for key, content in studies.items() for name in content.with_published()]
    code = [module for content in studies.values() for module in content.code_for("metrics")]
    return Summary(tables, code=code)


def build_verdict(study: Study, scale: str) -> VerdictText:
    """That of a study."""
    return VerdictText(study.key, study.labels, sources=[study.verdict_file()])
