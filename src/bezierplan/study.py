"""Studies, and the jobs, inputs and targets that follow from them.

A study is a paper of this project or a reader's own folder of the same form (config/README.md); `study_file` reads and checks it.
"""

import dataclasses
import importlib.util
import itertools
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bezierplan.problem import PLACE, planner_module, planner_settings
from bezierplan.workspaces import files

SCALES = ("smoke", "full", "extended")

TIME_LIMIT = 600
"""Seconds after which a run is ended, where an experiment does not say."""

DRAWN = {"random_circles": "circles", "random_field": "grid", "random_blocks": "grid"}
"""Kinds of workspace that are drawn at random -> the kind that planners meet."""

CELLS = ("raster", "ros_map", "moving_ai")
"""Kinds of workspace read from files that planners meet as grids."""


@dataclass(frozen=True)
class Study:
    """A study as its files say it. key: its name; folder: where it lies; the others: experiments.yaml, artefacts.yaml, claims.yaml and
    assumptions.yaml.

    methods: controls as well; controls: their names.
    """

    key: str
    folder: Path
    title: str
    methods: dict[str, dict]
    controls: frozenset[str]
    settings: dict[str, Any]
    levels: dict[str, dict[str, dict]]
    workspaces: dict[str, dict]
    problems: dict[str, dict]
    experiments: dict[str, dict]
    labels: dict[str, str]
    tables: dict[str, dict]
    figures: dict[str, dict]
    claims: list[dict]
    assumptions: list[dict]

    def resolved(self, method: str) -> dict[str, Any]:
        """All settings of a method, by name: the study's where its planner has them, and its own."""
        accepted = planner_settings(planner_module(self.planner(method)))
        common = {name: value for name, value in self.settings.items() if name in accepted}
        return common | self.methods[method].get("settings", {})

    def settings_on(self, problem: dict, method: str) -> dict[str, dict]:
        """Settings that go with a described problem, as {"settings": ...}: those that a method's planner has and the method itself leaves
        open; empty without any.
        """
        accepted = planner_settings(planner_module(self.planner(method))).keys() - self.methods[method].get("settings", {}).keys()
        settings = {name: value for name, value in problem.get("settings", {}).items() if name in accepted}
        return {"settings": settings} if settings else {}

    def planner(self, method: str) -> str:
        """The planner of a method: a name, or the path of a file as seen from here."""
        planner = self.methods[method]["planner"]
        return relative(self.folder / planner) if planner.endswith(".py") else planner

    def methods_of(self, experiment: str) -> list[str]:
        """Methods of an experiment, and behind them the controls that serve all its workspaces."""
        content = self.experiments[experiment]
        kinds = {self.kind_of(problem) for problem in content["problems"]}
        return content["methods"] + [name for name in self.methods if name in self.controls and self._serves(name, kinds, content)]

    def _serves(self, control: str, kinds: set[str], experiment: dict) -> bool:
        """Whether a control can join: its planner serves these kinds of workspace, and has no setting that the experiment varies."""
        module = planner_module(self.planner(control))
        varied = set(experiment.get("vary", {})) & set(planner_settings(module))
        return kinds <= set(getattr(module, "workspaces", kinds)) and not varied

    def kind_of(self, problem: str) -> str:
        """The kind of workspace that planners meet in a problem."""
        kind = self.workspaces[self.problems[problem]["workspace"]]["kind"]
        return "grid" if kind in CELLS else DRAWN.get(kind, kind)

    def problems_of(self, experiment: str, scale: str) -> dict[str, dict]:
        """Descriptions of an experiment's problems, by name. One with layouts stands for a problem each layout and number of obstacles."""
        described = {}
        for name in self.experiments[experiment]["problems"]:
            problem = self.problems[name]
            if "layouts" not in problem:
                described[name] = problem
                continue
            same = {key: value for key, value in problem.items() if key not in ("layouts", "obstacles")}
            for layout, obstacles in itertools.product(range(problem["layouts"][scale]), problem["obstacles"]):
                described[f"{name}_{layout}_{obstacles}"] = same | {"layout": layout, "obstacles": obstacles}
        return described

    def maps(self, workspaces: Iterable[str]) -> list[str]:
        """Map files of workspaces as seen from here, each once."""
        return sorted({relative(file) for name in workspaces for file in files.sources(self.workspaces[name], self.folder)})

    def compared(self) -> dict[str, dict]:
        """The tables of runs, which are compared with published numbers; the others stand for themselves (`listing_job`)."""
        return {name: table for name, table in self.tables.items() if table["kind"] == "pivot"}

    def published_file(self, table: str) -> str | None:
        """The file of a table's published numbers as seen from here, or None."""
        file = self.tables[table].get("published")
        return file and relative(self.folder / "published" / file)

    def published_files(self) -> list[str]:
        """All files of published numbers as seen from here."""
        return [relative(file) for file in sorted((self.folder / "published").glob("*.csv"))]

    def module(self) -> str | None:
        """The module with what only this study needs, or None."""
        name = f"bezierplan.studies.{self.key}"
        return name if importlib.util.find_spec(name) else None


