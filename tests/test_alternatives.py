"""Alternatives of assumptions: each is a run that differs, and the rules that try them work."""

import pytest

from bezierplan import study as of_study
from bezierplan import targets
from bezierplan.study import reading

STUDIES = reading.load(reading.read_config({}))
ALTERNATIVES = [(key, name) for key, study in STUDIES.items() for name in of_study.tried(study)]


@pytest.mark.parametrize(("key", "name"), ALTERNATIVES)
def test_every_alternative_has_a_run_that_it_changes(key, name):
    study = STUDIES[key]
    files = [file.split("/") for file in targets.claims_inputs(STUDIES, "full", key, name)["runs"] if "/sensitivity/" in file]
    changed = of_study.with_alternative(study, name)
    jobs = {(experiment, method) for *_, experiment, method, _ in files}
    assert jobs
    assert any(of_study.job(study, *each, "full", 0) != of_study.job(changed, *each, "full", 0) for each in jobs)


def test_checks_of_several_experiments_need_the_methods_of_each():
    study = STUDIES["elhoseny2017"]
    checks = [check for claim in study.claims for check in claim["checks"] if isinstance(check.get("experiment"), list)]
    assert checks
    for check in checks:
        for experiment in check["experiment"]:
            assert of_study.methods_of_claims(study, [{"checks": [check]}], experiment)
