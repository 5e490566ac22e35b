"""Checks across the files of a study: names defined in other files, planners and their settings,
free places, matching published numbers. Every fault is reported in one line.
"""

import inspect
from collections.abc import Callable, Iterable, Sequence
from functools import cache, partial
from pathlib import Path
from types import ModuleType
from typing import Any

from pydantic import ConfigDict, TypeAdapter, ValidationError

from bezierplan.analysis import metrics, statistics, study_code
from bezierplan.analysis.claims.check import Check
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.figures.panels import Panel
from bezierplan.planners import is_file, known_planners, planner_module, planner_settings
from bezierplan.running import columns, worlds
from bezierplan.running.chunk import conditions
from bezierplan.running.descriptions import Descriptions
from bezierplan.running.execution import settings_in
from bezierplan.running.guard import interface
from bezierplan.running.guard.interface import check_settings
from bezierplan.schema.checked import Fault, check_known, closest, part
from bezierplan.schema.model import Model, first_fault, named, one_or_list, parsed
from bezierplan.study import published
from bezierplan.study.alternatives import alternatives, concerned, with_alternative
from bezierplan.study.claims import Assumption
from bezierplan.study.definition import Study, files_of, relative
from bezierplan.study.design import Design
from bezierplan.study.files import inside
from bezierplan.study.jobs import job
from bezierplan.workspaces import files
from bezierplan.workspaces.problem import Problem

RESERVED = columns.TAKEN.union(columns.WORDS) - {"generations"}
"""Names that no setting can have. The column `generations` holds the number actually performed, so
a setting of that name adds nothing.
"""


def check(study: Study) -> None:
    """Raise Fault for anything wrong in a study whose files are each valid on their own."""
    with part():
        _check_experiments(study, relative(study.folder / "experiments.yaml"))
    design, functions = Design(study), study_code.functions(study.code_for("functions"))
    for file in study.published_files():
        published.read(Path(file))
    location = relative(study.folder / "artefacts.yaml")
    for method in study.looks:
        check_known(method, study.methods, f"{location}: looks")
    for name, table in study.tables.items():
        with part():
            where = f"{location}: tables: {name}"
            _check_names(design, functions, table, where)
            if isinstance(table, Pivot) and table.published:
                published.check(design, table, where)
                design.check_where([table.experiment], table.primary, f"{where}: primary")
    for name, figure in study.figures.items():
        if name in study.tables:
            raise Fault(f"{location}: figures: {name}: a table has this name already")
        for panel in figure.panels:
            with part():
                where = f"{location}: figures: {name}: panels: {panel.place}"
                _check_names(design, functions, panel, where)
                _check_panel(design, panel, where)
    location = relative(study.folder / "claims.yaml")
    _check_ids(study.claims, f"{location}: claims")
    for claim in study.claims:
        with part():
            _check_claim(design, functions, claim, f"{location}: claims: {claim.id}")
    location = relative(study.folder / "assumptions.yaml")
    _check_ids(study.assumptions, f"{location}: assumptions")
    for assumption in study.assumptions:
        with part():
            check_assumption(study, assumption, f"{location}: assumptions: {assumption.id}")
    for table, voting in study.votes.items():
        check_known(table, study.with_published(), f"{location}: votes")
        for metric in voting:
            measured = [entry.metric for entry in study.tables[table].values if entry.defined]
            check_known(metric, measured, f"{location}: votes: {table}")


def _check_ids(entries: Sequence[Claim] | Sequence[Assumption], location: str) -> None:
    """Every id is unique, because alternatives and results are looked up by it."""
    ids = [entry.id for entry in entries]
    for number, identity in enumerate(ids):
        if identity in ids[:number]:
            raise Fault(f"{location}: {identity}: another one has this id already")


# experiments.yaml


