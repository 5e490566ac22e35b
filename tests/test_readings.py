"""The search for a reading that explains the published numbers: the grid, one reading, the search, and what is reported."""

import json
import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bezierplan.analysis import explained, readings, statistics
from bezierplan.analysis.explained import Evaluated
from bezierplan.analysis.results import Results
from bezierplan.figures import specification
from bezierplan.running import problems
from bezierplan.study import choices, reading
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.seeds import generator

ROOT = Path(__file__).parents[1]
KEYS = ["song2016", "elhoseny2017", "ma2020", "tharwat2018", "meledje"]
GRID = from_lines(["..", ".."], 1.0, "m")
PROBLEMS = {"only": Problem("only", GRID, (0.5, 0.5), (1.5, 1.5))}
CHOICES = [{"id": f"O{n}", "detail": "", "values": [None, 1, 2]} for n in range(6)]


@pytest.fixture(scope="module")
def studies():
    return reading.load(reading.read_config({}))


def numbers(in_range: list[bool], table: list[str] | None = None) -> pd.DataFrame:
    values = np.arange(float(len(in_range)))
    frame = {"method": list("abcdefgh")[: len(in_range)], "metric": "length", "statistic": "mean", "value_published": values}
    return pd.DataFrame(frame | {"low": values, "high": values, "in_range": in_range, "possible": True, "table": table or "table1"})


# The grid.


def test_grid_has_settings_worlds_and_metrics(studies):
    found = {choice["id"]: choice for choice in choices.choices(studies["tharwat2018"])}
    assert found["O2"]["values"] == [None, 0.9, 0.7298]
    assert "cpso1_gauss" in found["O2"]["methods"]
    assert found["workspace"]["values"] == [None, "public"]
    assert found["profile"]["values"] == [None, "tuned", "public_model"]
    assert found["profile"]["overrules"] == {"tuned": ["O2b", "O2c"], "public_model": ["O7", "O8"]}
    # Roadmaps have no printed number.
    assert "O18" not in found


def test_what_the_paper_does_not_define_has_no_vote(studies):
    job = choices.readings_job(studies["tharwat2018"], "full")
    assert "O10" not in {choice["id"] for choice in job["choices"]}
    assert {value["metric"] for table in job["tables"].values() for value in table["spec"]["values"]} == {"rank", "objective"}
    # Its numbers stand in the same file as the others, and are passed over.
    both = printed(5.0, 6.0)
    found, likelihood = readings.numbers_of(results(5.0), SPEC, pd.concat([both, both.assign(metric="length")]), "study/table")
    assert found["metric"].to_list() == ["objective"] * 2
    assert likelihood == readings.numbers_of(results(5.0), SPEC, both, "study/table")[1]


@pytest.mark.parametrize("key", KEYS)
def test_every_study_has_a_grid_of_plain_values(studies, key):
    job = choices.readings_job(studies[key], "full")
    assert json.loads(json.dumps(job)) == job
    assert job["tables"]
    assert job["choices"]


# One reading.


def test_a_reading_changes_the_settings_of_its_methods_and_nothing_else(studies):
    job = choices.readings_job(studies["meledje"], "full")
    chunk = job["tables"]["table2"]["jobs"]["proposed"]
    changed = readings.job_under(chunk, {"M5": 1, "M18": "path"}, job["choices"])
    assert changed["settings"] == chunk["settings"] | {"elitism": 1}
    assert readings.job_under(chunk, {}, job["choices"]) == chunk


@pytest.mark.parametrize("key", KEYS)
def test_every_choice_can_be_made_in_every_job(studies, key):
    job = choices.readings_job(studies[key], "full")
    for choice in job["choices"]:
        for value in choice["values"][1:]:
            chosen = {choice["id"]: value}
            changes = [
                readings.job_under(chunk, chosen, job["choices"]) != chunk
                for table in job["tables"].values()
                for chunk in table["jobs"].values()
            ]
            # A metric and a world change how runs are read, a setting changes runs.
            assert any(changes) == ("setting" in choice), chosen


def test_a_choice_wins_over_the_settings_of_a_problem(studies):
    job = choices.readings_job(studies["ma2020"], "full")
    chunk = job["tables"]["table2"]["jobs"]["aco"]
    assert chunk["problems"]["environment2"]["settings"]["iterations"] == 100
    changed = readings.job_under(chunk, {"O12d": 200}, job["choices"])
    assert changed["settings"]["iterations"] == 200
    assert "iterations" not in changed["problems"]["environment2"].get("settings", {})


