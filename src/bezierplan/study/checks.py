"""Checks across the files of a study: names that other files define, planners and their settings,
free places, matching published numbers. Each fault is one line, and all are found in one pass.
"""

import difflib
import inspect
import itertools
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import Field, create_model

from bezierplan.analysis import metrics, statistics, study_code
from bezierplan.analysis.claims.check import ClaimCheck, OfRuns
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.comparisons import find_mixed_factor, list_unit_columns
from bezierplan.analysis.claims.variants import apply_variant, list_variants
from bezierplan.analysis.outcome import texts
from bezierplan.analysis.results import select
from bezierplan.analysis.table_kinds import Pivot, TableEntry
from bezierplan.figures.figure import Figure
from bezierplan.figures.panels import Panel
from bezierplan.places import shorten_path
from bezierplan.planners import is_file, list_planners, load_planner, read_settings
from bezierplan.running import columns, problems
from bezierplan.running.execution import resolve_settings
from bezierplan.running.guard import interface
from bezierplan.schema.checked import Fault, check_all, check_known, read_text
from bezierplan.schema.model import Model, convert_to_list, find_names, identify, parse
from bezierplan.schema.safe_text import describe_in_one_line
from bezierplan.study import published
from bezierplan.study.alternatives import apply_values, is_judged
from bezierplan.study.claims import AssumptionEntry, ReadingEntry
from bezierplan.study.definition import Study
from bezierplan.study.design import build_design, join_designs
from bezierplan.study.experiments import Experiment, Method, ProblemEntry, build_descriptions
from bezierplan.study.jobs import build_chunk
from bezierplan.workspaces import files
from bezierplan.workspaces.kinds import Workspace
from bezierplan.workspaces.problem import Problem

RESERVED = columns.TAKEN.union(columns.WORDS) - {"generations"}
"""Names that no setting can have. `generations` is allowed: the column holds the number actually
performed, so a setting of that name adds nothing.
"""


class Follows(Exception):
    """A fault that follows from one that is told already, so that no line tells it."""

    lines = ()