def relative(path: Path) -> str:
    """A path from the working folder if it lies inside, so that a moved tree finds its results again; otherwise as it is."""
    here = os.path.relpath(path)
    return str(path) if here.startswith("..") else here


# What a script gets to see is a job: plain values only, so that Snakemake can tell whether one changed.


def problems_job(study: Study, experiment: str, scale: str) -> dict:
    """What the problems of an experiment depend on, the content of map files apart."""
    described = {
        name: {key: value for key, value in problem.items() if key != "settings"}
        for name, problem in study.problems_of(experiment, scale).items()
    }
    workspaces = {name: study.workspaces[name] for name in sorted({problem["workspace"] for problem in described.values()})}
    return {"study": study.key, "problems": described, "workspaces": workspaces}


def job(study: Study, experiment: str, method: str, scale: str, chunk: int) -> dict:
    """A chunk of runs, as `running.run_chunk` takes it. A chunk is run whole, whatever the number of repeats asked for."""
    content = study.experiments[experiment]
    size = content["chunk"][scale]
    return {
        "study": study.key,
        "experiment": experiment,
        "method": method,
        "planner": study.planner(method),
        "settings": {name: value for name, value in study.resolved(method).items() if name not in content.get("vary", {})},
        "problems": {
            name: _place(problem) | study.settings_on(problem, method) for name, problem in study.problems_of(experiment, scale).items()
        },
        "vary": content.get("vary", {}),
        "levels": {name: level for name, level in study.levels.items() if name in content.get("vary", {})},
        "seeds": content.get("seeds", "own"),
        "time_limit": content.get("time_limit", TIME_LIMIT),
        "repeats": [chunk * size, (chunk + 1) * size],
    }


def _place(problem: dict) -> dict:
    """What the runs table says of a problem's place."""
    return {key: problem[key] for key in PLACE if key in problem}