def test_only_the_world_of_the_reading_is_run(studies):
    table = choices.readings_job(studies["tharwat2018"], "full")["tables"]["table3"]
    chunk = table["jobs"]["cpso1_gauss"]
    for chosen, world in (({}, ("equal", "default")), ({"workspace": "public", "profile": "tuned"}, ("public", "tuned"))):
        spec, job = readings.in_world(table["spec"], chunk, chosen)
        assert (list(job["problems"]), job["vary"]) == ([world[0]], {"profile": [world[1]]})
        assert (spec["where"]["workspace"], spec["where"]["profile"]) == world


def results(mean: float, spread: float = 1.0, runs: int = 40) -> Results:
    """Two methods whose means differ by 1, with common random numbers."""
    noise = generator("common").normal(size=runs)
    rows = [
        {
            "id": f"{method}/{repeat}",
            "problem": "only",
            "method": method,
            "repeat": repeat,
            "objective": mean + number + spread * noise[repeat],
        }
        | {"feasible": True, "claimed_feasible": True, "bound": 1.0, "length": 2.0}
        for number, method in enumerate("ab")
        for repeat in range(runs)
    ]
    return Results(pd.DataFrame(rows), PROBLEMS, pd.DataFrame())


SPEC = {"where": {"method": ["a", "b"]}, "index": ["method"], "values": [{"metric": "objective", "statistic": "mean"}]}


def printed(a: float, b: float) -> pd.DataFrame:
    frame = {"method": ["a", "b"], "metric": "objective", "statistic": "mean", "n": 10, "unit": "m", "value": [a, b]}
    return pd.DataFrame(frame)


def test_numbers_lie_in_range_where_the_comparison_says_so():
    near, _ = readings.numbers_of(results(5.0), SPEC, printed(5.1, 9.0), "study/table")
    assert near["in_range"].to_list() == [True, False]
    ours = results(5.0).runs.query("method == 'a'")["objective"].to_numpy()
    *_, low, high = statistics.prediction("mean", np.sort(ours), 5.1, 10, None, generator("any"))
    assert near[["low", "high"]].iloc[0].to_list() == pytest.approx([low, high], abs=0.05)


def test_likelihood_is_highest_at_the_truth_and_knows_that_runs_are_common():
    def likelihood(mean, a, b):
        return readings.numbers_of(results(mean), SPEC, printed(a, b), "study/table")[1]

    assert likelihood(5.0, 5.0, 6.0) > likelihood(5.5, 5.0, 6.0) > likelihood(7.0, 5.0, 6.0)
    # Both lie equally far off, but together only where the same runs moved both.
    assert likelihood(5.0, 5.3, 6.3) > likelihood(5.0, 5.3, 5.7) + 1


def test_too_few_runs_explain_nothing():
    found, likelihood = readings.numbers_of(results(5.0, runs=3), SPEC, printed(5.0, 6.0), "study/table")
    assert not found["in_range"].any()
    assert math.isfinite(likelihood)


def test_a_metric_takes_the_place_of_the_printed_word():
    spec, published = readings.under_metrics(SPEC, printed(5.0, 6.0), {"O1": "length"}, [{"id": "O1", "metric": "objective"}])
    assert [value["metric"] for value in spec["values"]] == ["length"]
    assert set(published["metric"]) == {"length"}
    # A table that shows the metric already shows it once.
    both = SPEC | {"values": [*SPEC["values"], {"metric": "length", "statistic": "mean"}]}
    assert len(readings.under_metrics(both, printed(5.0, 6.0), {"O1": "length"}, [{"id": "O1", "metric": "objective"}])[0]["values"]) == 1


def test_the_search_leaves_out_what_takes_too_long(studies):
    found = {choice["id"]: choice for choice in choices.choices(studies["meledje"])}
    assert found["M9b"]["values"] == [None, "unrestricted"]


def test_the_length_that_a_fitness_uses_is_not_the_length_that_is_printed(studies):
    found = {choice["id"]: choice for choice in choices.choices(studies["elhoseny2017"])}
    assert found["O1b"]["metric"] == "cells4"
    assert found["O2"].keys() & {"metric", "setting"} == {"setting"}


