"""Every alternative of an assumption that governs a setting changes what a run finds: an option
that nothing reads is a defect.
"""

import json
from functools import cache

import pytest
from studies import built, studies

from bezierplan.geometry.region import build_region
from bezierplan.running import execution
from bezierplan.study.alternatives import apply_values
from bezierplan.study.jobs import build_chunk

STUDIES = studies()
# What a run finds beside its extra columns, as opposed to the settings that it was given.
FOUND = ("objective", "history", "path_points", "evaluations")
REPEATS = 3
# Alternatives that matter only under others: how often a roadmap is drawn, where one has few links.
UNDER = {
    ("elhoseny2017", "O15q_1"): {"prm": {"neighbours": 1}},
    # Few points seldom coincide.
    ("song2016", "O13_consecutive"): {"smooth": {"genes": 30, "generations": 1}},
}


def found(study, experiment, method, place=-1):
    """What a few runs of a method find on one problem of an experiment, by default the last, where
    obstacles are in the way.
    """
    described = build_chunk(study, experiment, method, "smoke", 0)
    name = list(described.problems)[place]
    problem = built(study, experiment, name)
    blocked = build_region(problem.workspace)
    rows = []
    condition = next(each for each in described.conditions() if each.problem == name)
    for repeat in range(REPEATS):
        plan = execution.run(described, condition, repeat, problem)
        row = execution.build_row(described, condition, repeat, plan, True, problem, blocked)
        rows.append({key: row[key] for key in (*FOUND, *plan.extra)})
    return json.dumps(rows)


def alternatives(study):
    """Every alternative of a setting by name, such as `O2_8`."""
    return {
        f"{assumption.id}_{value}": (assumption, value)
        for assumption in study.assumptions
        if assumption.setting
        for value in assumption.alternatives
    }


def place_of(study, assumption, method):
    """The number of the last problem of a method, or of one on which an alternative holds."""
    names = list(build_chunk(study, home(study, method), method, "smoke", 0).problems)
    if own := [number for number, name in enumerate(names) if name in assumption.problems]:
        return own[0]
    settings = study.problems[study.experiments[home(study, method)].problems[-1]].settings
    return 0 if assumption.setting in settings else -1


def home(study, method):
    """The first experiment that has a method."""
    return next(
        name for name, experiment in study.experiments.items() if method in experiment.methods
    )


@cache
def found_in_force(key, method, place):
    """What the few runs of a method find with the defaults."""
    return found(STUDIES[key], home(STUDIES[key], method), method, place)


@pytest.mark.parametrize(
    ("key", "name"), [(key, name) for key, study in STUDIES.items() for name in alternatives(study)]
)
def test_alternative_changes_what_a_run_finds(key, name):
    """Of one method at least: a choice about chaotic sequences does not concern a swarm without
    one.
    """
    study = STUDIES[key]
    if others := UNDER.get((key, name)):
        methods = {
            method: study.methods[method].but(settings=study.methods[method].settings | settings)
            for method, settings in others.items()
        }
        study = study.but(methods=study.methods | methods)
    assumption, value = alternatives(study)[name]
    changed = apply_values(study, {assumption.id: value})
    places = {
        method: place_of(study, assumption, method)
        for method in study.list_governed_methods(assumption)
    }
    assert any(
        found(changed, home(study, method), method, place)
        != (
            found(study, home(study, method), method, place)
            if others
            else found_in_force(key, method, place)
        )
        for method, place in places.items()
    )
