"""Studies read from their folders and checked: everything that can be wrong in one is found here, before the first job starts, and told in
one line (`checked.Fault`).
"""

import csv
import importlib
import itertools
import math
from pathlib import Path
from typing import Any

from bezierplan import checked, metrics, problems
from bezierplan.analysis import statistics
from bezierplan.checked import Fault, closest
from bezierplan.digest import PACKAGE
from bezierplan.problem import Problem, known_planners, planner_module, planner_settings, setting_fault
from bezierplan.running import RUN_COLUMNS, conditions, settings_in
from bezierplan.study import DRAWN, PLACE, Study, alternatives, job, methods_changed, relative, with_alternative
from bezierplan.workspaces import files

PUBLISHED_COLUMNS = ("metric", "statistic", "n", "unit", "value")


def read_config(given: dict) -> list[Path]:
    """Folders of the studies that a configuration names: config/config.yaml of the working folder, and what was given besides.

    Raises Fault.
    """
    file = Path("config/config.yaml")
    content = (checked.read(file, "config") if file.is_file() else {}) | given
    place = f"{file} or --config"
    checked.check(content, "config", place)
    root = PACKAGE.parents[1] / "config" / "studies"
    folders = []
    for name in content["studies"]:
        folder = root / name if "/" not in name else Path(name)
        if not (folder / "experiments.yaml").is_file():
            known = [place.parent.name for place in root.glob("*/experiments.yaml")]
            raise Fault(f"{place}: studies: {name}: no experiments.yaml in {relative(folder)}{closest(name, known)}")
        folders.append(folder)
    return folders


def load(folders: list[Path]) -> dict[str, Study]:
    """The studies in folders, by name, read and checked. Raises Fault."""
    studies = {}
    for folder in folders:
        study = _read(folder)
        if study.key in studies:
            raise Fault(f"{relative(folder)}: a study of the name {study.key} is there already; rename the folder")
        _check(study)
        studies[study.key] = study
    return studies


def _read(folder: Path) -> Study:
    experiments = checked.read(_shown(folder / "experiments.yaml"), "experiments")
    artefacts = checked.read(_shown(folder / "artefacts.yaml"), "artefacts") if (folder / "artefacts.yaml").is_file() else {}
    controls = experiments.pop("controls", {})
    experiments.setdefault("levels", {})
    for name in controls:
        if name in experiments["methods"]:
            raise Fault(f"{relative(folder / 'experiments.yaml')}: controls: {name}: a method has this name already")
    experiments["methods"] |= controls
    return Study(
        key=folder.resolve().name,
        controls=frozenset(controls),
        folder=folder,
        labels=artefacts.get("labels", {}),
        tables=artefacts.get("tables", {}),
        figures=artefacts.get("figures", {}),
        claims=_optional(folder / "claims.yaml", "claims"),
        assumptions=_optional(folder / "assumptions.yaml", "assumptions"),
        **experiments,
    )


def _optional(file: Path, name: str) -> list[dict]:
    """The list of claims or assumptions in a file of that schema; empty without the file."""
    return checked.read(_shown(file), name)[name] if file.is_file() else []


def _shown(file: Path) -> Path:
    return Path(relative(file))


def _check(study: Study) -> None:
    place = relative(study.folder / "experiments.yaml")
    for name in study.methods:
        _check_planner(study, name, f"{place}: methods: {name}")
    used = {setting for name in study.methods for setting in planner_settings(planner_module(study.planner(name)))}
    for setting in study.settings:
        if setting not in used:
            raise Fault(f"{place}: settings: {setting}: no planner of this study has this setting{closest(setting, used)}")
    for name in study.methods:
        _check_settings(planner_module(study.planner(name)), study.resolved(name), f"{place}: methods: {name}")
    for name in study.workspaces:
        _check_workspace(study, name, place)
    for name, problem in study.problems.items():
        _known(problem["workspace"], study.workspaces, f"{place}: problems: {name}: workspace")
        for setting in problem.get("settings", {}):
            _known(setting, used, f"{place}: problems: {name}: settings")
        _check_problem(study, name, problem, f"{place}: problems: {name}")
    for name in study.experiments:
        _check_experiment(study, name, f"{place}: experiments: {name}")
    place = relative(study.folder / "artefacts.yaml")
    for name, table in study.tables.items():
        _check_table(study, table, f"{place}: tables: {name}")
    for name, figure in study.figures.items():
        if name in study.tables:
            raise Fault(f"{place}: figures: {name}: a table has this name already")
        for number, panel in enumerate(figure["panels"]):
            _check_panel(study, panel, f"{place}: figures: {name}: panels: {number}")
    for claim in study.claims:
        _check_claim(study, claim, f"{relative(study.folder / 'claims.yaml')}: claims: {claim['id']}")
    for assumption in study.assumptions:
        _check_assumption(study, assumption, f"{relative(study.folder / 'assumptions.yaml')}: assumptions: {assumption['id']}")


