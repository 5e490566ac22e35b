"""The jobs that follow from a study: named tuples of all that a job depends on but files.

A script receives them as plain values (`schema.model.plain`), so that Snakemake detects changes.
"""

import itertools
from collections import Counter
from typing import Any

from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.material import Shown
from bezierplan.analysis.jobs import ClaimsJob, ListingJob, PivotJob
from bezierplan.analysis.table_kinds import Comparison, Pivot, Table
from bezierplan.figures import style
from bezierplan.figures.figure_job import FigureJob
from bezierplan.figures.panels import Panel
from bezierplan.planners import PLACE
from bezierplan.running.chunk import Chunk
from bezierplan.running.descriptions import Descriptions
from bezierplan.schema.model import keys, one_or_list
from bezierplan.study.alternatives import experiments_of_claims
from bezierplan.study.artefacts import Figure
from bezierplan.study.definition import Study
from bezierplan.study.experiments import Experiment


def problems_job(study: Study, experiment: str, scale: str) -> Descriptions:
    """What the problems of an experiment depend on, except the content of map files."""
    problems = {
        name: {key: value for key, value in problem.items() if key != "settings"}
        for name, problem in study.problems_of(experiment, scale).items()
    }
    workspaces = {
        name: study.workspaces[name].plain()
        for name in sorted({problem["workspace"] for problem in problems.values()})
    }
    return Descriptions(study.key, problems, workspaces)


def job(study: Study, experiment: str, method: str, scale: str, number: int) -> Chunk:
    """A chunk of runs, which always runs whole, whatever the number of requested repeats."""
    content = study.experiments[experiment]
    size = content.chunk[scale]
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
        problems=_problems_met(study, experiment, method, scale, first),
        vary=vary,
        presets={name: preset for name, preset in study.presets.items() if name in content.vary},
        seeds=content.seeds,
        repeats=[first, first + size],
        time_limit=content.time_limit,
        policy=study.policies[study.methods[method].policy].model_dump()
        if study.moves(experiment)
        else None,
    )


def _problems_met(
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
        }
        met[name] = _place(problem) | ({"settings": settings} if settings else {})
    return met


def _place(problem: dict) -> dict:
    """What the runs table records about a problem's place."""
    return {key: problem[key] for key in PLACE if key in problem}


