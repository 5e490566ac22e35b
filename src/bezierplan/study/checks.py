"""Checks across the files of a study: names defined in other files, planners and their settings,
free places, matching published numbers. Every fault is reported in one line.
"""

import importlib
import inspect
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, partial
from itertools import chain
from pathlib import Path
from typing import Any

from pydantic import ConfigDict, TypeAdapter, ValidationError

from bezierplan.analysis import measures, metrics, statistics
from bezierplan.analysis.claims.check import Check, PublishedMargin
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.table_kinds import Comparison, Pivot, Table
from bezierplan.figures.panels import Panel, spheres
from bezierplan.planners import planner_module
from bezierplan.running import columns, problems, worlds
from bezierplan.running.chunk import conditions
from bezierplan.running.descriptions import Descriptions
from bezierplan.running.execution import settings_in
from bezierplan.running.guard import interface
from bezierplan.running.guard.interface import check_settings
from bezierplan.schema.checked import Fault, check_known, closest
from bezierplan.schema.model import Model, first_fault, named, one_or_list, parsed
from bezierplan.study import published
from bezierplan.study.alternatives import (
    alternatives,
    concerned,
    in_first_variant,
    methods_changed,
    with_alternative,
)
from bezierplan.study.claims import Assumption
from bezierplan.study.definition import Study, files_of, relative
from bezierplan.study.design import Design, fits
from bezierplan.study.files import inside
from bezierplan.study.jobs import job
from bezierplan.study.planner_checks import check_complete, loaded
from bezierplan.workspaces import files
from bezierplan.workspaces.kinds import kinds
from bezierplan.workspaces.problem import Problem

RESERVED = columns.TAKEN.union(columns.WORDS) - {"generations"}
"""Names that no setting can have. The column `generations` holds the number actually performed, so
a setting of that name adds nothing.
"""
LONGEST_REFERENCE = 1000
"""Times the perimeter of a workspace: no best known path is longer."""


def check(study: Study) -> None:
    """Raise Fault for anything wrong in a study whose files are each valid on their own."""
    _check_experiments(study, relative(study.folder / "experiments.yaml"))
    design, functions = Design(study), _functions(study)
    published.check_files(study)
    location = relative(study.folder / "artefacts.yaml")
    _check_labels(study, f"{location}: labels")
    for method in study.looks:
        check_known(method, study.methods, f"{location}: looks")
    for name, table in study.tables.items():
        _check_table(design, functions, table, f"{location}: tables: {name}")
    for name, figure in study.figures.items():
        if name in study.tables:
            raise Fault(f"{location}: figures: {name}: a table has this name already")
        for panel in figure.panels:
            where = f"{location}: figures: {name}: panels: {panel.place}"
            _check_names(design, functions, panel, where)
            _check_dimensions(study, panel, where)
            _check_shown(design, panel, where)
    location = relative(study.folder / "claims.yaml")
    _check_ids(study.claims, f"{location}: claims")
    for claim in study.claims:
        _check_claim(design, functions, claim, f"{location}: claims: {claim.id}")
    location = relative(study.folder / "assumptions.yaml")
    _check_ids(study.assumptions, f"{location}: assumptions")
    for assumption in study.assumptions:
        check_assumption(study, assumption, f"{location}: assumptions: {assumption.id}")


def _check_labels(study: Study, location: str) -> None:
    """Labels are of what a study prints; methods of an experiment are printed by different names,
    and so are its problems.
    """
    printed_names = _printed_names(study)
    for name in study.labels:
        check_known(name, printed_names, location)
    for experiment, content in study.experiments.items():
        for names in (study.methods_of(experiment), content.problems):
            owners: dict[str, str] = {}
            for name in names:
                printed = study.labels.get(name, name)
                owner = owners.setdefault(printed, name)
                if owner != name:
                    labelled = name if name in study.labels else owner
                    raise Fault(
                        f"{location}: {labelled}: {printed}: {owner} and {name} of experiment "
                        f"{experiment} would both be printed so"
                    )


