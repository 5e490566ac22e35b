"""Alternatives of assumptions: each is a run that differs, and the rules that try them work."""

import pytest

from bezierplan.study import alternatives, jobs, reading, targets

STUDIES = reading.load(reading.read_config({}))
ALTERNATIVES = [(key, name) for key, study in STUDIES.items() for name in alternatives.tried(study)]


@pytest.mark.parametrize(("key", "name"), ALTERNATIVES)
def test_every_alternative_has_a_run_that_it_changes(key, name):
    study = STUDIES[key]
    files = [file.split("/") for file in targets.claims_inputs(STUDIES, "full", key, name)["runs"] if "/sensitivity/" in file]
    changed = alternatives.with_alternative(study, name)
    changing = {(experiment, method) for *_, experiment, method, _ in files}
    assert changing
    assert any(jobs.job(study, *each, "full", 0) != jobs.job(changed, *each, "full", 0) for each in changing)


def test_checks_of_several_experiments_need_the_methods_of_each():
    study = STUDIES["elhoseny2017"]
    claims = [claim.but(checks=[check]) for claim in study.claims for check in claim.checks if len(check.experiments) > 1]
    assert claims
    for claim in claims:
        for experiment in claim.checks[0].experiments:
            assert alternatives.methods_of_claims(study, [claim], experiment)