def _functions(study: Study) -> list[str]:
    """Names of the public functions of a study's module."""
    names = vars(importlib.import_module(study.module())) if study.module() else {}
    return [name for name, value in names.items() if callable(value) and not name.startswith("_")]


def _check_claim(study: Study, claim: dict, place: str) -> None:
    """Names in a claim: of artefacts, experiments, metrics, columns, groups and functions."""
    for artefact in _listed(claim.get("artefact", [])):
        _known(artefact, [*study.tables, *study.figures], f"{place}: artefact")
    for column, values in claim.get("variants", {}).items():
        if column == "metric":
            for value in values:
                _known(value, metrics.METRICS, f"{place}: variants: metric")
    for number, check in enumerate(claim["checks"]):
        where = f"{place}: checks: {number}"
        if check["test"] == "function":
            _known(check["name"], _functions(study), f"{where}: name")
        if "experiment" in check:
            for experiment in _listed(check["experiment"]):
                _known(experiment, study.experiments, f"{where}: experiment")
                _check_check(study, experiment, check, where)


def _check_check(study: Study, experiment: str, check: dict, place: str) -> None:
    if "metric" in check:
        _known(check["metric"], metrics.METRICS, f"{place}: metric")
    if "work" in check:
        _known(check["work"], metrics.METRICS, f"{place}: work")
    # A condition may also be on an outcome, which some planners alone report.
    conditions = {column: wanted for column, wanted in check.get("where", {}).items() if column not in metrics.METRICS}
    _check_where(study, experiment, conditions, f"{place}: where")
    columns = {"experiment", *_columns(study, experiment)}
    for key in ("every", "pool"):
        for column in check.get(key, []):
            _known(column, columns, f"{place}: {key}")
    for key in ("across", "x", "unit"):
        if key in check:
            _known(check[key], columns, f"{place}: {key}")
    if check.get("across", "method") == "method":
        tiers = [check.get("groups", []), check.get("than", []), *check.get("pairs", []), *check.get("order", [])]
        for group in itertools.chain.from_iterable(tiers):
            _known(group, ["rest", *study.methods_of(experiment)], f"{place}: group")


def _check_assumption(study: Study, assumption: dict, place: str) -> None:
    """An assumption's claims are claims of the study, and every alternative is a legal value of its setting."""
    for identity in assumption.get("claims", []):
        _known(identity, [claim["id"] for claim in study.claims], f"{place}: claims")
    for name, (identity, value) in alternatives(study).items():
        if identity != assumption["id"]:
            continue
        changed = with_alternative(study, name)
        for method in methods_changed(study, name):
            _check_settings(planner_module(study.planner(method)), changed.resolved(method), f"{place}: alternatives: {value}: {method}")
        if not methods_changed(study, name):
            used = {setting for method in study.methods for setting in study.resolved(method)}
            raise Fault(f"{place}: setting: {assumption['setting']}: no method has this setting{closest(assumption['setting'], used)}")


def _listed(value: Any) -> list:
    return value if isinstance(value, list) else [value]


def _known(name: str, known: Any, place: str) -> None:
    if name not in known:
        raise Fault(f"{place}: {name}: unknown{closest(name, known)}")


def _check_planner(study: Study, name: str, place: str) -> None:
    method = study.methods[name]
    planner = method["planner"]
    if planner.endswith(".py"):
        if not (study.folder / planner).is_file():
            raise Fault(f"{place}: planner: {planner}: no such file in {relative(study.folder)}")
    else:
        _known(planner, known_planners(), f"{place}: planner")
    if "variant_of" in method:
        _known(method["variant_of"], study.methods, f"{place}: variant_of")
    accepted = planner_settings(planner_module(study.planner(name)))
    for setting in accepted:
        # The column `generations` holds how many were really done, beside which a setting of that name says nothing more.
        if setting in RUN_COLUMNS and setting != "generations":
            raise Fault(f"{place}: planner: {planner}: its setting {setting} is a column of the runs table; give it another name")
    for setting in method.get("settings", {}):
        _known(setting, accepted, f"{place}: settings")