def _printed_names(study: Study) -> set[str]:
    """All that may be printed by name: what a study defines, columns and metrics, settings, every
    word in its experiments, tables, figures and claims, and those of its functions.
    """
    names = {*study.methods, *study.problems, *study.workspaces, *study.experiments}
    names |= {*columns.TAKEN, *columns.WORDS, *metrics.METRICS, "generation"}  # of convergence
    names.update(*(study.accepted(method) for method in study.methods))
    specs = (study.problems, study.experiments, study.tables, study.figures)
    for spec in (*chain.from_iterable(each.values() for each in specs), *study.claims):
        names.update(_texts(spec.plain()))
    if study.module():
        module = importlib.import_module(study.module())
        names.update(re.findall(r"\w+", inspect.getsource(module)))
    return names


def _texts(value: Any) -> Iterator[str]:
    """All texts in a plain value, keys of mappings included; of anything else, its own text."""
    if isinstance(value, Mapping):
        value = [*value.keys(), *value.values()]
    if isinstance(value, list | tuple):
        for each in value:
            yield from _texts(each)
    else:
        yield str(value)


def _check_ids(entries: Sequence[Claim] | Sequence[Assumption], location: str) -> None:
    """Every id is unique, because alternatives and results are looked up by it."""
    ids = [entry.id for entry in entries]
    for number, identity in enumerate(ids):
        if identity in ids[:number]:
            raise Fault(f"{location}: {identity}: another one has this id already")


def _functions(study: Study) -> dict[str, Callable]:
    """The public functions of a study's module, by name."""
    names = vars(importlib.import_module(study.module())) if study.module() else {}
    return {
        name: value for name, value in names.items() if callable(value) and not name.startswith("_")
    }


# experiments.yaml


def _check_experiments(study: Study, location: str) -> None:
    for name, method in study.methods.items():
        where = f"{location}: {'baselines' if name in study.baselines else 'methods'}: {name}"
        loaded(study, name, where)
        for setting in study.accepted(name):
            if setting in RESERVED:
                raise Fault(
                    f"{where}: planner: {method.planner}: its setting {setting} is a column of "
                    "results; give it another name"
                )
        if method.variant_of:
            check_known(method.variant_of, study.methods.keys() - {name}, f"{where}: variant_of")
        for setting in method.settings:
            check_known(setting, study.accepted(name), f"{where}: settings")
        if method.policy:
            check_known(method.policy, study.policies, f"{where}: policy")
            if study.policies[method.policy].warm and not hasattr(
                planner_module(study.planner(name)), "resume"
            ):
                raise Fault(
                    f"{where}: policy: {method.policy}: warm, but planner {method.planner} has no "
                    "function resume"
                )
    used = {setting for name in study.methods for setting in study.accepted(name)}
    _check_shared_settings(study, used, location)
    check_complete(study, location)
    for name in study.methods:
        check_settings(
            planner_module(study.planner(name)),
            study.resolved(name),
            f"{location}: methods: {name}: settings",
        )
    built = cache(partial(_built, study))
    for name in study.workspaces:
        _check_workspace(study, name, f"{location}: workspaces: {name}")
    for name, problem in study.problems.items():
        check_known(problem.workspace, study.workspaces, f"{location}: problems: {name}: workspace")
        for setting in problem.settings:
            check_known(setting, used, f"{location}: problems: {name}: settings")
        _check_problem(study, built, name, f"{location}: problems: {name}")
    for name in study.experiments:
        _check_experiment(study, built, name, f"{location}: experiments: {name}")
    if study.baseline_comparison:
        _check_baseline_comparison(study, f"{location}: baseline_comparison")