def chunks(study: Study, experiment: str, method: str, scale: str) -> range:
    """Numbers of the chunks that contain a method's repeats in an experiment at a scale, under the
    condition with the most.
    """
    content = study.experiments[experiment]
    factors = {"method": [method], "problem": content.problems} | content.vary
    repeats = min(
        max(content.runs_of(scale, factor, value) for value in values)
        for factor, values in factors.items()
    )
    return range(-(-repeats // content.chunk[scale]))


def table_job(study: Study, table: str, scale: str) -> PivotJob:
    """What a table of runs depends on."""
    spec = study.compared()[table]
    experiment = study.experiments[spec.experiment]
    # The experiment's own methods unless the table selects some: baselines appear only in the
    # comparison.
    where = {"method": experiment.methods} | spec.where
    return PivotJob(
        name=f"{study.key}/{table}",
        spec=Pivot.model_validate(spec.plain("monotone", "fitted") | {"where": where}),
        labels=study.labels,
        variants={
            name: method for name, method in study.variants().items() if name in experiment.methods
        },
        baselines=[name for name in study.methods_of(spec.experiment) if name in study.baselines],
        repeats=experiment.repeats[scale],
    )


def listing_job(study: Study, table: str) -> ListingJob:
    """What a table without runs depends on."""
    return ListingJob(study.tables[table], study.module(), study.labels)


def figure_job(study: Study, figure: str, scale: str) -> FigureJob:
    """What a figure depends on."""
    spec = study.figures[figure]
    experiments = experiments_of(study, figure)
    bare = sorted({panel.workspace for panel in spec.panels if getattr(panel, "workspace", None)})
    return FigureJob(
        study=study.key,
        columns=spec.columns,
        panels=[_planned(study, panel) for panel in spec.panels],
        module=study.module(),
        labels=study.labels,
        looks=looks(study),
        workspaces={name: study.workspaces[name].plain() for name in bare},
        repeats={name: study.experiments[name].repeats[scale] for name in experiments},
        chunks=_chunks_rerun(study, figure, scale),
        unit=_unit(study, experiments[0])
        if experiments
        else study.workspaces[bare[0] if bare else next(iter(study.workspaces))].unit,
    )


def looks(study: Study) -> dict[str, str]:
    """Method -> the name of its look in every figure."""
    return style.looks_of({method: study.planner(method) for method in study.methods}, study.looks)


def _planned(study: Study, panel: Panel) -> Panel:
    """A panel with all its settings, if it plans by itself."""
    return (
        panel.but(settings=study.resolved(panel.method) | panel.settings) if panel.plans else panel
    )


def _chunks_rerun(study: Study, figure: str, scale: str) -> dict[str, dict[str, Chunk]]:
    """The chunks whose runs a figure reruns, to draw what no table keeps, by experiment and
    method.
    """
    again = {panel.experiment for panel in study.figures[figure].panels if panel.rerun}
    return {
        name: {
            method: job(study, name, method, scale, 0) for method in methods_of(study, figure, name)
        }
        for name in sorted(again)
    }


def _unit(study: Study, experiment: str) -> str:
    """The unit of length of an experiment: that of its first problem's workspace."""
    return study.workspace_of(study.experiments[experiment].problems[0]).unit


def experiments_of(study: Study, artefact: str) -> list[str]:
    """Names of the experiments whose results an artefact shows, each once, in order."""
    if artefact in study.tables:
        return [study.compared()[artefact].experiment] if artefact in study.compared() else []
    shown = [getattr(panel, "experiment", None) for panel in study.figures[artefact].panels]
    return list(dict.fromkeys(filter(None, shown)))


def methods_of(study: Study, artefact: str, experiment: str) -> list[str]:
    """Methods of an experiment whose runs an artefact needs: all for a table (the comparison shows
    them), for a figure those it selects, including baselines if named.
    """
    if artefact in study.tables:
        return study.methods_of(experiment)
    methods = study.experiments[experiment].methods
    needed = set()
    for panel in study.figures[artefact].panels:
        if getattr(panel, "experiment", None) == experiment:
            needed.update(one_or_list(panel.where.get("method", methods)))
    return [method for method in study.methods_of(experiment) if method in needed]


def claims_job(
    study: Study, claims: list[Claim], scale: str, primary_alone: bool = False
) -> ClaimsJob:
    """What claims depend on.

    primary_alone: whether they are judged in their primary variant only.
    """
    judged = [claim.in_primary_variant() for claim in claims] if primary_alone else claims
    experiments = {name: study.experiments[name] for name in experiments_of_claims(judged)}
    return ClaimsJob(
        study=study.key,
        module=study.module(),
        claims=claims,
        primary_alone=primary_alone,
        artefacts={
            name: parts
            for name, artefact in (study.tables | study.figures).items()
            if (parts := _shown(artefact))
        },
        variant_of=study.variants(),
        paired={name: experiment.paired for name, experiment in experiments.items()},
        paper_repeats={
            name: experiment.repeats["full"] for name, experiment in experiments.items()
        },
        labels=study.labels,
        repeats={name: experiment.repeats[scale] for name, experiment in experiments.items()},
    )


def _shown(artefact: Table | Figure) -> list[Shown]:
    """What a table or figure shows of runs."""
    if isinstance(artefact, Pivot):
        given = {name: each for name, each in artefact.plain().items() if name in keys(Shown)}
        return [Shown.model_validate(given)]
    panels = artefact.panels if isinstance(artefact, Figure) else []
    return [
        Shown(experiment=panel.experiment, where=panel.where)
        for panel in panels
        if getattr(panel, "experiment", None)
    ]


def kind_of(study: Study, artefact: str) -> str:
    """The kind of a table, or of the first panel of a figure; for a comparison, of its tables."""
    if artefact in study.figures:
        return study.figures[artefact].panels[0].kind
    table = study.tables[artefact]
    return "pivot" if isinstance(table, Comparison) else table.kind


def smoke(studies: dict[str, Study]) -> tuple[list[tuple[str, str]], list[tuple[str, str, str]]]:
    """The small subset: the first artefact of each kind, as (study, artefact), and one method of
    each planner that none of them runs, as (study, experiment, method).
    """
    artefacts, kinds, planners = [], set(), set()
    for key, study in studies.items():
        for artefact in itertools.chain(study.tables, study.figures):
            if kind_of(study, artefact) not in kinds:
                kinds.add(kind_of(study, artefact))
                artefacts.append((key, artefact))
                for experiment in experiments_of(study, artefact):
                    planners.update(
                        study.planner(method) for method in methods_of(study, artefact, experiment)
                    )
    methods = []
    for key, study in studies.items():
        for experiment in study.experiments:
            for method in study.methods_of(experiment):
                if study.planner(method) not in planners:
                    planners.add(study.planner(method))
                    methods.append((key, experiment, method))
    return artefacts, methods


def leaders(studies: dict[str, Study], scale: str) -> dict[tuple[str, str, str], int]:
    """The first method of each planner among the runs of a scale, as (study, experiment, method),
    numbered within its study.
    """
    made = []
    if scale == "smoke":
        artefacts, alone = smoke(studies)
        for key, artefact in artefacts:
            study = studies[key]
            made += [
                (key, name, method)
                for name in experiments_of(study, artefact)
                for method in methods_of(study, artefact, name)
            ]
        made += alone
    else:
        for key, study in studies.items():
            made += [
                (key, name, method)
                for name in study.experiments
                for method in study.methods_of(name)
            ]
    first: dict[str, tuple[str, str, str]] = {}
    for key, experiment, method in made:
        first.setdefault(studies[key].planner(method), (key, experiment, method))
    numbers = Counter[str]()
    places = {}
    for leader in first.values():
        places[leader] = numbers[leader[0]]
        numbers[leader[0]] += 1
    return places


def caption(study: Study, artefact: str, scale: str) -> str:
    """The caption of a table or figure: title, and the methods, settings and repeats in force."""
    sentences = [(study.tables.get(artefact) or study.figures[artefact]).title]
    for experiment in experiments_of(study, artefact):
        content = study.experiments[experiment]
        methods = [
            method
            for method in methods_of(study, artefact, experiment)
            if method not in study.baselines
        ]
        settings = {method: study.resolved(method) for method in methods}
        first = settings[methods[0]] if methods else {}
        shared = {
            name: value
            for name, value in first.items()
            if all(own.get(name) == value for own in settings.values())
        }
        for method, own in settings.items():
            apart = {
                name: value
                for name, value in own.items()
                if name not in shared and name not in content.vary
            }
            driven = (
                f", policy {study.methods[method].policy}" if study.methods[method].policy else ""
            )
            sentences.append(
                f"{study.labels.get(method, method)}: "
                f"{study.planner(method)}{_listed(apart, ' with ')}{driven}"
            )
        if shared:
            sentences.append(
                f"All:{_listed(shared, ' ')}"
                if len(methods) > 1
                else f"Settings:{_listed(shared, ' ')}"
            )
        for problem in content.problems:
            if settings := study.problems[problem].settings:
                sentences.append(
                    f"On {study.labels.get(problem, problem)}:{_listed(settings, ' ')}"
                )
        sentences.append(
            f"{content.repeats[scale]} runs of each method on each problem"
            + (_fewer(study, content, methods) if scale == "extended" else "")
        )
    return ". ".join(sentences) + "."


def _fewer(study: Study, experiment: Experiment, methods: list[str]) -> str:
    """Where these methods make fewer runs at scale extended, as the end of a sentence."""
    told = ""
    for factor, fewer in experiment.fewer.items():
        shown = {
            name: count for name, count in fewer.items() if factor != "method" or name in methods
        }
        for count in sorted(set(shown.values())):
            names = [study.labels.get(name, name) for name, own in shown.items() if own == count]
            told += f", {count} where {factor.replace('_', ' ')} is {' or '.join(names)}"
    return told


def _listed(settings: dict[str, Any], before: str) -> str:
    return (
        before + ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in settings.items())
        if settings
        else ""
    )


def published_drawn(study: Study, figure: str) -> bool:
    """Whether a figure shows published numbers."""
    return any(
        panel.published_drawn or getattr(panel, "published", False)
        for panel in study.figures[figure].panels
    )
