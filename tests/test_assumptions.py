"""Every alternative of an assumption that governs a setting changes what a run finds: an option that nothing reads is a defect."""

import json

import pytest

from bezierplan import problems, running, study_file
from bezierplan.exact.region import region
from bezierplan.study import alternatives, job, methods_changed, problems_job, with_alternative

STUDIES = study_file.load(study_file.read_config({}))
# What a run finds, as opposed to the settings that it was given.
FOUND = ("objective", "history", "path_points", "evaluations")
REPEATS = 3


def found(study, experiment, method):
    """What a few runs of a method find on each condition of an experiment's first problem."""
    described = job(study, experiment, method, "smoke", 0)
    name = next(iter(described["problems"]))
    made, _ = problems.build_all(problems_job(study, experiment, "smoke"), study.folder)
    blocked = region(made[name].workspace)
    rows = []
    for condition in list(running.conditions([name], described["vary"]))[:1]:
        for repeat in range(REPEATS):
            plan = running.run(described, condition, repeat, made[name])
            row = running.row(described, condition, repeat, plan, blocked)
            rows.append({key: row[key] for key in FOUND})
    return json.dumps(rows)


CASES = [
    (key, name, next(experiment for experiment in study.experiments if method in study.experiments[experiment]["methods"]), method)
    for key, study in STUDIES.items()
    for name in alternatives(study)
    for method in methods_changed(study, name)
    if any(method in experiment["methods"] for experiment in study.experiments.values())
]


@pytest.mark.parametrize(("key", "name", "experiment", "method"), CASES, ids=lambda case: str(case))
def test_alternative_changes_what_a_run_finds(key, name, experiment, method):
    study = STUDIES[key]
    assert found(with_alternative(study, name), experiment, method) != found(study, experiment, method)