def _check_shared_settings(study: Study, used: set[str], location: str) -> None:
    """Settings of all methods, of a planner's methods, and of presets exist in some planner."""
    for setting in study.settings:
        if setting not in used:
            raise Fault(
                f"{location}: settings: {setting}: no planner of this study has this "
                f"setting{closest(setting, used)}"
            )
    planners = {method.planner: name for name, method in study.methods.items()}
    for planner, settings in study.planner_settings.items():
        if planner not in planners:
            raise Fault(
                f"{location}: settings: {planner}: no method of this study has this "
                f"planner{closest(planner, planners)}"
            )
        for setting in settings:
            check_known(
                setting, study.accepted(planners[planner]), f"{location}: settings: {planner}"
            )
    for preset, values in study.presets.items():
        if preset in used or preset in RESERVED:
            taken = "a planner's setting" if preset in used else "a column of results"
            raise Fault(
                f"{location}: presets: {preset}: {taken} has this name; give it another one"
            )
        for value, settings in values.items():
            for setting in settings:
                check_known(setting, used, f"{location}: presets: {preset}: {value}")


def _check_workspace(study: Study, name: str, location: str) -> None:
    """A fixed workspace loads; random ones are drawn with the problems."""
    workspace = study.workspaces[name]
    for key, file in files_of(workspace).items():
        inside(study.folder, file, f"{location}: {key}: {file}")
    if not workspace.drawn and not workspace.moves:
        try:
            files.load(workspace.plain(), study.folder)
        except ValueError as error:
            raise Fault(f"{location}: {error}") from None


def _check_problem(study: Study, built: Callable[[str], Problem], name: str, location: str) -> None:
    """Start and target are free; in the first layout if the workspace is random."""
    problem, home = study.problems[name], study.workspace_of(name)
    if home.kind == "spheres":
        raise Fault(
            f"{location}: workspace: {problem.workspace}: has three dimensions; a panel of kind "
            "spheres plans there, and no experiment"
        )
    drawn = [kind for kind, model in kinds().items() if model.drawn]
    if bool(home.drawn) != (problem.layouts is not None):
        needed = (
            "layouts and obstacles are needed"
            if home.drawn
            else f"layouts and obstacles need a workspace of kind {' or '.join(drawn)}"
        )
        raise Fault(f"{location}: workspace: {problem.workspace}: {needed}")
    if home.drawn and problem.start is None:
        raise Fault(
            f"{location}: start_cell: {problem.start_cell}: cells of drawn workspaces have no "
            "numbers; expected start: [x, y]"
        )
    if home.with_side != (problem.side is not None):
        with_side = [kind for kind, model in kinds().items() if model.with_side]
        needed = (
            "side is needed"
            if home.with_side
            else f"side needs a workspace of kind {' or '.join(with_side)}"
        )
        raise Fault(f"{location}: workspace: {problem.workspace}: {needed}")
    if home.drawn and hasattr(home, "circles") and max(problem.obstacles) > home.circles:
        raise Fault(
            f"{location}: obstacles: {max(problem.obstacles)}; expected at most {home.circles}, "
            "the circles of the workspace"
        )
    try:
        seen = built(name)
    except ValueError as error:
        raise Fault(f"{location}: {error}") from None
    if problem.reference is not None:
        # The exact bound takes too long for a start; the job that computes it tells a reference
        # below it.
        west, east, south, north = seen.workspace.bounds
        least = math.dist(seen.start, seen.target)
        most = LONGEST_REFERENCE * 2 * (east - west + north - south)
        if not (1 - measures.ROUNDED) * least <= problem.reference <= most:
            limits = (
                f"a length from {least:.6g}, the straight line, to {most:.6g}, "
                f"{LONGEST_REFERENCE} times round the workspace"
            )
            raise Fault(f"{location}: reference: {problem.reference}: expected {limits}")


def _built(study: Study, name: str) -> Problem:
    """A problem as planners see it, in the first layout if there are several. Raises ValueError."""
    problem, home = study.problems[name], study.workspace_of(name)
    drawn = {"layout": 0, "obstacles": max(problem.obstacles)} if home.drawn else {}
    described = Descriptions(
        study.key,
        {name: problem.plain("settings", "layouts") | drawn},
        {problem.workspace: home.plain()},
    )
    if home.moves:
        made, _ = worlds.build_all(described, study.folder)
        return made[name]
    return problems.build_all(described, study.folder)[name]