def _check_settings(module: Any, settings: dict[str, Any], place: str) -> None:
    """Settings of one method, complete, each of its type and within its range, and fitting together."""
    accepted = planner_settings(module)
    for setting, annotation in accepted.items():
        if setting not in settings:
            raise Fault(f"{place}: settings: {setting}: missing; {module.__name__.split('.')[-1]} needs it")
        wanted = setting_fault(annotation, settings[setting])
        if wanted:
            raise Fault(f"{place}: settings: {setting}: {settings[setting]!r}; expected {wanted}")
    if hasattr(module, "check"):
        try:
            module.check(settings)
        except ValueError as error:
            raise Fault(f"{place}: settings: {error}") from None


def _check_workspace(study: Study, name: str, place: str) -> None:
    """A fixed workspace can be loaded; random ones are drawn with the problems."""
    if study.workspaces[name]["kind"] not in DRAWN:
        try:
            files.load(study.workspaces[name], study.folder)
        except ValueError as error:
            raise Fault(f"{place}: workspaces: {name}: {error}") from None


def _check_problem(study: Study, name: str, problem: dict, place: str) -> None:
    """Start and target are free, in the first layout where the workspace is drawn."""
    home = study.workspaces[problem["workspace"]]
    drawn = home["kind"] in DRAWN
    if drawn != ("layouts" in problem):
        needed = "layouts and obstacles are needed" if drawn else f"layouts and obstacles need a workspace of kind {' or '.join(DRAWN)}"
        raise Fault(f"{place}: workspace: {problem['workspace']}: {needed}")
    if drawn and "start" not in problem:
        raise Fault(f"{place}: start_cell: {problem['start_cell']}: cells of drawn workspaces have no numbers; expected start: [x, y]")
    if (drawn and DRAWN[home["kind"]] == "grid") != ("side" in problem):
        needed = "side is needed" if "side" not in problem else "side needs a workspace of kind random_field or random_blocks"
        raise Fault(f"{place}: workspace: {problem['workspace']}: {needed}")
    if home["kind"] == "random_circles" and max(problem["obstacles"]) > home["circles"]:
        raise Fault(f"{place}: obstacles: {max(problem['obstacles'])}; expected at most {home['circles']}, the circles of the workspace")
    try:
        _built(study, name)
    except ValueError as error:
        raise Fault(f"{place}: {error}") from None


def _built(study: Study, name: str) -> Problem:
    """A problem as planners meet it, in the first layout where the workspace is drawn. Raises ValueError."""
    problem = study.problems[name]
    home = study.workspaces[problem["workspace"]]
    drawn = {"layout": 0, "obstacles": max(problem["obstacles"])} if home["kind"] in DRAWN else {}
    described = {"study": study.key, "problems": {name: problem | drawn}, "workspaces": {problem["workspace"]: home}}
    return problems.build_all(described, study.folder)[0][name]


def _check_experiment(study: Study, name: str, place: str) -> None:
    experiment = study.experiments[name]
    for problem in experiment["problems"]:
        _known(problem, study.problems, f"{place}: problems")
    for method in experiment["methods"]:
        _known(method, study.methods.keys() - study.controls, f"{place}: methods")
    accepted = {setting for method in experiment["methods"] for setting in planner_settings(planner_module(study.planner(method)))}
    for setting, values in experiment.get("vary", {}).items():
        _known(setting, accepted | set(study.levels), f"{place}: vary")
        for value in values if setting in study.levels else []:
            _known(str(value).lower(), study.levels[setting], f"{place}: vary: {setting}")
    for method in experiment["methods"]:
        module = planner_module(study.planner(method))
        for problem in experiment["problems"]:
            kind = study.kind_of(problem)
            if kind not in getattr(module, "workspaces", (kind,)):
                served = ", ".join(module.workspaces)
                raise Fault(f"{place}: methods: {method}: its planner serves workspaces of kind {served}, not {kind} ({problem})")
            if hasattr(module, "serves"):
                try:
                    module.serves(_built(study, problem))
                except ValueError as error:
                    raise Fault(f"{place}: methods: {method}: problem {problem}: {error}") from None
        described = job(study, name, method, "full", 0)
        # One problem for each set of settings that go with problems.
        apart = {str(place.get("settings")): problem for problem, place in reversed(described["problems"].items())}
        for condition in conditions(list(apart.values()), experiment.get("vary", {})):
            where = f"{place}: vary: {condition.name}: {method}" if condition.values else f"{place}: methods: {method}"
            _check_settings(module, settings_in(described, condition), where)