def _check_experiments(study: Study, location: str) -> None:
    missing: dict[str, dict[str, None]] = {}
    for name, method in study.methods.items():
        where = f"{location}: {'baselines' if name in study.baselines else 'methods'}: {name}"
        module = _loaded(study, name, f"{where}: planner: {method.planner}")
        if method.variant_of:
            check_known(method.variant_of, study.methods.keys() - {name}, f"{where}: variant_of")
        for setting in method.settings:
            check_known(setting, study.accepted(name), f"{where}: settings")
        if method.policy:
            check_known(method.policy, study.policies, f"{where}: policy")
            if study.policies[method.policy].warm and not hasattr(module, "resume"):
                raise Fault(
                    f"{where}: policy: {method.policy}: warm, but planner {method.planner} has no "
                    "function resume"
                )
        lacking = study.accepted(name).keys() - study.resolved(name).keys()
        missing.setdefault(method.planner, {}).update(dict.fromkeys(sorted(lacking)))
    metrics.add_columns(
        column
        for name in study.methods
        for column in getattr(planner_module(study.planner(name)), "extra", ())
    )
    used = {setting for name in study.methods for setting in study.accepted(name)}
    _check_shared_settings(study, used, location)
    for planner, names in missing.items():
        if names:
            raise Fault(f"{location}: settings: {', '.join(names)}: missing; {planner} needs them")
    for name in study.methods:
        with part():
            check_settings(
                planner_module(study.planner(name)),
                study.resolved(name),
                f"{location}: methods: {name}: settings",
            )
    for name, workspace in study.workspaces.items():
        where = f"{location}: workspaces: {name}"
        for key, file in files_of(workspace).items():
            inside(study.folder, file, f"{where}: {key}: {file}")
        if function := getattr(workspace, "function", None):
            known = study_code.part_of(study.code_for("worlds"))
            check_known(function, known, f"{where}: function", "worlds.py")
            _check_arguments(known[function], workspace.arguments, f"{where}: arguments")
        if not workspace.drawn and not workspace.moves:
            _valid(where, files.load, workspace.plain(), study.folder)
    built = cache(partial(_built, study))
    for name, problem in study.problems.items():
        with part():
            where = f"{location}: problems: {name}"
            check_known(problem.workspace, study.workspaces, f"{where}: workspace")
            for setting in problem.settings:
                check_known(setting, used, f"{where}: settings")
            _check_problem(study, name, where)
            _valid(where, built, name)
    for name in study.experiments:
        with part():
            _check_experiment(study, built, name, f"{location}: experiments: {name}")
    if study.baseline_comparison:
        where, baseline = f"{location}: baseline_comparison", study.baseline_comparison.baseline
        check_known(baseline, study.baselines, f"{where}: baseline")
        for experiment in study.baseline_comparison.experiments:
            check_known(experiment, study.experiments, f"{where}: experiments")
            check_known(baseline, study.methods_of(experiment), f"{where}: {experiment}: baseline")


def _valid(location: str, make: Callable[..., object], *of: Any) -> None:
    """Raise Fault, beginning with a location, if something cannot be made."""
    try:
        make(*of)
    except ValueError as error:
        raise Fault(f"{location}: {error}") from None


def _loaded(study: Study, method: str, location: str) -> ModuleType:
    """The module of a method's planner, which has the interface of a planner and no setting that is
    named like a column.
    """
    name = study.methods[method].planner
    if is_file(name):
        inside(study.folder, name, location)
    elif name not in known_planners():
        raise Fault(
            f"{location}: unknown{closest(name, known_planners())}; "
            f"one of your own is a file, {name}.py"
        )
    module = interface.loaded(study.planner(method), location)
    for setting in RESERVED & set(planner_settings(module)):
        raise Fault(
            f"{location}: its setting {setting} is a column of results; give it another name"
        )
    return module


def _check_shared_settings(study: Study, used: set[str], location: str) -> None:
    """Settings of all methods, of a planner's methods, and of presets exist in some planner."""
    planners = {method.planner: name for name, method in study.methods.items()}
    for setting in study.settings:
        check_known(setting, used, f"{location}: settings")
    for planner, settings in study.planner_settings.items():
        check_known(planner, planners, f"{location}: settings")
        for setting in settings:
            accepted = study.accepted(planners[planner])
            check_known(setting, accepted, f"{location}: settings: {planner}")
    for preset, values in study.presets.items():
        if preset in used or preset in RESERVED:
            raise Fault(f"{location}: presets: {preset}: a setting or a column has this name")
        for value, settings in values.items():
            for setting in settings:
                check_known(setting, used, f"{location}: presets: {preset}: {value}")


def _check_problem(study: Study, name: str, location: str) -> None:
    """A problem has the keys of its kind of workspace."""
    problem, home = study.problems[name], study.workspace_of(name)
    for key, needed in (("layouts", bool(home.drawn)), ("side", home.with_side)):
        if needed != (getattr(problem, key) is not None):
            kind = f"of kind {home.kind}"
            wanted = f"needs {key}" if needed else f"has no {key}"
            raise Fault(f"{location}: workspace: {problem.workspace}: {kind}, which {wanted}")
    if home.drawn and problem.start is None:
        raise Fault(
            f"{location}: start_cell: {problem.start_cell}: cells of drawn workspaces have no "
            "numbers; expected start: [x, y]"
        )


def _built(study: Study, name: str) -> Problem:
    """A problem as planners see it, in the first layout if there are several. Raises ValueError."""
    problem, home = study.problems[name], study.workspace_of(name)
    drawn = {"layout": 0, "obstacles": max(problem.obstacles)} if home.drawn else {}
    described = Descriptions(
        study.key,
        {name: problem.plain("settings", "layouts") | drawn},
        {problem.workspace: study.described(problem.workspace)},
    )
    return worlds.build_all(described, study.folder)[0][name]


