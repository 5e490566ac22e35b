"""Alternatives of assumptions: each is a run that differs, and the rules that try them work."""

import pytest
from studies import studies

from bezierplan.study import alternatives, jobs, targets

STUDIES = studies()
ALTERNATIVES = [(key, name) for key, study in STUDIES.items() for name in alternatives.tried(study)]


@pytest.mark.parametrize(("key", "name"), ALTERNATIVES)
def test_every_alternative_has_a_run_that_it_changes(key, name):
    study = STUDIES[key]
    chunks = targets.alternative_params(STUDIES, "full", key, name)["chunks"]
    assert any(
        job != jobs.job(study, job["experiment"], job["method"], "full", 0) for file, job in chunks.items() if file.endswith("/0.parquet")
    )


def test_checks_of_several_experiments_need_the_methods_of_each():
    study = STUDIES["elhoseny2017"]
    claims = [claim.but(checks=[check]) for claim in study.claims for check in claim.checks if len(check.experiments) > 1]
    assert claims
    for claim in claims:
        for experiment in claim.checks[0].experiments:
            assert alternatives.methods_of_claims(study, [claim], experiment)
