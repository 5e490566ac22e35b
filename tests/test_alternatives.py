"""Alternatives of assumptions: each is a run that differs, and the rules that try them work."""

import pytest
from studies import studies

from bezierplan.analysis.claims.variants import in_variant, variants
from bezierplan.study import alternatives, jobs

STUDIES = studies()
ALTERNATIVES = [(key, name) for key, study in STUDIES.items() for name in alternatives.tried(study)]


@pytest.mark.parametrize(("key", "name"), ALTERNATIVES)
def test_every_alternative_has_a_run_that_it_changes(key, name):
    study = STUDIES[key]
    assert any(
        job.settings != jobs.job(study, job.experiment, job.method, "full", 0).settings
        for _, job in jobs.alternative(STUDIES[key], "full", name).chunks
    )


def test_an_alternative_judges_the_primary_variant_and_runs_only_what_it_judges():
    study = STUDIES["elhoseny2017"]
    name = next(
        name
        for name in alternatives.tried(study)
        if any(claim.id == "C1" for claim in alternatives.headline_claims(study, name))
    )
    claim = next(claim for claim in alternatives.headline_claims(study, name) if claim.id == "C1")
    [check] = in_variant(claim.checks, *2 * variants(claim))
    assert check.where["workspace"] == "published_like"
    judged = jobs.alternative(STUDIES["elhoseny2017"], "full", name)
    assert judged.claims == alternatives.headline_claims(study, name)


def test_checks_of_several_experiments_need_the_methods_of_each():
    study = STUDIES["elhoseny2017"]
    claims = [
        claim.but(checks=[check])
        for claim in study.claims
        for check in claim.checks
        if len(check.experiments) > 1
    ]
    assert claims
    for claim in claims:
        for experiment in claim.checks[0].experiments:
            assert alternatives.methods_of_claims(study, [claim], experiment)