def _check_experiment(
    study: Study, built: Callable[[str], Problem], name: str, location: str
) -> None:
    experiment = study.experiments[name]
    for problem in experiment.problems:
        check_known(problem, study.problems, f"{location}: problems")
    for method in experiment.methods:
        if method in study.baselines:
            raise Fault(f"{location}: methods: {method}: a baseline; it joins by itself")
        check_known(method, study.methods.keys() - study.baselines, f"{location}: methods")
    still = [problem for problem in experiment.problems if not study.workspace_of(problem).moves]
    if study.moves(name) and still:
        raise Fault(
            f"{location}: problems: {still[0]}: its workspace does not move; expected problems "
            "that all move, or none"
        )
    for method in experiment.methods:
        if study.moves(name) != bool(study.methods[method].policy):
            wrong = (
                "has no policy, which a world that moves needs"
                if study.moves(name)
                else "has a policy, but nothing moves here"
            )
            raise Fault(f"{location}: methods: {method}: {wrong}")
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


def _check_baseline_comparison(study: Study, location: str) -> None:
    """The methods of each experiment have the baseline beside them."""
    baseline = study.baseline_comparison.baseline
    check_known(baseline, study.baselines, f"{location}: baseline")
    for experiment in study.baseline_comparison.experiments:
        check_known(experiment, study.experiments, f"{location}: experiments")
        if baseline not in study.methods_of(experiment):
            raise Fault(
                f"{location}: experiments: {experiment}: the baseline {baseline} does not join "
                "it; leave it out"
            )


def _check_method_in(
    study: Study, built: Callable[[str], Problem], name: str, method: str, location: str
) -> None:
    """A method's planner supports the problems of an experiment, and its settings are valid under
    every condition.
    """
    module, experiment = planner_module(study.planner(method)), study.experiments[name]
    for problem in experiment.problems:
        kind = study.kind_of(problem)
        if kind not in getattr(module, "workspaces", (kind,)):
            served = ", ".join(module.workspaces)
            raise Fault(
                f"{location}: methods: {method}: its planner serves workspaces of kind {served}, "
                f"not {kind} ({problem})"
            )
        if hasattr(module, "serves"):
            interface.asked(
                module.serves, f"{location}: methods: {method}: problem {problem}", built(problem)
            )
    described = job(study, name, method, "full", 0)
    # One problem for each distinct set of problem settings.
    apart = {
        str(met.get("settings")): problem for problem, met in reversed(described.problems.items())
    }
    for condition in conditions(list(apart.values()), experiment.vary):
        where = (
            f"{location}: vary: {condition.name}: {method}"
            if condition.values
            else f"{location}: methods: {method}"
        )
        check_settings(module, settings_in(described, condition), f"{where}: settings")


# Names defined elsewhere, in artefacts.yaml and claims.yaml


def _check_names(
    design: Design, functions: dict[str, Callable], model: Model, location: str
) -> None:
    """Names in a model refer to something that exists. The columns of a panel without runs belong
    to its function.
    """
    study = design.study
    experiments = one_or_list(getattr(model, "experiment", None) or [])
    known: Mapping[str, Iterable[str]] = {
        "experiment": study.experiments,
        "workspace": study.workspaces,
        "function": functions,
        "statistic": statistics.STATISTICS,
        "compared": [name for name, table in study.compared().items() if table.published],
        "artefact": [*study.tables, *study.figures],
        "printed table": [Path(file).stem for file in study.published_files()],
    }
    for path, what, name in named(model):
        if what == "experiment":
            check_known(name, known[what], _at(location, path))
    for path, what, name in named(model):
        where = _at(location, path)
        if what in known:
            check_known(name, known[what], where)
        elif what == "published":
            inside(study.folder, f"published/{name}", f"{where}: {name}")
        elif what == "metric" and (experiments or isinstance(model, Comparison)):
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
        case "level":
            if name not in ("value", "statistic"):
                design.check_column(experiments, name, "column", location)
        case "where":
            design.check_where(experiments, name, location, baselines=not of_claim)
        case "repeat":
            design.check_repeat(experiments, name, location)
        case "problem of runs":
            check_known(
                name,
                [
                    problem
                    for each in experiments
                    for problem in design.study.problems_of(each, "full")
                ],
                location,
            )


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