# The search.


def evaluated(chosen: dict, planted: dict) -> Evaluated:
    """As many numbers in range as choices agree with the planted reading."""
    agree = [chosen.get(choice["id"]) == planted.get(choice["id"]) for choice in CHOICES]
    return Evaluated(chosen, numbers(agree), {"table1": float(sum(agree))})


def test_a_small_grid_is_searched_completely():
    tried = readings.search(CHOICES[:3], lambda chosen: evaluated(chosen, {}), "study", most=27)
    assert len({explained.name_of(each.reading) for each in tried}) == 27
    assert tried[0].reading == {}


def test_a_large_grid_is_climbed_to_the_planted_reading():
    planted = {"O1": 2, "O3": 1, "O4": 2}
    tried = readings.search(CHOICES, lambda chosen: evaluated(chosen, planted), "study", most=60)
    assert len(tried) <= 60
    assert max(tried, key=lambda each: each.rank).reading == planted


def test_a_reading_names_no_choice_that_its_world_makes_itself():
    """As a bundle of settings beats the single ones, `O1=2, world=other` would be the runs of `world=other` under another name."""
    world = {"id": "world", "detail": "", "values": [None, "other"], "column": "world", "overrules": {"other": ["O1"]}}
    for grid in (CHOICES[:2], CHOICES):
        tried = readings.search([*grid, world], lambda chosen: evaluated(chosen, {"O2": 1}), "study", most=60)
        made = [each.reading for each in tried]
        assert any("world" in reading for reading in made)
        assert not any({"world", "O1"} <= reading.keys() for reading in made)
    assert len(readings.search([*CHOICES[:2], world], lambda chosen: evaluated(chosen, {}), "study", most=60)) == 9 + 3


def test_readings_that_exclude_themselves_are_left_out_and_the_budget_is_kept():
    asked = []

    def evaluate(chosen):
        asked.append(explained.name_of(chosen))
        return None if chosen.get("O2") == 1 else evaluated(chosen, {})

    tried = readings.search(CHOICES, evaluate, "study", most=20)
    assert len(asked) == len(set(asked)) == 20
    assert all(each.reading.get("O2") != 1 for each in tried)
    assert [explained.name_of(each.reading) for each in readings.search(CHOICES, evaluate, "study", most=20)] == [
        explained.name_of(each.reading) for each in tried
    ]


# What is reported.


def test_by_chance_exchanges_the_printed_numbers():
    frame = numbers([True, True, True]).assign(low=[-1.0, -1.0, 1.5], high=[1.5, 0.5, 2.5])
    # The first accepts one of the two others, the second one, the third none.
    assert explained.by_chance(frame) == pytest.approx(0.5 + 0.5 + 0.0)
    assert explained.by_chance(numbers([True])) == 0.0


def test_tables_of_readings_numbers_and_tables_left_out():
    tables = ["table1", "table1", "table2"]
    in_force = Evaluated({}, numbers([True, False, True], tables), {"table1": -1.0, "table2": -1.0})
    other = Evaluated({"O1": 2}, numbers([True, True, False], tables), {"table1": 0.0, "table2": -5.0})
    found = explained.readings_table("study", [in_force, other], CHOICES)
    assert found["reading"].to_list() == ["in force", "O1=2"]
    assert found[["in_range", "in_range_table1", "in_range_table2"]].to_numpy().tolist() == [[2, 1, 1], [2, 2, 0]]
    numbers_found = explained.explained_table("study", [in_force, other])
    assert numbers_found["readings"].to_list() == [1, 1, 2]
    assert numbers_found["in_force"].to_list() == [False, True, True]
    held_out = explained.held_out_table("study", [in_force, other]).set_index("table")
    # The other one is best on the first table, and is wrong on the second.
    assert held_out.loc["table2", ["reading", "chosen", "in_force", "most"]].to_list() == ["O1=2", 0, 1, 1]


def told(*tried):
    tables = explained.readings_table("one", list(tried), CHOICES), explained.explained_table("one", list(tried))
    (*_, text) = explained.section(*tables, explained.held_out_table("one", list(tried)), {"one": "The first"})
    return text


