"""The jobs of the workflow (`analysis.jobs`, `figures.jobs`), one function for each rule: it builds
the rule's job from a study, or from all studies, and the rule's wildcards.
"""

from collections.abc import Iterable
from pathlib import Path

from bezierplan.analysis.claims.material import Display, StudyForClaims
from bezierplan.analysis.jobs import (
    Audit,
    Bounds,
    Claims,
    MethodsTable,
    Problems,
    Recheck,
    Runs,
    Summary,
    TableOfRuns,
    TableWithoutRuns,
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
from bezierplan.study.captions import build_caption
from bezierplan.study.definition import Study
from bezierplan.study.experiments import build_descriptions, build_problems_job
from bezierplan.study.runs_behind import list_methods, list_parts_with_runs

Studies = dict[str, Study]


# --------------------------------------------------------------------------------------------------
# Problems, bounds and runs


def build_problems(study: Study, scale: str, experiment: str) -> Problems:
    """Build the job that writes the problems of an experiment."""
    described = build_problems_job(study, experiment, scale)
    maps = study.maps(described.workspaces)
    return Problems(described, shorten_path(study.folder), sources=maps)


def build_bounds(study: Study, scale: str, experiment: str) -> Bounds:
    """Build the job that writes the bounds of an experiment's problems."""
    return Bounds()


def build_chunk(study: Study, experiment: str, method: str, scale: str, number: int) -> Chunk:
    """Return a chunk of a method's runs in an experiment. It always runs whole, even if fewer
    repeats are asked for.
    """
    content = study.experiments[experiment]
    size = content.chunk[scale] if study.draws(method) else 1
    settings = study.resolve_settings(method).items()
    first = number * size
    # A varied value may need fewer runs (`fewer`): later chunks leave it out.
    vary = {
        name: [value for value in values if content.runs_of(scale, name, value) > first]
        for name, values in content.vary.items()
    }
    return Chunk(
        study=study.key,
        experiment=experiment,
        method=method,
        planner=study.planner(method),
        # Varied settings come with the condition (`execution.resolve_settings`).
        settings={name: value for name, value in settings if name not in content.vary},
        problems=_list_problems(study, experiment, method, scale, first),
        vary=vary,
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
    """Return the places of an experiment's problems that have the repeat `first`, by name. Each has
    those of its settings that the method leaves open.
    """
    accepted = study.read_accepted_settings(method).keys() - study.methods[method].settings
    met = {}
    for name, problem in study.problems_of(experiment, scale, first).items():
        settings = {
            key: value for key, value in problem.get("settings", {}).items() if key in accepted
        } | study.find_changed_settings(method, name)
        place = {key: problem[key] for key in PLACE if key in problem}
        met[name] = place | ({"settings": settings} if settings else {})
    return met


def list_chunks(study: Study, experiment: str, method: str, scale: str) -> range:
    """Return the numbers of a method's chunks in an experiment at a scale: enough for its condition
    with the most repeats. A method that draws no random numbers has one.
    """
    content = study.experiments[experiment]
    if not study.draws(method):
        return range(1)
    factors = {"method": [method], "problem": content.problems} | content.vary
    # A condition has the fewest repeats of any of its values. All combinations exist, so the most
    # repeats of a condition are this minimum.
    repeats = min(
        max(content.runs_of(scale, factor, value) for value in values)
        for factor, values in factors.items()
    )
    return range(-(-repeats // content.chunk[scale]))


def count_chunks(
    study: Study, experiment: str, methods: Iterable[str], scale: str
) -> dict[str, int]:
    """Return the number of chunks of some methods of an experiment, by method."""
    return {method: len(list_chunks(study, experiment, method, scale)) for method in methods}


def build_runs(study: Study, scale: str, experiment: str, method: str, chunk: str) -> Runs:
    """Build the job that makes a chunk of runs."""
    return Runs(build_chunk(study, experiment, method, scale, int(chunk)))


def build_judgement(study: Study, scale: str, experiment: str, methods: Iterable[str]) -> Recheck:
    """Build the job that judges the runs of all chunks of some methods again."""
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
    """Group the methods of an experiment that the same tables, figures and claims show. One job
    judges a group, whose file lies with the first, so that nothing waits for runs which it does not
    need.
    """
    shown = [list_methods(study, name) for name in (*study.find_tables_of_runs(), *study.figures)]
    claims = [claim for claim in study.claims if claim.scale in (None, scale)]
    if experiment in alternatives.list_experiments(claims):
        shown.append({experiment: study.experiments[experiment].methods})
    groups: dict[tuple, list[str]] = {}
    for method in methods:
        users = [n for n, by in enumerate(shown) if method in by.get(experiment, ())]
        alone = method if method in study.baselines else ""
        groups.setdefault((alone, *users), []).append(method)
    return [*groups.values()]


# --------------------------------------------------------------------------------------------------
# Tables and figures


def find_results(study: Study, artefact: str, scale: str) -> Shows:
    """Return the results that a table or figure shows: by experiment and method, the number of
    chunks.
    """
    return {
        name: count_chunks(study, name, methods, scale)
        for name, methods in list_methods(study, artefact).items()
    }


def choose_looks(study: Study) -> dict[str, str]:
    """Return the name of each method's look in all figures, by method."""
    return style.choose_looks(
        {method: study.planner(method) for method in study.methods}, study.looks
    )


def build_labels(study: Study, artefact: str) -> dict[str, str]:
    """Return the labels that a table or figure needs: all but those of methods, problems and
    workspaces that it does not show.
    """
    spec = study.artefact(artefact)
    layout = study.layout.get(artefact)
    printed = getattr(spec, "labels", {}) | (layout.names if layout else {})
    if getattr(spec, "names_any", False):
        return study.labels | printed
    shown = set()
    for part in list_parts_with_runs(spec):
        content = study.experiments[part.experiment]
        shown |= {*convert_to_list(part.where.get("method", content.methods)), *content.problems}
        shown |= {str(value) for values in content.vary.values() for value in values}
        for problem in (study.problems[each] for each in content.problems):
            shown |= {problem.workspace, problem.route}
    # A label that is not shown must not make the job run again.
    hidden = {*study.methods, *study.problems, *study.workspaces} - shown
    return {name: label for name, label in study.labels.items() if name not in hidden} | printed


def build_table_of_runs(study: Study, scale: str, table: str) -> TableOfRuns:
    """Build the job that writes a table of runs with its comparison."""
    spec = study.tables[table]
    where = {"method": study.own_methods(spec.experiment, table)} | spec.where | spec.primary
    file = study.find_published_file(table)
    return TableOfRuns(
        name=f"{study.key}/{table}",
        # What does not change the table's numbers stays out of the job, so an edit of it reruns
        # nothing; labels come below.
        spec=spec.but(title=table, note=None, labels={}, monotone=[], where=where),
        labels=build_labels(study, table),
        reconstructed=study.list_reconstructed_workspaces(spec),
        fitted=study.fitted.get(table, {}),
        repeats=study.experiments[spec.experiment].repeats[scale],
        sources=[file] if file else [],
        shows=find_results(study, table, scale),
        code=study.code_for("metrics"),
    )


def build_table_without_runs(study: Study, scale: str, table: str) -> TableWithoutRuns:
    """Build the job that writes a table of another kind."""
    spec = study.tables[table].but(title=table)
    code = study.code_for("functions") if spec.kind == "function" else []
    file = study.find_published_file(table)
    return TableWithoutRuns(
        spec, sources=[file] if file else study.list_published_files(), code=code
    )


def build_latex(study: Study, scale: str, table: str) -> Latex:
    """Build the job that typesets a table."""
    spec = study.tables[table]
    heads = len(spec.index) if table in study.find_published_tables() else 0
    caption = build_caption(study, table, scale).write()
    return Latex(f"{study.key}-{table}", caption, spec.note, heads)


def build_figure(study: Study, scale: str, figure: str) -> FigureFiles:
    """Build the job that draws a figure."""
    spec, behind = study.figures[figure], list_methods(study, figure)
    every = study.every_problem() if spec.problems else {}
    problems = build_descriptions(study, {name: every[name] for name in spec.problems})
    maps = [*spec.workspaces, *problems.workspaces]
    homes = [study.problems[study.experiments[name].problems[0]].workspace for name in behind]
    # Of a figure without runs and maps, any workspace has the unit.
    unit = study.workspaces[[*homes, *maps, *study.workspaces][0]].unit
    methods = {method for name in behind for method in study.methods_of(name)}
    looks = choose_looks(study).items()
    # Only some panels repeat runs, such as tracks; others read the stored ones.
    again = {
        name: {method: build_chunk(study, name, method, scale, 0) for method in behind[name]}
        for name in spec.rerun
    }
    published = [file for file in study.list_published_files() if spec.draws(Path(file).stem)]
    return FigureFiles(
        caption=build_caption(study, figure, scale).write(),
        columns=spec.columns,
        width=spec.width,
        panels=spec.panels,
        layout=study.layout.get(figure),
        labels=build_labels(study, figure),
        looks={name: look for name, look in looks if spec.names_any or name in methods},
        workspaces={name: study.workspaces[name].plain() for name in spec.workspaces},
        problems=problems,
        repeats={name: study.experiments[name].repeats[scale] for name in behind},
        chunks=again,
        unit=unit,
        folder=shorten_path(study.folder),
        alternatives=_list_alternatives(study) if spec.claims else [],
        sources=[*study.maps(maps), *published],
        shows=find_results(study, figure, scale),
        code=study.code_for(*spec.code),
    )


def _list_alternatives(study: Study) -> list[dict[str, str]]:
    """Return a row for the default and for each single alternative: assumption, detail, value."""
    default = alternatives.DEFAULT
    details = {default: "The reading behind all tables"}
    details |= {each.id: each.detail for each in study.assumptions}
    return [
        {"assumption": name, "detail": details[name], "value": str(value)}
        for own in alternatives.build_single_alternatives(study).values()
        for name, value in (own.values or {default: default}).items()
    ]


# --------------------------------------------------------------------------------------------------
# Claims, also under readings; audit


JUDGED_AT = "extended"
"""The scale at which claims are judged under readings."""


def is_shared(study: Study, default: Study, scale: str, experiment: str, method: str = "") -> bool:
    """Return whether a study under other values shares its problems of an experiment with the
    default, and the runs of a method if one is given.
    """
    own, other = (
        build_problems_job(each, experiment, scale).workspaces for each in (study, default)
    )
    # A reading has fewer problems than the default, so its workspaces are some of these.
    alike = own.items() <= other.items()
    if not method or not alike:
        return alike
    # The first chunk stands for all: the others differ in repeats, and have no other problems.
    made, known = (build_chunk(each, experiment, method, scale, 0) for each in (study, default))
    return made.settings == known.settings and made.problems.items() <= known.problems.items()


def build_claims(study: Study, scale: str) -> Claims:
    """Build the job that judges the claims of a study."""
    claims = [claim for claim in study.claims if claim.scale in (None, scale)]
    experiments = {name: study.experiments[name] for name in alternatives.list_experiments(claims)}
    return Claims(
        StudyForClaims(
            study.key,
            claims,
            {name: _describe_runs(each) for name, each in (study.tables | study.figures).items()},
            study.variants(),
            {name: experiment.paired for name, experiment in experiments.items()},
            # Scale full has as many runs as the papers.
            {name: experiment.repeats["full"] for name, experiment in experiments.items()},
            study.labels,
        ),
        {name: experiment.repeats[scale] for name, experiment in experiments.items()},
        {
            each.name: alternatives.describe_values(study, each.values)
            for each in study.readings
            if scale == JUDGED_AT and not study.values
        },
        sources=study.list_published_files(),
        code=study.code_for("metrics", "functions"),
        shows={
            name: count_chunks(study, name, experiment.methods, scale)
            for name, experiment in experiments.items()
        },
    )


def _describe_runs(artefact: TableEntry | Figure) -> list[Display]:
    """Return how each part of a table or figure selects and shows its runs."""
    return [
        Display(**{name: each for name, each in part.plain().items() if name in list_keys(Display)})
        for part in list_parts_with_runs(artefact)
    ]


def build_audit(study: Study, scale: str) -> Audit:
    """Build the job that audits the printed numbers of a study."""
    tables = {
        Path(each.published).stem: each.but(title=name, note=None, labels={})
        for name, each in study.find_published_tables().items()
    }
    return Audit(
        study.key,
        tables,
        [name for name, table in tables.items() if study.list_reconstructed_workspaces(table)],
        sources=study.list_published_files(),
        code=study.code_for("metrics", "audit"),
        shows={name: {} for name in sorted({each.experiment for each in tables.values()})},
    )


# --------------------------------------------------------------------------------------------------
# All studies together


def build_methods(studies: Studies, scale: str) -> MethodsTable:
    """Return the job that measures the methods of studies beside the baseline that these name."""
    proposed, families, repeats, problems, shows = {}, {}, {}, {}, {}
    for key, study in studies.items():
        if not (beside := study.baseline_comparison):
            continue
        proposed[key], families[key] = beside.proposed, beside.families
        for name in beside.experiments:
            methods = [*study.experiments[name].methods, beside.baseline]
            repeats[f"{key}/{name}"] = study.experiments[name].repeats[scale]
            problems[f"{key}/{name}"] = [*study.problems_of(name, "full")]
            shows[f"{key}/{name}"] = count_chunks(study, name, methods, scale)
    return MethodsTable(proposed, families, repeats, problems, shows=shows)


def build_summary(studies: Studies, scale: str) -> Summary:
    """Build the job that summarises all studies."""
    tables = [
        (key, name) for key, content in studies.items() for name in content.find_published_tables()
    ]
    code = [module for content in studies.values() for module in content.code_for("metrics")]
    return Summary(tables, code=code)