def _check_experiment(
    study: Study, built: Callable[[str], Problem], name: str, location: str
) -> None:
    experiment = study.experiments[name]
    for problem in experiment.problems:
        check_known(problem, study.problems, f"{location}: problems")
        if study.workspace_of(problem).moves != study.moves(name):
            raise Fault(
                f"{location}: problems: {problem}: its workspace does not move; expected problems "
                "that all move, or none"
            )
    for method in experiment.methods:
        if method in study.baselines:
            raise Fault(f"{location}: methods: {method}: a baseline; it joins by itself")
        check_known(method, study.methods.keys() - study.baselines, f"{location}: methods")
        if study.moves(name) != bool(study.methods[method].policy):
            wanted = "needs" if study.moves(name) else "has"
            raise Fault(
                f"{location}: methods: {method}: {wanted} a policy, which experiments in worlds "
                "that move need, and no others"
            )
    accepted = {setting for method in experiment.methods for setting in study.accepted(method)}
    for setting, values in experiment.vary.items():
        check_known(setting, accepted | set(study.presets), f"{location}: vary")
        for value in values if setting in study.presets else []:
            check_known(str(value).lower(), study.presets[setting], f"{location}: vary: {setting}")
    methods = [*experiment.methods, *study.baselines]
    factors = {"method": methods, "problem": experiment.problems} | experiment.vary
    for factor, fewer in experiment.fewer.items():
        check_known(factor, factors, f"{location}: fewer")
        for value in fewer:
            check_known(value, map(str, factors[factor]), f"{location}: fewer: {factor}")
    for method in experiment.methods:
        _check_method_in(study, built, name, method, location)


def _check_method_in(
    study: Study, built: Callable[[str], Problem], name: str, method: str, location: str
) -> None:
    """A method's planner supports the problems of an experiment, and its settings are valid under
    every condition.
    """
    module, experiment = planner_module(study.planner(method)), study.experiments[name]
    where = f"{location}: methods: {method}"
    for problem in experiment.problems:
        kind = study.kind_of(problem)
        if kind not in getattr(module, "workspaces", (kind,)):
            served = ", ".join(module.workspaces)
            raise Fault(
                f"{where}: its planner serves workspaces of kind {served}, not {kind} ({problem})"
            )
        if hasattr(module, "serves"):
            interface.asked(module.serves, f"{where}: problem {problem}", built(problem))
    described = job(study, name, method, "full", 0)
    # One problem for each distinct set of problem settings.
    apart = {
        str(met.get("settings")): problem for problem, met in reversed(described.problems.items())
    }
    for condition in conditions(list(apart.values()), experiment.vary):
        varied = f"{location}: vary: {condition.name}: {method}" if condition.values else where
        check_settings(module, settings_in(described, condition), f"{varied}: settings")


# Names defined elsewhere, in artefacts.yaml and claims.yaml


def _check_names(
    design: Design, functions: dict[str, Callable], model: Model, location: str
) -> None:
    """Names in a model refer to something that exists. The columns of a panel without runs belong
    to its function.
    """
    study = design.study
    known: dict[str, Iterable[str]] = {
        "experiment": study.experiments,
        "workspace": study.workspaces,
        "function": functions,
        "drawing": study_code.part_of(study.code_for("panels")),
        "statistic": statistics.STATISTICS,
        "compared": study.with_published(),
        "artefact": [*study.tables, *study.figures],
        "printed table": [Path(file).stem for file in study.published_files()],
    }
    names = [
        (": ".join([location, *(path[:-1] if path[-1].isdecimal() else path)]), path, what, name)
        for path, what, name in named(model)
    ]
    for where, _, what, name in names:
        if what in known:
            home = {"function": "functions.py", "drawing": "panels.py"}.get(what, "")
            check_known(name, known[what], where, home)
    experiments = one_or_list(getattr(model, "experiment", None) or [])
    for where, path, what, name in names:
        if what == "published":
            inside(study.folder, f"published/{name}", f"{where}: {name}")
        elif what == "metric" and experiments:
            check_known(name, metrics.METRICS, where)
            design.check_metric(experiments, name, where)
        elif experiments:
            _check_of_runs(design, experiments, what, name, where, isinstance(model, Check))
        if what == "function" and len(path) == 1:
            _check_arguments(
                functions[name], getattr(model, "arguments", {}), f"{location}: arguments"
            )


