"""Readings of a paper: what they change, how they score, whether the search finds a true one."""

import numpy as np
import pandas as pd
import pytest
from studies import built, studies

from bezierplan.analysis import outcome, readings
from bezierplan.analysis.choices import Choice
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
    chunk = made.experiments["operators"].scoring["random"]
    second = readings.under(chunk, {"M15b": 50}, made.choices)
    assert second.settings == chunk.settings
    assert "generations" not in second.problems["env1_initial"]["settings"]
    changed = second.problems["env2_initial"]["settings"].items()
    assert changed >= {"generations": 50, "stall": 100, "population": 80}.items()
    both = readings.under(chunk, {"M10": 10, "M15": 200}, made.choices).settings
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
        chunks = {name: maps.scoring[name]._replace(repeats=[first, last]) for name in methods}
        one = {"maps": maps._replace(scoring=chunks)}
        runner = readings.Runner(made.choices, one, "", found, {})
        return readings.scored(voting, printed, readings.measured(voting, runner.results(reading)))

    reading = {"O21b": "control_points"}
    (one, error), (other, _), (many, _) = (
        score(reading, *runs) for runs in ([0, 100], [100, 200], [200, 1200])
    )
    distance = abs(one - score({}, 0, 100)[0])
    assert max(abs(one - other), abs(one - many), error) < distance / 10


def test_the_search_finds_a_hidden_reading_and_no_excluded_one(monkeypatch):
    """Every choice moves one of three means; the paper's numbers are those of an excluded one."""
    choices = [
        Choice(name, [1, 2], "tries", {"mine": {}}, [], {}, "Section 1" if name == "O3" else "")
        for name in ("O1", "O2", "O3")
    ]
    voting = [quantity("mean", [10.0] * 3)]
    voting[0].printed["value"] = [10.0, 10.0, 14.0]

    class Runner:
        def __init__(self):
            self.choices = choices

        def results(self, reading, layout=None, size=0):
            return None if reading == {"O1": 1, "O2": 1} else reading

    def measured(voting, reading):
        means = [10.0 + 2 * reading.get(name, 0) for name in ("O1", "O2", "O3")]
        return np.tile(np.column_stack([means, *2 * [np.full(3, 0.01)]]), (6, 1, 1))

    monkeypatch.setattr(readings, "measured", measured)
    scores, calibration = readings.of_study("walks", voting, Runner())
    assert scores["reading"][0] == "O3=2"
    assert scores["excluded_by"][0] == "Section 1"
    assert "O1=1, O2=1" not in [*scores["reading"]]
    paper, hidden = calibration.iloc[0], calibration[calibration["hidden"]]
    assert (paper["found"], paper["best"] < paper["default"] + 1) == ("default", True)
    assert [*hidden["place"]] == [1] * len(hidden)
    assert paper["best"] < hidden["score"].min()


def test_a_number_that_is_not_named_has_no_vote():
    made, _ = job("tharwat2018")
    files = {name: f"{STUDIES['tharwat2018'].folder}/published/{name}.csv" for name in made.tables}
    votes = {"table3": {"objective": {"method": ["cpso1_tent"]}}}
    (voting,) = readings.quantities({"table3": made.tables["table3"]}, votes, files)
    assert [*voting.printed["method"]] == ["cpso1_tent"]


def test_a_mean_over_free_paths_counts_them_and_an_unstated_number_is_of_one_run():
    made, voting = job("ma2020")
    counts = [each.printed["value"] for each in voting if each.metric == "feasible"]
    assert {*pd.concat(counts)} == {30}
    assert {*made.experiments["environments"].scoring} == {"bca", "bca_q"}
    assert {*pd.concat([each.printed["n"] for each in job("song2016")[1]])} == {1}


def test_hidden_numbers_are_of_as_many_layouts_as_printed_ones():
    chunk = (
        jobs.readings(STUDIES["elhoseny2017"], "extended").experiments["fields100"].printing["ga"]
    )
    first, second = (
        {place["layout"] for place in readings._in_layouts(chunk, number, 10).problems.values()}
        for number in (0, 1)
    )
    assert (len(first), len(second), first & second) == (10, 10, set())


def test_what_was_fitted_to_has_runs_for_claims_and_no_vote():
    own = STUDIES["elhoseny2017"]
    scored, judged = jobs.readings(own, "full"), jobs.verdicts_of_readings(own, "full")
    assert "mga" not in scored.experiments["fields100"].scoring
    assert "mga" in judged.experiments["fields100"].scoring


def test_claims_are_judged_under_the_best_reading_that_no_sentence_excludes(monkeypatch):
    choices = [Choice(name, [1, 2.0], "tries", {"mine": {}}, [], {}, "") for name in ("O1", "O2")]
    scores = {
        "reading": ["O2=1", "O1=1, O2=2.0", "default"],
        "excluded_by": ["Section 1", None, None],
        "score": [3.0, 2.0, 1.0],
        "error": 0.1,
    }
    runner = readings.Runner(choices, {}, "", {}, {})
    monkeypatch.setattr(readings.Runner, "results", lambda self, reading: reading)

    def judged(reading):
        claims = pd.DataFrame({"study": "walks", "id": ["C1", "C2"], "holds": "1 of 1"})
        checks = pd.DataFrame({"id": ["C1", "C2"], "n": [10, 0]})
        return claims.assign(verdict=str(reading)), checks

    (row,) = readings.verdicts(runner, pd.DataFrame(scores), judged).to_dict("records")
    assert row["default"] == "{}"
    assert (row["best"], row["reading"]) == ("{'O1': 1, 'O2': 2.0}", "O1=1, O2=2.0")
    assert row["apart"]


@pytest.mark.parametrize("key", READ)
def test_the_kept_calibration_is_of_this_search(key):
    scores, calibration = (
        pd.read_csv(TREE / outcome.KEPT / f"{key}_{name}") for name in outcome.READINGS
    )
    made, voting = job(key)
    names = [readings.name_of(each) for each in readings.listed(key, made.choices)]
    assert set(names) & set(scores["reading"]) >= {"default", names[1]}
    assert (scores["numbers"] == sum(len(each.printed) for each in voting)).all()
    paper = calibration[~calibration["hidden"]].iloc[0]
    assert paper["found"] in [*scores.loc[scores["excluded_by"].isna(), "reading"]]
    assert calibration["hidden"].sum() >= 12