def _at(location: str, path: tuple[str, ...]) -> str:
    """The keys that lead to a name, without its index if it is in a list of names; indices in lists
    of mappings stay.
    """
    return ": ".join([location, *(path[:-1] if path[-1].isdecimal() else path)])


def _check_shown(design: Design, panel: Panel, location: str) -> None:
    """A panel's runs are of the kind that it shows, of one problem and one method if it shows one
    run, and of enough methods.
    """
    if not getattr(panel, "experiment", None):
        return
    study = design.study
    if getattr(panel, "hue", None) and panel.hue == getattr(panel, "x", None):
        raise Fault(f"{location}: hue: {panel.hue}: is x already; expected another column")
    if panel.drives and not study.moves(panel.experiment):
        raise Fault(
            f"{location}: experiment: {panel.experiment}: nothing moves there; expected an "
            "experiment of drives"
        )
    hue = getattr(panel, "hue", None) if panel.one else None
    rows = design.rows(panel.experiment) if hue else []
    for value in design.values([panel.experiment], hue, rows) if hue else [None]:
        where = panel.where | ({hue: value} if hue else {})
        if hue and value not in one_or_list(panel.where.get(hue, value)):
            continue
        shown = design.shown(panel.experiment, where)
        for column in panel.one:
            if len(shown[column]) > 1:
                some = ", ".join(sorted(shown[column])[:3])
                raise Fault(
                    f"{location}: where: selects {len(shown[column])} values of {column} ({some}, "
                    "...); expected one, which is shown"
                )
    methods = design.shown(panel.experiment, panel.where)["method"]
    if len(methods) < panel.fewest_methods:
        raise Fault(
            f"{location}: where: method: {', '.join(sorted(methods))}: expected at least "
            f"{panel.fewest_methods} methods"
        )
    for method in sorted(methods) if panel.tracks else []:
        if not hasattr(planner_module(study.planner(method)), "track"):
            raise Fault(
                f"{location}: where: method: {method}: its planner "
                f"{study.methods[method].planner} has no function track"
            )


def _check_table(
    design: Design, functions: dict[str, Callable], table: Table, location: str
) -> None:
    _check_names(design, functions, table, location)
    if isinstance(table, Comparison):
        _check_comparison(design, table, location)
    if not isinstance(table, Pivot):
        return
    if table.published:
        published.check(design, table, location)
    elif table.monotone:
        raise Fault(
            f"{location}: monotone: "
            "the table has no published numbers, which it is about; leave it out"
        )
    keys = published.keys(design.study, table)
    for column in table.primary:
        check_known(column, keys, f"{location}: primary")


def _check_comparison(design: Design, table: Comparison, location: str) -> None:
    """The tables that it compares have its metrics, and the columns and values that it selects."""
    pivots = [design.study.compared()[name] for name in table.of]
    keys = {
        key: [pivot.experiment for pivot in pivots if key in published.keys(design.study, pivot)]
        for pivot in pivots
        for key in published.keys(design.study, pivot)
    }
    for metric in table.metrics:
        check_known(
            metric,
            {entry.metric for pivot in pivots for entry in pivot.values},
            f"{location}: metrics",
        )
    for column, wanted in table.where.items():
        check_known(column, keys, f"{location}: where")
        for value in one_or_list(wanted):
            design.check_where(keys[column], {column: value}, f"{location}: where")


def _check_claim(
    design: Design, functions: dict[str, Callable], claim: Claim, location: str
) -> None:
    _check_names(design, functions, claim, location)
    _check_variants(design, claim, f"{location}: variants")
    for number, check in enumerate(claim.checks):
        where = f"{location}: checks: {number}"
        _check_names(design, functions, check, where)
        if not check.experiments or not hasattr(check, "every"):
            continue
        rows = design.selectable(check.experiments, baselines=False)
        values = design.values(check.experiments, check.cells, rows) if check.cells else []
        for group in check.groups_named if values else []:
            if group != "rest" and group not in values:
                raise Fault(f"{where}: group: {group}: unknown{design.hint(group, values)}")
        design.check_mixtures(check, in_first_variant(claim, check), where)
        _check_values_of_x(design, check, in_first_variant(claim, check), where)
        if isinstance(getattr(check, "margin", None), PublishedMargin) and not _is_printed(
            design.study, check
        ):
            raise Fault(
                f"{where}: margin: published: no table of {', '.join(check.experiments)} has "
                f"printed numbers of {check.metric}"
            )