def _check_of_runs(
    design: Design, experiments: list[str], what: str, name: Any, location: str, of_claim: bool
) -> None:
    """A column, a selection, a repeat or a problem exists in the runs of experiments."""
    match what:
        case "column" | "number column" | "quantity":
            design.check_column(experiments, name, what, location)
        case "level" if name not in ("value", "statistic"):
            design.check_column(experiments, name, "column", location)
        case "where":
            design.check_where(experiments, name, location, baselines=not of_claim)
        case "repeat":
            design.check_repeat(experiments, name, location)
        case "problem of runs":
            made = [design.study.problems_of(each, "full") for each in experiments]
            check_known(name, [problem for each in made for problem in each], location)


def _check_arguments(function: Callable, arguments: dict[str, Any], location: str) -> None:
    """A function's keyword-only arguments are given, each as its annotation says."""
    accepted = {
        name: parameter
        for name, parameter in inspect.signature(function).parameters.items()
        if parameter.kind is parameter.KEYWORD_ONLY
    }
    for name in arguments:
        check_known(name, accepted, location)
    for name, parameter in accepted.items():
        if name not in arguments:
            raise Fault(f"{location}: {name}: missing; {function.__name__} needs it")
        try:
            TypeAdapter(parameter.annotation, config=ConfigDict(strict=True)).validate_python(
                arguments[name]
            )
        except ValidationError as error:
            raise Fault(": ".join([location, name, *first_fault(error)])) from None


def _check_panel(design: Design, panel: Panel, location: str) -> None:
    """A panel's runs are of the kind that it shows, of one method if it shows one run, and of
    enough methods.
    """
    study = design.study
    if not getattr(panel, "experiment", None):
        return
    if panel.drives and not study.moves(panel.experiment):
        raise Fault(
            f"{location}: experiment: {panel.experiment}: nothing moves there; expected an "
            "experiment of drives"
        )
    methods = one_or_list(panel.where.get("method", study.experiments[panel.experiment].methods))
    if "method" in panel.one and len(methods) > 1 and getattr(panel, "hue", None) != "method":
        raise Fault(
            f"{location}: where: selects {len(methods)} values of method; expected one, which is "
            "shown"
        )
    if len(methods) < panel.fewest_methods:
        raise Fault(f"{location}: where: expected at least {panel.fewest_methods} methods")


def _check_claim(
    design: Design, functions: dict[str, Callable], claim: Claim, location: str
) -> None:
    _check_names(design, functions, claim, location)
    experiments = list(dict.fromkeys(name for check in claim.checks for name in check.experiments))
    for number, check in enumerate(claim.checks):
        where = f"{location}: checks: {number}"
        _check_names(design, functions, check, where)
        cells = getattr(check, "cells", None) if check.experiments else None
        values = design.values(check.experiments, cells, baselines=False) if cells else []
        for group in check.groups_named if values else []:
            if group != "rest":
                check_known(group, values, f"{where}: group")
    for column, entries in claim.variants.items():
        for value in (each for entry in entries for each in one_or_list(entry)):
            where = f"{location}: variants: {column}"
            if column == "metric":
                check_known(value, metrics.METRICS, where)
            elif column == "experiment":
                check_known(value, design.study.experiments, where)
            elif experiments:
                design.check_where(
                    experiments, {column: value}, f"{location}: variants", baselines=False
                )


# assumptions.yaml


def check_assumption(study: Study, assumption: Assumption, location: str) -> None:
    """An assumption's names are those of the study, and every alternative is a valid value of what
    it governs.
    """
    for name in assumption.problems:
        check_known(name, study.problems, f"{location}: problems")
    for name, key in assumption.workspace.items():
        check_known(name, study.workspaces, f"{location}: workspace")
        own = study.workspaces[name]
        check_known(key, own.plain(), f"{location}: workspace: {name}")
        for value in assumption.alternatives:
            where = f"{location}: alternatives: {value}: {name}"
            changed = parsed(type(own), own.plain() | {key: value}, where)
            for file in files_of(changed).values():
                inside(study.folder, file, where)
    if not assumption.setting:
        return
    for method in assumption.methods:
        check_known(method, study.methods, f"{location}: methods")
    methods = concerned(study, assumption)
    if not methods:
        used = {setting for method in study.methods for setting in study.resolved(method)}
        check_known(assumption.setting, used - {assumption.setting}, f"{location}: setting")
    for method, settings in assumption.along.items():
        check_known(method, methods, f"{location}: with")
        for setting in settings:
            check_known(setting, study.accepted(method), f"{location}: with: {method}")
    for name, (of, value) in alternatives(study).items():
        if of.id == assumption.id:
            changed = with_alternative(study, name)
            for method in methods:
                where = f"{location}: alternatives: {value}: {method}: settings"
                check_settings(
                    planner_module(study.planner(method)), changed.resolved(method), where
                )