def test_summary_says_what_no_reading_gives_and_what_the_best_one_does():
    tables = ["table1", "table1", "table2", "table2"]
    in_force = Evaluated({}, numbers([True, False, False, False], tables), {"table1": -1.0, "table2": -5.0})
    better = Evaluated({"O1": 2}, numbers([True, True, True, False], tables), {"table1": 0.0, "table2": -1.0})
    text = told(in_force, better)
    assert text.startswith("**The first.** No reading gives 1 of the numbers (1 of table2). Of 4 numbers, 1 are in range")
    assert "The most likely of 2 readings, O1=2, has a likelihood 10^2 times that of the one in force, and brings 3 into range" in text
    assert text.endswith("readings bring 3, that in force 1: the tables held out agree with a change.")
    assert "None of 1 readings is more likely." in told(in_force)
    assert "explains their level" not in text
    # Ranges so wide that each holds every printed number of its kind say nothing about how these differ.
    wide = Evaluated({"O1": 2}, better.numbers.assign(low=-10.0, high=10.0, in_range=True), better.likelihoods)
    assert "brings 4 into range (4 when exchanged: it explains their level, not how they differ)" in told(in_force, wide)


def test_summary_does_not_follow_a_reading_that_other_tables_refuse():
    tables = ["table1", "table1", "table2"]
    in_force = Evaluated({}, numbers([False, False, True], tables), {"table1": -9.0, "table2": -1.0})
    fitted = Evaluated({"O1": 2}, numbers([True, True, False], tables), {"table1": 0.0, "table2": -9.0})
    text = told(in_force, fitted)
    assert text.startswith("**The first.** Each number is in range under some reading.")
    assert text.endswith("held out, table2 (0 instead of 1) speaks against a change.")
    assert explained.section(pd.DataFrame(), pd.DataFrame(), pd.DataFrame(), {}) == []


def test_a_reading_under_which_a_printed_number_is_impossible_is_ruled_out_whatever_its_score():
    in_force = Evaluated({}, numbers([True, False]), {"table1": -9.0})
    likely = Evaluated({"O1": 2}, numbers([True, True]).assign(possible=[True, False]), {"table1": 0.0})
    assert max([in_force, likely], key=lambda each: each.rank) is in_force
    found = explained.readings_table("study", [in_force, likely], CHOICES)
    assert found[["reading", "impossible"]].to_numpy().tolist() == [["in force", 0], ["O1=2", 1]]
    text = told(in_force, likely)
    assert "1 of 2 readings is ruled out: under it a printed mean or extreme lies below the exact bound of its map." in text
    assert "None of 2 readings is more likely." in text


def test_figure_shows_every_choice_that_some_reading_makes():
    table = explained.readings_table("study", [evaluated({}, {}), evaluated({"O1": 2}, {}), evaluated({"O3": 1}, {})], CHOICES)
    above, below = specification.draw(table, [choice["id"] for choice in CHOICES]).axes
    assert [label.get_text() for label in below.get_yticklabels()] == ["O1 = 2", "O3 = 1"]
    assert above.lines[0].get_ydata().tolist() == sorted(table["in_range"])


def test_a_search_goes_on_with_the_runs_that_it_kept(studies, tmp_path, monkeypatch):
    study = studies["song2016"]
    job = choices.readings_job(study, "smoke")
    for table in job["tables"].values():
        for chunk in table["jobs"].values():
            if "generations" in chunk["settings"]:
                chunk["settings"] = chunk["settings"] | {"generations": 5, "population": 20}
    described = {
        "study": study.key,
        "problems": study.problems_of("routes", "smoke"),
        "workspaces": {"figure2": study.workspaces["figure2"].plain()},
    }
    made, _ = problems.build_all(described, study.folder)
    bounds = pd.DataFrame({"problem": list(made), "bound": 1.0, "least_length": 0.0, "octile_bound": 1.0})
    files = {"table1": study.published_file("table1")}
    monkeypatch.chdir(ROOT)

    def search():
        evaluate = readings.Evaluator(job, {"routes": made}, {"routes": bounds}, files, tmp_path)
        return explained.readings_table(study.key, readings.search(job["choices"], evaluate, study.key, most=2), job["choices"])

    first = search()
    monkeypatch.setattr(readings.execution, "run_chunk", lambda *_: pytest.fail("run again"))
    pd.testing.assert_frame_equal(search(), first)