def _check_variants(design: Design, claim: Claim, location: str) -> None:
    """Every value of a variant exists, and takes the place of something: of a metric or an
    experiment, or of runs that a check selects.
    """
    experiments = list(dict.fromkeys(name for check in claim.checks for name in check.experiments))
    for column, values in claim.variants.items():
        if not experiments:
            raise Fault(f"{location}: {column}: no check of the claim is about runs; leave it out")
        for value in (check for entry in values for check in one_or_list(entry)):
            if column == "metric":
                check_known(value, metrics.METRICS, f"{location}: metric")
                design.check_metric(experiments, value, f"{location}: metric")
            elif column == "experiment":
                check_known(value, design.study.experiments, f"{location}: experiment")
            else:
                design.check_where(experiments, {column: value}, location, baselines=False)
        if column in ("metric", "experiment"):
            judged = {
                name
                for check in claim.checks
                for name in one_or_list(getattr(check, column, None) or [])
            }
            for value in one_or_list(values[0]):
                if value not in judged:
                    raise Fault(
                        f"{location}: {column}: {value}: not in a check; expected first what the "
                        f"checks name: {', '.join(judged)}"
                    )


def _check_values_of_x(design: Design, check: Check, where: dict[str, Any], location: str) -> None:
    """A trend has several values to go along."""
    if check.cells_key != "x":
        return
    rows = [
        row for row in design.selectable(check.experiments, baselines=False) if fits(row, where)
    ]
    values = design.values(check.experiments, check.x, rows)
    if len(values) < 2:
        raise Fault(
            f"{location}: x: {check.x}: has the only value {values[0] if values else 'none'}; a "
            "trend needs at least two"
        )


def _is_printed(study: Study, check: Check) -> bool:
    """Whether a table of a check's experiments has printed numbers of its metric."""
    metric = check.metric
    for pivot in study.compared().values():
        given = (
            published.rows_of(study, pivot.published)
            if pivot.published and pivot.experiment in check.experiments
            else []
        )
        if metric in {pivot.reads.get(row["metric"], row["metric"]) for row in given}:
            return True
    return False


def _check_dimensions(study: Study, panel: Panel, location: str) -> None:
    """Only panels of kind `spheres` show a workspace of that kind, and no other; what they plan
    there is valid.
    """
    workspace = study.workspaces.get(getattr(panel, "workspace", None))
    if workspace and panel.plans != (workspace.kind == "spheres"):
        fit = (
            "of kind spheres"
            if panel.plans
            else "in the plane, since only panels of kind spheres show others"
        )
        raise Fault(
            f"{location}: workspace: {panel.workspace}: a workspace of kind {workspace.kind}; "
            f"expected one {fit}"
        )
    of_cells = [
        key for key in ("numbers", "embed") if getattr(panel, key, "none") not in ("none", False)
    ]
    if workspace and of_cells and (workspace.made or workspace.kind) != "grid":
        raise Fault(
            f"{location}: {of_cells[0]}: {panel.workspace}: a workspace of kind {workspace.kind}; "
            "only grids have cells"
        )
    if not panel.plans:
        return
    check_known(panel.method, study.methods, f"{location}: method")
    if study.methods[panel.method].planner != spheres.PLANNER:
        raise Fault(
            f"{location}: method: {panel.method}: its planner cannot plan among spheres; expected "
            f"a method of {spheres.PLANNER}"
        )
    for setting in panel.settings:
        check_known(setting, study.accepted(panel.method), f"{location}: settings")
    check_settings(
        planner_module(spheres.PLANNER),
        study.resolved(panel.method) | panel.settings,
        f"{location}: settings",
    )
    try:
        spheres.problem(files.load(workspace.plain(), study.folder), panel.start, panel.target)
    except ValueError as error:
        raise Fault(f"{location}: {error}") from None


