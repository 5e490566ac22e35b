"""Files of a job by what they are of: no job takes paths apart."""

from types import SimpleNamespace

import pytest
from studies import studies

from bezierplan.running import inputs
from bezierplan.running.inputs import Files
from bezierplan.study import jobs


def test_files_in_order_lead_back_to_their_experiments():
    shows = {"first": {"mine": 2, "yours": 1}, "second": {}}
    given = SimpleNamespace(
        runs=["a/0", "a/1", "b/0"], problems=["problems", "others"], bounds=["bounds", "theirs"]
    )
    assert inputs.group_by_experiment(shows, given) == {
        "first": Files({"mine": ["a/0", "a/1"], "yours": ["b/0"]}, "problems", "bounds"),
        "second": Files({}, "others", "theirs"),
    }


@pytest.mark.parametrize("scale", ["smoke", "full"])
def test_jobs_of_all_studies_know_the_files_of_each(scale):
    given = studies()
    shows = jobs.build_methods(given, scale).shows
    for name, methods in shows.items():
        study, experiment = name.split("/")
        baseline = given[study].baseline_comparison.baseline
        assert set(methods) == {*given[study].experiments[experiment].methods, baseline}
    assert list(shows) == [
        f"{key}/{name}"
        for key, study in given.items()
        if study.baseline_comparison
        for name in study.baseline_comparison.experiments
    ]