def chunks(study: Study, experiment: str, scale: str) -> range:
    """Numbers of the chunks that hold the repeats of an experiment at a scale."""
    content = study.experiments[experiment]
    return range(-(-content["repeats"][scale] // content["chunk"][scale]))


def table_job(study: Study, table: str, scale: str) -> dict:
    """What a table depends on beside runs, problems, bounds and the file of published numbers."""
    spec = study.tables[table]
    experiment = study.experiments[spec["experiment"]]
    # The experiment's own methods unless the table chooses: controls stand in the comparison alone.
    where = {"method": experiment["methods"]} | spec.get("where", {})
    return {
        "name": f"{study.key}/{table}",
        "spec": spec | {"where": where},
        "labels": study.labels,
        "variants": {name: study.methods[name]["variant_of"] for name in experiment["methods"] if "variant_of" in study.methods[name]},
        "controls": [name for name in study.methods_of(spec["experiment"]) if name in study.controls],
        "repeats": experiment["repeats"][scale],
        "unit": _unit(study, spec["experiment"]),
    }


def listing_job(study: Study, table: str) -> dict:
    """What a table depends on that shows no runs, beside the files of published numbers."""
    return {"spec": study.tables[table], "module": study.module(), "labels": study.labels}


def figure_job(study: Study, figure: str, scale: str) -> dict:
    """What a figure depends on beside runs, problems and bounds, and map files where it draws a workspace without runs."""
    spec = study.figures[figure]
    experiments = experiments_of(study, figure)
    bare = sorted({panel["workspace"] for panel in spec["panels"] if "workspace" in panel})
    return {
        "spec": spec,
        "module": study.module(),
        "labels": study.labels,
        "workspaces": {name: study.workspaces[name] for name in bare},
        "repeats": {name: study.experiments[name]["repeats"][scale] for name in experiments},
        "jobs": _jobs_made_again(study, figure, scale),
        "unit": _unit(study, experiments[0])
        if experiments
        else study.workspaces[bare[0] if bare else next(iter(study.workspaces))]["unit"],
    }


def _jobs_made_again(study: Study, figure: str, scale: str) -> dict[str, dict[str, dict]]:
    """The jobs of runs that a figure makes again, to draw what no table keeps: experiment -> method -> job."""
    again = {panel["experiment"] for panel in study.figures[figure]["panels"] if panel["kind"] == "tracks"}
    return {name: {method: job(study, name, method, scale, 0) for method in methods_of(study, figure, name)} for name in sorted(again)}


def _unit(study: Study, experiment: str) -> str:
    """The unit of length of an experiment, that of its first problem's workspace."""
    problem = study.experiments[experiment]["problems"][0]
    return study.workspaces[study.problems[problem]["workspace"]]["unit"]


def experiments_of(study: Study, artefact: str) -> list[str]:
    """Names of the experiments whose results an artefact shows, each once, in order."""
    if artefact in study.tables:
        return [study.tables[artefact]["experiment"]] if artefact in study.compared() else []
    return list(dict.fromkeys(panel["experiment"] for panel in study.figures[artefact]["panels"] if "experiment" in panel))


def methods_of(study: Study, artefact: str, experiment: str) -> list[str]:
    """Methods of an experiment whose runs an artefact needs: of a table all (the comparison shows them), of a figure those it selects, by
    name controls too.
    """
    if artefact in study.tables:
        return study.methods_of(experiment)
    methods = study.experiments[experiment]["methods"]
    needed = set()
    for panel in study.figures[artefact]["panels"]:
        if panel.get("experiment") == experiment:
            wanted = panel.get("where", {}).get("method", methods)
            needed.update([wanted] if isinstance(wanted, str) else wanted)
    return [method for method in study.methods_of(experiment) if method in needed]


def experiments_of_claims(study: Study, claims: list[dict]) -> list[str]:
    """Names of the experiments on whose runs claims are judged, each once, in order; variants may name further ones."""
    named = [check["experiment"] for claim in claims for check in claim["checks"] if "experiment" in check]
    named += [value for claim in claims for value in claim.get("variants", {}).get("experiment", [])]
    flat = itertools.chain.from_iterable([name] if isinstance(name, str) else name for name in named)
    return list(dict.fromkeys(flat))


def claims_job(study: Study, claims: list[dict]) -> dict:
    """What claims depend on beside runs, problems, bounds and the files of published numbers."""
    experiments = {name: study.experiments[name] for name in experiments_of_claims(study, claims)}
    return {
        "study": study.key,
        "module": study.module(),
        "claims": claims,
        "artefacts": study.tables | study.figures,
        "variant_of": {name: method["variant_of"] for name, method in study.methods.items() if "variant_of" in method},
        "paired": {name: experiment.get("seeds", "own") != "own" for name, experiment in experiments.items()},
        "paper_repeats": {name: experiment["repeats"]["full"] for name, experiment in experiments.items()},
        "labels": study.labels,
    }


def alternatives(study: Study) -> dict[str, tuple[str, Any]]:
    """Every alternative of an assumption that governs a setting: its name, such as `O2_8`, -> the assumption's id and the value."""
    return {
        f"{assumption['id']}_{value}": (assumption["id"], value)
        for assumption in study.assumptions
        if "setting" in assumption
        for value in assumption["alternatives"]
    }


def tried(study: Study) -> list[str]:
    """Names of the alternatives that are tried on claims."""
    return [name for name, (identity, _) in alternatives(study).items() if "claims" in assumption_of(study, identity)]


def methods_of_claims(study: Study, claims: list[dict], experiment: str) -> list[str]:
    """Methods of an experiment without variants that claims compare; all of them where a check names none."""
    methods = [name for name in study.experiments[experiment]["methods"] if "variant_of" not in study.methods[name]]
    named = set()
    for claim in claims:
        for check in claim["checks"]:
            if experiment in _as_list(check.get("experiment")):
                named |= _compared(study, claim, check) or set(methods)
    return [name for name in methods if name in named]


def _compared(study: Study, claim: dict, check: dict) -> set[str]:
    """Methods that a check names; of `rest` those of the claim's table."""
    found = set(_as_list(check.get("where", {}).get("method", [])))
    if check.get("across", "method") == "method":
        found.update(check.get("groups", []), check.get("than", []), *check.get("pairs", []), *check.get("order", []))
    if "rest" in found:
        tables = [study.tables[name] for name in _as_list(claim.get("artefact", [])) if name in study.tables]
        found.update(*(_as_list(table.get("where", {}).get("method", list(study.methods))) for table in tables))
    return found


def _as_list(value: Any) -> list:
    return value if isinstance(value, list) else [value]


def alternatives_described(study: Study) -> dict[str, dict]:
    """What `analysis.sensitivity` prints of each alternative, by its name."""
    described = {}
    for name in tried(study):
        identity, value = alternatives(study)[name]
        assumption = assumption_of(study, identity)
        parts = {key: assumption[key] for key in ("detail", "setting", "default")}
        described[name] = {"study": study.key, "assumption": identity, **parts, "alternative": value}
    return described


def with_alternative(study: Study, name: str) -> Study:
    """The study with one alternative of `alternatives` in force."""
    identity, value = alternatives(study)[name]
    assumption = assumption_of(study, identity)
    methods = dict(study.methods)
    for method in methods_changed(study, name):
        extra = assumption.get("with", {}).get(method, {})
        settings = methods[method].get("settings", {}) | {assumption["setting"]: value} | extra
        methods[method] = methods[method] | {"settings": settings}
    return dataclasses.replace(study, methods=methods)


def assumption_of(study: Study, identity: str) -> dict:
    """The assumption of that id."""
    return next(assumption for assumption in study.assumptions if assumption["id"] == identity)


def methods_changed(study: Study, name: str) -> list[str]:
    """Methods of the headline claims whose settings an alternative changes; those that the assumption's default names, if it names any."""
    assumption = assumption_of(study, alternatives(study)[name][0])
    default = assumption["default"]
    concerned = [method for method in study.methods if method not in study.controls and "variant_of" not in study.methods[method]]
    if isinstance(default, dict):
        concerned = [method for method in concerned if method in default]
    return [method for method in concerned if assumption["setting"] in study.resolved(method)]


def headline_claims(study: Study, name: str) -> list[dict]:
    """The claims on which an alternative is tried, in their deciding variant alone."""
    wanted = assumption_of(study, alternatives(study)[name][0])["claims"]
    return [{key: value for key, value in claim.items() if key != "variants"} for claim in study.claims if claim["id"] in wanted]


def kind_of(study: Study, artefact: str) -> str:
    """The kind of a table, or of the first panel of a figure; of a comparison that of the tables which it is of."""
    if artefact in study.figures:
        return study.figures[artefact]["panels"][0]["kind"]
    kind = study.tables[artefact]["kind"]
    return "pivot" if kind == "comparison" else kind


def smoke(studies: dict[str, Study]) -> tuple[list[tuple[str, str]], list[tuple[str, str, str]]]:
    """The small subset: the first artefact of each kind, as (study, artefact), and one method of each planner that none of them runs, as
    (study, experiment, method).
    """
    artefacts, kinds, planners = [], set(), set()
    for key, study in studies.items():
        for artefact in itertools.chain(study.tables, study.figures):
            if kind_of(study, artefact) not in kinds:
                kinds.add(kind_of(study, artefact))
                artefacts.append((key, artefact))
                for experiment in experiments_of(study, artefact):
                    planners.update(study.planner(method) for method in methods_of(study, artefact, experiment))
    methods = []
    for key, study in studies.items():
        for experiment in study.experiments:
            for method in study.methods_of(experiment):
                if study.planner(method) not in planners:
                    planners.add(study.planner(method))
                    methods.append((key, experiment, method))
    return artefacts, methods


def caption(study: Study, artefact: str, scale: str) -> str:
    """What stands below a table or figure: its title, and the methods, settings and repeats in force."""
    sentences = [(study.tables.get(artefact) or study.figures[artefact])["title"]]
    for experiment in experiments_of(study, artefact):
        content = study.experiments[experiment]
        methods = [method for method in methods_of(study, artefact, experiment) if method not in study.controls]
        settings = {method: study.resolved(method) for method in methods}
        first = settings[methods[0]] if methods else {}
        shared = {name: value for name, value in first.items() if all(own.get(name) == value for own in settings.values())}
        for method, own in settings.items():
            apart = {name: value for name, value in own.items() if name not in shared and name not in content.get("vary", {})}
            sentences.append(f"{study.labels.get(method, method)}: {study.planner(method)}{_listed(apart, ' with ')}")
        if shared:
            sentences.append(f"All:{_listed(shared, ' ')}" if len(methods) > 1 else f"Settings:{_listed(shared, ' ')}")
        for problem in content["problems"]:
            if "settings" in study.problems[problem]:
                sentences.append(f"On {study.labels.get(problem, problem)}:{_listed(study.problems[problem]['settings'], ' ')}")
        sentences.append(f"{content['repeats'][scale]} runs of each method on each problem")
    return ". ".join(sentences) + "."


def _listed(settings: dict[str, Any], before: str) -> str:
    return before + ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in settings.items()) if settings else ""