# assumptions.yaml


def check_assumption(study: Study, assumption: Assumption, location: str) -> None:
    """An assumption's claims belong to the study, its default is the value used, and every
    alternative is a valid value of its setting.
    """
    for identity in assumption.claims:
        check_known(identity, [claim.id for claim in study.claims], f"{location}: claims")
        claim = next(each for each in study.claims if each.id == identity)
        drives = [name for each in claim.checks for name in each.experiments if study.moves(name)]
        if drives:
            raise Fault(
                f"{location}: claims: {identity}: is about drives ({drives[0]}), which "
                "alternatives do not repeat"
            )
    for name in assumption.problems:
        check_known(name, study.problems, f"{location}: problems")
    for name, key in assumption.workspace.items():
        _check_key(study, assumption, name, key, location)
    if not assumption.setting:
        return
    if isinstance(assumption.default, dict):
        for method in assumption.default:
            check_known(method, study.methods, f"{location}: default")
    methods = concerned(study, assumption)
    if not methods:
        used = {setting for method in study.methods for setting in study.resolved(method)}
        raise Fault(
            f"{location}: setting: {assumption.setting}: no method has this "
            f"setting{closest(assumption.setting, used)}"
        )
    # An assumption about some problems alone has the value that they give, if they give one.
    for given in [study.problems[name].settings for name in assumption.problems] or [{}]:
        used = {
            method: (study.resolved(method) | given | study.methods[method].settings)[
                assumption.setting
            ]
            for method in methods
        }
        _check_used(study, assumption, used, location)
    for method, settings in assumption.along.items():
        check_known(method, methods, f"{location}: with")
        for setting in settings:
            check_known(
                setting,
                study.accepted(method).keys() - {assumption.setting},
                f"{location}: with: {method}",
            )
    for name, (of, value) in alternatives(study).items():
        if of.id == assumption.id:
            changed = with_alternative(study, name)
            for method in methods_changed(study, name):
                module = planner_module(study.planner(method))
                check_settings(
                    module,
                    changed.resolved(method),
                    f"{location}: alternatives: {value}: {method}: settings",
                )


def _check_key(study: Study, assumption: Assumption, name: str, key: str, location: str) -> None:
    """The key of a workspace that an assumption governs has the default, and can have every
    alternative.
    """
    check_known(name, study.workspaces, f"{location}: workspace")
    workspace = study.workspaces[name]
    check_known(key, workspace.plain(), f"{location}: workspace: {name}")
    if workspace.plain()[key] != assumption.default:
        raise Fault(
            f"{location}: default: {assumption.default}: not the one that is used; "
            f"the {key} of {name} is {workspace.plain()[key]}"
        )
    for value in assumption.alternatives:
        changed = parsed(
            type(workspace),
            workspace.plain() | {key: value},
            f"{location}: alternatives: {value}: {name}",
        )
        for file in files_of(changed).values():
            if not (study.folder / file).is_file():
                raise Fault(
                    f"{location}: alternatives: {file}: no such file in {relative(study.folder)}"
                )


def _check_used(study: Study, assumption: Assumption, used: dict[str, Any], location: str) -> None:
    """The default is what runs use: those of each method that it names; without names, those of the
    methods without a value of their own or, if all have one, of at least one of them.

    used: the value of each method.
    """
    default = assumption.default
    if isinstance(default, dict):
        for method, value in used.items():
            if value != default[method]:
                raise Fault(
                    f"{location}: default: {method}: {default[method]}: not the one that is used; "
                    f"its {assumption.setting} is {value}"
                )
        return
    shared = [
        value
        for method, value in used.items()
        if assumption.setting not in study.methods[method].settings
    ]
    if any(value != default for value in shared) or default not in used.values():
        values = ", ".join(dict.fromkeys(map(str, shared or used.values())))
        raise Fault(
            f"{location}: default: {default}: not the one that is used; "
            f"{assumption.setting} is {values}"
        )
