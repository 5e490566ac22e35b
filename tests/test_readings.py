"""Readings of a paper: what they change, how they score, whether the search finds a true one."""

import numpy as np
import pandas as pd
import pytest
from studies import built, studies

from bezierplan.analysis import outcome, readings
from bezierplan.places import TREE
from bezierplan.running import problems
from bezierplan.study import jobs

STUDIES = studies()
READ = [key for key, study in STUDIES.items() if study.votes]


def job(key):
    made = jobs.readings(STUDIES[key], "full")
    files = {name: f"{STUDIES[key].folder}/published/{name}.csv" for name in made.tables}
    return made, readings.quantities(made.tables, made.votes, files)


def test_a_reading_changes_its_settings_on_its_problems_and_what_goes_along():
    made, _ = job("meledje")
    chunk = made.experiments["operators"].chunks["random"]
    second = readings.under(chunk, {"M15b": 50}, made.assumptions)
    assert second.settings == chunk.settings
    assert "generations" not in second.problems["env1_initial"]["settings"]
    changed = second.problems["env2_initial"]["settings"].items()
    assert changed >= {"generations": 50, "stall": 100, "population": 80}.items()
    both = readings.under(chunk, {"M10": 10, "M15": 200}, made.assumptions).settings
    assert (both["generations"], both["stall"]) == (200, 10)


def quantity(statistic, sizes, decimals=2):
    printed = pd.DataFrame({"n": sizes, "value": 0.0})
    return readings.Quantity("", {}, {}, "", statistic, decimals, None, [], printed)


def test_densities_are_densities_of_relative_errors_and_of_counts():
    counts = [quantity("count", [100] * 101, 0)]
    ours = np.tile([0.3, 0.0, 0.0], (101, 1))
    assert np.exp(readings._densities(counts, np.arange(101.0), ours)).sum() == pytest.approx(1)
    errors = np.linspace(-20, 20, 400_001)
    means = [quantity("mean", [1] * len(errors))]
    ours = np.column_stack([10 * (1 - errors), *2 * [np.full(len(errors), 0.5)]])
    found = np.exp(readings._densities(means, np.full(len(errors), 10.0), ours))
    assert np.trapezoid(found, errors) == pytest.approx(1, abs=1e-4)


def test_a_score_hardly_depends_on_seeds_or_on_how_many_runs_are_ours():
    """Less than a tenth of the distance to the default's."""
    made, voting = job("tharwat2018")
    voting = [each for each in voting if each.experiment == "maps" and each.metric == "objective"]
    methods = ["cpso1_singer", "cpso2_singer"]
    voting = [
        each._replace(printed=each.printed[each.printed["method"].isin(methods)]) for each in voting
    ]
    maps = made.experiments["maps"]
    problem = {"equal": built(STUDIES["tharwat2018"], "maps", "equal")}
    found = {"maps": (problem, problems.bounds_of(problem).to_pandas())}
    printed = readings._of_paper(voting)

    def score(reading, first, last):
        chunks = {name: maps.chunks[name]._replace(repeats=[first, last]) for name in methods}
        one = {"maps": maps._replace(chunks=chunks)}
        runner = readings.Runner(made.assumptions, one, "", found, {})
        return readings.scored(voting, printed, readings.measured(voting, runner.results(reading)))

    reading = {"O21b": "control_points"}
    (one, error), (other, _), (many, _) = (
        score(reading, *runs) for runs in ([0, 100], [100, 200], [200, 1200])
    )
    distance = abs(one - score({}, 0, 100)[0])
    assert max(abs(one - other), abs(one - many), error) < distance / 10


def test_a_number_that_is_not_named_has_no_vote():
    made, _ = job("tharwat2018")
    files = {name: f"{STUDIES['tharwat2018'].folder}/published/{name}.csv" for name in made.tables}
    votes = {"table3": {"objective": {"method": ["cpso1_tent"]}}}
    (voting,) = readings.quantities({"table3": made.tables["table3"]}, votes, files)
    assert [*voting.printed["method"]] == ["cpso1_tent"]


def test_an_unstated_number_is_of_one_run_and_rivals_with_settings_of_ours_have_no_vote():
    assert {*job("ma2020")[0].experiments["environments"].chunks} == {"bca", "bca_q"}
    assert {*pd.concat([each.printed["n"] for each in job("song2016")[1]])} == {1}


@pytest.mark.parametrize("key", READ)
def test_the_kept_readings_are_those_of_today(key):
    kept = pd.read_csv(TREE / outcome.KEPT / f"{key}_{outcome.READINGS}")
    names = {readings.name_of(each) for each in readings.listed(job(key)[0].assumptions)}
    assert "default" in {*kept["reading"]} <= names