def _columns(study: Study, experiment: str) -> set[str]:
    """Columns of the runs table of an experiment that a selection may name."""
    methods = study.methods_of(experiment)
    places = {key for problem in study.problems_of(experiment, "smoke").values() for key in PLACE if key in problem}
    varied = study.experiments[experiment].get("vary", {})
    settings = (setting for name in methods for setting in study.resolved(name))
    return {"straight_line", "bound", "bound8", *RUN_COLUMNS, *places, *varied, *settings}


def _check_where(study: Study, experiment: str, where: dict, place: str) -> None:
    for column, wanted in where.items():
        _known(column, _columns(study, experiment), place)
        for value in wanted if isinstance(wanted, list) else [wanted]:
            if column == "method":
                _known(value, study.methods_of(experiment), f"{place}: method")
            if column == "problem":
                _known(value, study.problems_of(experiment, "full"), f"{place}: problem")


def _check_table(study: Study, table: dict, place: str) -> None:
    if table["kind"] == "transcribed":
        _found(study.folder / "published" / table["published"], f"{place}: published")
        return
    if table["kind"] == "comparison":
        for name in table["of"]:
            _known(name, [each for each, other in study.compared().items() if "published" in other], f"{place}: of")
        for metric in table["metrics"]:
            _known(metric, metrics.METRICS, f"{place}: metrics")
        return
    if table["kind"] == "function":
        _known(table["function"], _functions(study), f"{place}: function")
        return
    _known(table["experiment"], study.experiments, f"{place}: experiment")
    experiment = table["experiment"]
    for key in ("where", "decides"):
        _check_where(study, experiment, table.get(key, {}), f"{place}: {key}")
    for key in ("index", "columns"):
        for column in table.get(key, []):
            _known(column, {"value", "statistic", *_columns(study, experiment)}, f"{place}: {key}")
    for number, value in enumerate(table["values"]):
        _known(value["metric"], metrics.METRICS, f"{place}: values: {number}: metric")
        for name in _listed(value["statistic"]):
            _known(name, statistics.STATISTICS, f"{place}: values: {number}: statistic")
        _check_where(study, experiment, value.get("where", {}), f"{place}: values: {number}: where")
    if "published" in table:
        _check_published(study, experiment, study.folder / "published" / table["published"], place)


def _found(file: Path, place: str) -> None:
    if not file.is_file():
        raise Fault(f"{place}: {file.name}: no such file in {relative(file.parent)}")


def _check_published(study: Study, experiment: str, file: Path, place: str) -> None:
    """A file of published numbers: its columns, its key columns, and in every row known names and numbers. Raises Fault."""
    _found(file, f"{place}: published")
    with open(file, encoding="utf-8", newline="") as text:
        reader = csv.DictReader(text, restkey="")
        place = relative(file)
        header = reader.fieldnames or []
        for column in PUBLISHED_COLUMNS:
            if column not in header:
                raise Fault(f"{place}: line 1: column {column} is missing; expected key columns, {', '.join(PUBLISHED_COLUMNS)}")
        for column in header:
            if column not in PUBLISHED_COLUMNS:
                _known(column, _columns(study, experiment), f"{place}: line 1: column")
        for row in reader:
            where = f"{place}: line {reader.line_num}"
            if "" in row or None in row.values():
                raise Fault(f"{where}: expected {len(header)} values, one a column")
            _known(row["metric"], metrics.METRICS, f"{where}: metric")
            _known(row["statistic"], statistics.STATISTICS, f"{where}: statistic")
            for column, needed in (("value", True), ("n", False)):
                if not _is_number(row[column]) and (needed or row[column]):
                    raise Fault(f"{where}: {column}: {row[column]!r}; expected a number")
            if "method" in row:
                _known(row["method"], study.methods_of(experiment), f"{where}: method")
            if "problem" in row:
                _known(row["problem"], study.problems_of(experiment, "full"), f"{where}: problem")


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def _check_panel(study: Study, panel: dict, place: str) -> None:
    if "workspace" in panel:
        _known(panel["workspace"], study.workspaces, f"{place}: workspace")
    if "data" in panel:
        _known(panel["data"], _functions(study), f"{place}: data")
    if "experiment" not in panel:
        return
    _known(panel["experiment"], study.experiments, f"{place}: experiment")
    _check_where(study, panel["experiment"], panel.get("where", {}), f"{place}: where")
    for word, value in panel.get("pick", {}).items():
        if word != "repeat":
            _known(value, _columns(study, panel["experiment"]), f"{place}: pick: {word}")
