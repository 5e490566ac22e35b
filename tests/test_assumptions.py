"""Every alternative of an assumption that governs a setting changes what a run finds: an option
that nothing reads is a defect.
"""

import json
from functools import cache

import pytest
from studies import built, studies

from bezierplan.geometry.region import region
from bezierplan.running import execution
from bezierplan.study.alternatives import concerned, with_alternative
from bezierplan.study.jobs import job

STUDIES = studies()
# What a run finds beside its extra columns, as opposed to the settings that it was given.
FOUND = ("objective", "history", "path_points", "evaluations")
REPEATS = 3
# Alternatives that matter only under others: how often a roadmap is drawn, where one has few links.
UNDER = {("elhoseny2017", "O15q_100"): {"prm": {"neighbours": 1}}}


def found(study, experiment, method, place=-1):
    """What a few runs of a method find on one problem of an experiment, by default the last, where
    obstacles are in the way.
    """
    described = job(study, experiment, method, "smoke", 0)
    name = list(described.problems)[place]
    problem = built(study, experiment, name)
    blocked = region(problem.workspace)
    rows = []
    condition = next(each for each in described.conditions() if each.problem == name)
    for repeat in range(REPEATS):
        plan = execution.run(described, condition, repeat, problem)
        row = execution.row(described, condition, repeat, plan, True, problem, blocked)
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
    one. On the last problem, or on the first if the last has a value of its own in force.
    """
    study = STUDIES[key]
    if under := UNDER.get((key, name)):
        methods = {
            method: study.methods[method].but(settings=study.methods[method].settings | settings)
            for method, settings in under.items()
        }
        study = study.but(methods=study.methods | methods)
    changed = with_alternative(study, *alternatives(study)[name])
    assert any(
        found(changed, home(study, method), method, place)
        != (
            found(study, home(study, method), method, place)
            if under
            else found_in_force(key, method, place)
        )
        for place in _places(study, name)
        for method in concerned(study, alternatives(study)[name][0])
    )


def _places(study, name):
    """Places of the problems on which an alternative is tried."""
    assumption, value = alternatives(study)[name]
    setting = assumption.setting
    own = {
        study.problems[list(study.experiments[home(study, method)].problems)[-1]].settings.get(
            setting
        )
        for method in concerned(study, alternatives(study)[name][0])
    }
    return [0] if value in own else [-1]