class Checks:
    """Check a study whose files are each valid on their own. The methods raise Fault without the
    place, which `at` adds.

    omissions: section and name of entries that are left out because they are not valid.
    """

    def __init__(self, study: Study, omissions: Sequence[tuple[str, str]] = ()) -> None:
        self.study, self.invalid = study, {name for _, name in omissions}
        # A method with a fault may have any settings.
        self.complete = "methods" not in {section for section, _ in omissions}
        self.faults: dict[str, tuple[str, ...]] = {}
        self.words, self.broken_files = {"generation"}, set()
        self._place = ()
        self.design = cache(lambda experiment: build_design(self.study, experiment))
        # The planned runs of experiments; for a claim, without those of baselines.
        self.runs = cache(
            lambda experiments, claim: join_designs(
                [*map(self.design, experiments)], study.baselines if claim else ()
            )
        )
        self.build_problem = cache(self._build_problem)
        self.known = {
            "experiment": [*study.experiments],
            "workspace": study.workspaces,
            "problem": study.problems,
            "drawn problem": study.every_problem(),
            "method": study.methods,
            "own method": study.methods.keys() - study.baselines,
            "baseline": study.baselines,
            "policy": study.policies,
            "function": study_code.load_functions(study.code_for("functions")),
            "world": study_code.load_part(study.code_for("worlds"), "worlds"),
            "drawing": study_code.load_part(study.code_for("panels"), "panels"),
            "statistic": statistics.STATISTICS,
            "artefact": study.tables | study.figures,
            "printed table": [Path(file).stem for file in study.list_published_files()],
            "claim": [claim.id for claim in study.claims],
        }

    @contextmanager
    def at(self, *place: str) -> Iterator[None]:
        """Name a place in the files for the faults of a block. A fault ends the block, not the
        checks after it.
        """
        outer, self._place = self._place, (*self._place, *place)
        try:
            yield
        except Exception as error:
            fault = isinstance(error, ValueError)
            for line in getattr(
                error, "lines", [str(error) if fault else describe_in_one_line(error)]
            ):
                told = [place for each, place in self.faults.items() if each.endswith(line)]
                if fault:
                    # Equal words follow from the first, unless they are about another entry of its
                    # section.
                    here = self._place
                    follows = any(at[:2] != here[:2] or at[:3] == here[:3] for at in told)
                else:
                    # Our own code fails like this where an entry is missing that is left out.
                    follows = bool(told) or not self.invalid.isdisjoint(map(str, error.args))
                if not follows:
                    self.faults[": ".join([*self._place, line])] = self._place
            self.invalid.update(self._place[2:3])
        finally:
            self._place = outer

    def check_entries(
        self, section: str, entries: dict[str, Any], work: Callable[[str, Any], None]
    ) -> None:
        """Call `work` on each entry of a section of a file, and drop the entries that have a fault
        from `entries`, in place.
        """
        # A copy, because entries with a fault leave the mapping.
        for name, entry in [*entries.items()]:
            with self.at(section, name):
                work(name, entry)
            if name in self.invalid:
                entries.pop(name)

    def check(self) -> list[str]:
        """Return all faults, one line each."""
        study = self.study
        with self.at(shorten_path(study.folder / "experiments.yaml")):
            # Methods come first: all that follows loads their planners.
            declared = len(study.methods)
            self.check_entries("methods", study.methods, self.check_method)
            self.complete &= len(study.methods) == declared
            with self.at():
                self.check_shared_settings()
            if self.complete:
                self.check_entries(
                    "methods", {**study.methods}, lambda name, _: self.check_settings(study, name)
                )
            self.check_entries("workspaces", study.workspaces, self.check_workspace)
            self.check_entries("problems", study.problems, self.check_problem)
            self.check_entries("experiments", study.experiments, self.check_experiment)
            if compared := study.baseline_comparison:
                with self.at("baseline_comparison"):
                    self.check_names(compared)
                    for name in compared.experiments:
                        check_known(compared.baseline, study.methods_of(name), f"{name}: baseline")
                    for name, family in compared.families.items():
                        with self.at("families", name):
                            check_known(family.experiment, compared.experiments, "experiment")
                            listed = study.experiments[family.experiment].problems
                            check_all(family.problems, listed, "problems")
        with self.at():
            named = " ".join(read_text(file, "") for file in study.folder.glob("*.yaml"))
            # A file that no table names would never be compared, without a word.
            for file in map(Path, study.list_published_files()):
                header = {*next(iter(published.read(file).values()))}
                if header.issuperset(published.COLUMNS) and file.stem not in named:
                    raise Fault(f"{file}: no table names it; expected published: {file.name}")
            if file := study.verdict_file():
                texts.read(file)
        with self.at(shorten_path(study.folder / "artefacts.yaml")):
            self.check_entries("tables", study.tables, self.check_table)
            self.check_entries("figures", study.figures, self.check_figure)
            self.check_labels()
        with self.at(shorten_path(study.folder / "layout.yaml")):
            sound = [name for name in study.layout if name not in self.invalid]
            check_all(sound, study.tables | study.figures, "layout")
        for file, section, key, work in (
            ("claims", "claims", "id", self.check_claim),
            ("assumptions", "assumptions", "id", self.check_assumption),
            ("assumptions", "readings", "folder", self.check_reading),
        ):
            with self.at(shorten_path(study.folder / f"{file}.yaml")):
                entries = getattr(study, section)
                # Results are looked up by it.
                names = [getattr(each, key) for each in entries]
                for name in names:
                    if names.count(name) > 1:
                        raise Fault(f"{section}: {name}: another one has this id already")
                self.check_entries(section, dict(zip(names, entries)), work)
        with self.at(shorten_path(study.folder / "assumptions.yaml"), "fitted"):
            check_all(study.fitted.keys() - self.invalid, study.find_published_tables(), "table")
            for table, fitted in study.fitted.items():
                check_all(fitted, [each.metric for each in study.tables[table].values], table)
        return [*self.faults]

    # experiments.yaml

    def check_method(self, name: str, method: Method) -> None:
        """Check that a method's planner has the interface of one, and that none of its settings and
        columns has the name of a column of results.
        """
        self.check_names(method)
        location = f"planner: {method.planner}"
        if is_file(method.planner):
            if method.planner in self.broken_files:
                raise Follows
            check_inside(self.study.folder, method.planner, location)
            # Until it has passed, other methods with this file only follow from its fault.
            self.broken_files.add(method.planner)
        else:
            check_known(method.planner, list_planners(), "planner", f"{method.planner}.py")
        module = interface.load_planner_module(self.study.planner(name), location)
        extra = getattr(module, "extra", ())
        for taken in RESERVED.intersection([*read_settings(module), *extra]):
            raise Fault(f"{location}: its {taken} is a column of results; give it another name")
        self.broken_files.discard(method.planner)
        interface.refuse_unknown(module, method.settings, "settings")
        if (
            method.policy
            and self.study.policies[method.policy].warm
            and not hasattr(module, "resume")
        ):
            raise Fault(f"policy: {method.policy}: warm, but its planner has no function resume")
        # Panels and claims can use what the planner reports as a metric.
        metrics.add_columns(extra)

    def check_shared_settings(self) -> None:
        """Check that each setting belongs to some planner, or to the one that it is under."""
        study = self.study
        planners = {method.planner: name for name, method in study.methods.items()}
        used = {setting for name in study.methods for setting in study.read_accepted_settings(name)}
        # Only now, since what a planner accepts is known once its file has been checked.
        self.known["setting"] = used
        if not self.complete:
            return
        check_all(study.of_planners, planners, "settings")
        check_all(study.settings.keys() - study.of_planners, used, "settings")
        for planner, settings in study.of_planners.items():
            check_all(
                settings, study.read_accepted_settings(planners[planner]), f"settings: {planner}"
            )

    def check_settings(self, study: Study, name: str) -> None:
        """Check that each setting of a method has a value that its planner accepts, also on
        problems where an assumption changes it.
        """
        chosen = [each for each in study.assumptions if each.id in study.values]
        for problem in dict.fromkeys(["", *(name for each in chosen for name in each.problems)]):
            settings = study.resolve_settings(name) | study.find_changed_settings(name, problem)
            try:
                interface.check_settings(load_planner(study.planner(name)), settings, "settings")
            except Fault as fault:
                # Methods share most settings, and a wrong one of all is told once.
                own = any(f": {key}: " in str(fault) for key in study.methods[name].settings)
                if not own and any(each.endswith(str(fault)) for each in self.faults):
                    raise Follows from None
                raise

    def check_workspace(self, name: str, workspace: Workspace) -> None:
        """Check that a workspace's map can be read."""
        self.check_names(workspace)
        # Maps of other kinds follow from a problem, and `check_problem` builds them.
        if not workspace.drawn_kind and not workspace.moves:
            files.load(workspace.plain(), self.study.folder)

    def check_problem(self, name: str, problem: ProblemEntry) -> None:
        """Check that a problem has the keys of its kind of workspace, and that its ends lie in free
        space.
        """
        self.check_names(problem)
        if self.complete:
            check_all(problem.settings, self.known["setting"], "settings")
        home = self.study.workspace_of(name)
        for key, needed in (("layouts", bool(home.drawn_kind)), ("side", home.with_side)):
            if needed != (getattr(problem, key) is not None):
                raise Fault(
                    f"workspace: {problem.workspace}: of kind {home.kind}, which "
                    f"{'needs' if needed else 'has no'} {key}"
                )
        if home.drawn_kind and problem.start is None:
            raise Fault(f"start_cell: {problem.start_cell}: expected start: [x, y] in a drawn map")
        self.build_problem(name)

    def _build_problem(self, name: str) -> Problem:
        """Return a problem as planners see it; in the first layout and with the most obstacles if
        these are drawn. Raises ValueError.
        """
        study, problem, home = self.study, self.study.problems[name], self.study.workspace_of(name)
        # With fewer circles of the same layout, the ends are free too.
        drawn = {"layout": 0, "obstacles": max(problem.obstacles)} if home.drawn_kind else {}
        described = build_descriptions(study, {name: problem.plain("layouts") | drawn})
        return problems.build_all(described, study.folder)[0][name]

    def check_experiment(self, name: str, experiment: Experiment) -> None:
        """Check that the problems and methods of an experiment suit each other, and that what it
        varies exists.
        """
        self.check_names(experiment)
        study, moves = self.study, self.study.moves(name)
        for problem in experiment.problems:
            if study.workspace_of(problem).moves != moves:
                raise Fault(
                    f"problems: {problem}: its workspace does not move; expected problems that all "
                    "move, or none"
                )
        for method in experiment.methods:
            if moves != bool(study.methods[method].policy):
                raise Fault(
                    f"methods: {method}: {'needs' if moves else 'has'} a policy, which experiments "
                    "in worlds that move need, and no others"
                )
        accepted = {
            setting
            for method in experiment.methods
            for setting in study.read_accepted_settings(method)
        }
        check_all(experiment.vary, accepted, "vary")
        # A baseline joins without being listed.
        factors = {"method": [*experiment.methods, *study.baselines]} | experiment.vary
        factors["problem"] = experiment.problems
        check_all(experiment.fewer, factors, "fewer")
        for factor, fewer in experiment.fewer.items():
            check_all(fewer, map(str, factors[factor]), f"fewer: {factor}")
        for method in experiment.methods:
            self.check_method_in(name, experiment, method)

    def check_method_in(self, name: str, experiment: Experiment, method: str) -> None:
        """Check that a method's planner serves the problems of an experiment, and that its settings
        are valid under each condition.
        """
        study, where = self.study, f"methods: {method}"
        module = load_planner(study.planner(method))
        for problem in experiment.problems:
            kind = study.kind_of(problem)
            # A planner that names no kinds serves all.
            if kind not in getattr(module, "workspaces", (kind,)):
                served = ", ".join(module.workspaces)
                raise Fault(
                    f"{where}: its planner serves workspaces of kind {served}, not {kind} "
                    f"({problem})"
                )
            if hasattr(module, "serves"):
                interface.ask(
                    module.serves, f"{where}: problem {problem}", self.build_problem(problem)
                )
        if not self.complete or method in self.invalid:
            return
        described = build_chunk(study, name, method, "full", 0)
        # One problem for each distinct set of problem settings.
        apart = {
            str(met.get("settings")): (problem, met)
            # Backwards, so that the first problem with these settings stays, and a fault names it.
            for problem, met in reversed(described.problems.items())
        }
        for condition in described._replace(problems=dict(apart.values())).conditions():
            varied = f"vary: {condition.name}: {method}" if condition.values else where
            interface.check_settings(
                module, resolve_settings(described, condition), f"{varied}: settings"
            )

    # Names defined elsewhere

    def check_names(self, model: Model) -> None:
        """Check that the names in a model refer to something that exists.

        The columns of a panel without runs are not checked: its function makes them.
        """
        experiments = convert_to_list(getattr(model, "experiment", None) or [])
        claim = isinstance(model, ClaimCheck)
        for path, what, name in find_names(model):
            key = ": ".join(path[:-1] if path[-1].isdecimal() else path)
            self.words.add(str(name))
            if what in self.known and name not in self.invalid:
                home = {"function": "functions.py", "drawing": "panels.py", "world": "worlds.py"}
                check_known(name, self.known[what], key, home.get(what, ""))
            elif what in ("file", "published"):
                folder = "published/" if what == "published" else ""
                check_inside(self.study.folder, f"{folder}{name}", f"{key}: {name}")
            elif experiments:
                self.check_name_in_runs(tuple(experiments), claim, what, name, key)
            if what in ("function", "world") and len(path) == 1:
                self.check_arguments(self.known[what][name], getattr(model, "arguments", {}))

    def check_name_in_runs(
        self, experiments: tuple[str, ...], claim: bool, what: str, name: Any, key: str
    ) -> None:
        """Check that the runs of some experiments have a metric, a column, a selection, a repeat or
        a problem.

        what: the kind of name, as `Names` says. key: the key in the file, for messages.
        """
        runs = self.runs(experiments, claim)
        match what:
            case "metric":
                for each in experiments:
                    self.design(each).check_metric(name, key)
            case "column" | "number column" | "quantity":
                runs.check_column(name, what, key)
            case "level" if name not in ("value", "statistic"):
                runs.check_column(name, "column", key)
            case "where":
                runs.check_where(name, key, claim)
            case "repeat":
                runs.check_repeat(name, key)
            case "problem of runs":
                check_known(name, runs.values("problem"), key)

    def check_arguments(self, function: Callable, arguments: dict[str, Any]) -> None:
        """Check that a function's keyword-only arguments are given, each of the type that its
        annotation says.
        """
        accepted = {
            each.name: (
                each.annotation,
                Field(
                    description=f"{inspect.formatannotation(each.annotation)}, as the function "
                    "declares"
                ),
            )
            for each in inspect.signature(function).parameters.values()
            if each.kind is each.KEYWORD_ONLY
        }
        parse(create_model("Arguments", __base__=Model, **accepted), arguments, "arguments")

    # artefacts.yaml

    def check_table(self, name: str, table: TableEntry) -> None:
        """Check that the names of a table exist, and that its file of published numbers fits it."""
        self.check_names(table)
        if not isinstance(table, Pivot):
            return
        for number, entry in enumerate(table.values):
            with self.at("values", str(number)):
                check_share(entry)
        if table.published:
            runs = self.design(table.experiment)
            published.check(self.study, runs, table)
            runs.check_where(table.primary, "primary")

    def check_labels(self) -> None:
        """Check that looks belong to methods, that labels tell methods apart, and that each label
        belongs to a name that the study uses.
        """
        study = self.study
        check_all(study.looks.keys() - self.invalid, study.methods, "looks")
        printed: dict[str, str] = {}
        for name in study.methods:
            label = study.labels.get(name, name)
            if (other := printed.setdefault(label, name)) != name:
                raise Fault(f"labels: {other}, {name}: both {label}; expected a label for each")
        # A misspelt name is most likely one of the study's own, so these are suggested first.
        own = re.findall(r"[\w.+-]+", read_text(study.folder / "experiments.yaml", ""))
        words = {*own, *metrics.METRICS, *statistics.STATISTICS, *RESERVED, *self.words}
        for each in (study, *study.tables.values()):
            for name in getattr(each, "labels", {}).keys() - words:
                near = difflib.get_close_matches(name, own)
                check_known(name, near or words, "labels")

    def check_figure(self, name: str, figure: Figure) -> None:
        """Check that the names in a figure's panels exist."""
        if name in self.study.tables:
            raise Fault("a table has this name already")
        for panel in figure.panels:
            with self.at("panels", panel.place):
                self.check_names(panel)
                check_share(panel)
                self.check_panel(panel)

    def check_panel(self, panel: Panel) -> None:
        """Check that a panel's runs are of the kind that it shows, and of one method if it shows
        one run, and that its claim rests on runs.
        """
        for claim in self.study.claims:
            if claim.id == getattr(panel, "claim", None) and not is_judged(claim):
                raise Fault(f"claim: {claim.id}: rests on times or on no runs, so nothing turns it")
        if not (experiment := getattr(panel, "experiment", None)):
            return
        if panel.drives and not self.study.moves(experiment):
            raise Fault(
                f"experiment: {experiment}: nothing moves there; expected an experiment of drives"
            )
        methods = convert_to_list(
            panel.where.get("method", self.study.experiments[experiment].methods)
        )
        if "method" in panel.one and len(methods) > 1 and getattr(panel, "hue", None) != "method":
            raise Fault(
                f"where: selects {len(methods)} values of method; expected one, which is shown"
            )

    # claims.yaml and assumptions.yaml

    def check_claim(self, identity: str, claim: Claim) -> None:
        """Check that the names in a claim's checks exist, and that its variants select runs."""
        self.check_names(claim)
        first, *_ = list_variants(claim)
        judged = apply_variant(claim.checks, first, first)
        for number, check in enumerate(claim.checks):
            with self.at("checks", str(number)):
                self.check_names(check)
                if check.cells and check.experiments:
                    values = self.runs(tuple(check.experiments), True).values(check.cells)
                    check_all(set(check.groups_named) - {"rest"}, values, "group")
                if isinstance(check, OfRuns):
                    self.check_unmixed(judged[number])
        experiments = {name: None for check in claim.checks for name in check.experiments}
        known = {"metric": metrics.METRICS, "experiment": self.study.experiments}
        for column, entries in claim.variants.items():
            for value in (each for entry in entries for each in convert_to_list(entry)):
                if value in self.invalid:
                    continue
                if column in known:
                    check_known(value, known[column], f"variants: {column}")
                elif experiments:
                    self.runs(tuple(experiments), True).check_where(
                        {column: value}, "variants", claim=True
                    )

    def check_unmixed(self, check: OfRuns) -> None:
        """Check that each unit of a comparison has runs of one experiment, condition and method."""
        rows = self.runs(tuple(check.experiments), True).rows
        planned = check.where.keys() & {*rows} - {"repeat"}
        rows = select(rows, {column: check.where[column] for column in planned})
        # Ranks are taken among the runs of an artefact alone.
        factor = "" if check.metric == "rank" else find_mixed_factor(check, rows)
        if factor:
            vary = [self.study.experiments[name].vary for name in check.experiments]
            columns = dict.fromkeys(["problem", *itertools.chain(*vary)])
            apart = list_unit_columns(check)
            several = [name for name in columns if name not in apart and rows[name].nunique() > 1]
            raise Fault(
                f"mixes several values of {factor}; expected every: "
                f"[{', '.join(several) if factor == 'condition' else factor}], or pool, or where "
                "with one of them"
            )

    def check_assumption(self, identity: str, assumption: AssumptionEntry) -> None:
        """Check that an assumption's names are those of the study, and that each alternative is a
        valid value of what it governs.
        """
        self.check_names(assumption)
        study = self.study
        for name, key in assumption.workspace.items():
            if name in self.invalid:
                continue
            check_known(name, study.workspaces, "workspace")
            workspace = study.workspaces[name]
            check_known(key, workspace.plain(), f"workspace: {name}")
            if (used := workspace.plain()[key]) != assumption.default:
                raise Fault(f"default: {assumption.default}: expected {used}, which {name} has")
            for value in assumption.alternatives:
                with self.at("alternatives", str(value), name):
                    self.check_names(
                        type(workspace).model_validate(workspace.plain() | {key: value})
                    )
        if not assumption.setting:
            return
        methods = study.list_governed_methods(assumption)
        # A planner with a fault may have any settings.
        if not methods and self.complete:
            used = self.known["setting"] - {assumption.setting}
            check_known(assumption.setting, used, "setting")
        for method, settings in assumption.along.items():
            if method in self.invalid:
                continue
            check_known(method, methods, "with")
            check_all(settings, study.read_accepted_settings(method), f"with: {method}")
        for value in assumption.alternatives:
            changed = apply_values(study, {identity: value})
            for method in methods:
                with self.at("alternatives", str(value), method):
                    self.check_settings(changed, method)

    def check_reading(self, name: str, reading: ReadingEntry) -> None:
        """Check that a reading's values are alternatives which a run can have all at once, and that
        its claims rest on runs.
        """
        study, settled = self.study, {}
        known = {each.id: each for each in study.assumptions}
        for key, value in reading.values.items():
            if key in self.invalid:
                continue
            check_known(key, known, "values")
            assumption = known[key]
            if not (assumption.setting or assumption.workspace):
                raise Fault(f"values: {key}: governs no setting, so that no run can have it")
            if assumption.excluded_by:
                raise Fault(f"values: {key}: excluded by {assumption.excluded_by}")
            # True equals 1 in Python, but is another value of a setting.
            if identify(value) not in map(identify, assumption.alternatives):
                raise Fault(
                    f"values: {key}: {value!r}: no alternative; one of {assumption.alternatives}"
                )
            for method in study.list_governed_methods(assumption):
                # Two assumptions about one setting of a method could not both hold.
                place = (method, assumption.setting, *assumption.problems)
                if other := settled.get(place):
                    raise Fault(f"values: {key}: governs what {other} does, {assumption.setting}")
                settled[place] = key
        for other in study.readings:
            if other.values == reading.values and other is not reading:
                raise Fault(f"values: {other.name} has the same; expected one for all claims")
        claims = {claim.id: claim for claim in study.claims}
        for claim in set(reading.claims) - self.invalid:
            check_known(claim, claims, "claims")
            if not is_judged(claims[claim]):
                raise Fault(
                    f"claims: {claim}: rests on times or on no runs, so nothing can turn it"
                )
        if self.complete and not self.invalid:
            changed = apply_values(study, reading.values)
            for method, *_ in settled:
                with self.at("values", method):
                    self.check_settings(changed, method)


def check_share(entry: Model) -> None:
    """Raise Fault for the share of a metric that has a unit, so that it is not true or false."""
    metric = getattr(entry, "metric", "")
    unit = metrics.METRICS[metric].unit
    if "share" in convert_to_list(getattr(entry, "statistic", "")) and unit != "-":
        raise Fault(f"statistic: share: of {metric}; expected a metric that is true or false")


def check_inside(folder: Path, name: str, location: str) -> None:
    """Raise Fault, beginning with a location, unless a file of a study is a regular file inside its
    folder; links are followed.
    """
    file = folder / name
    if not file.resolve().is_relative_to(folder.resolve()):
        raise Fault(f"{location}: lies outside the study's folder; expected a file in it")
    if not file.is_file():
        raise Fault(f"{location}: no such file in {file.parent.name or file.parent}")
