"""The search for an interpretation that explains the published numbers: the grid, one
interpretation, the search, and what is reported.
"""

import json
import math
from collections import Counter
from pathlib import Path

import numpy as np
import pandas as pd
import planted
import pytest
from pivots import pivot_of

from bezierplan.analysis import comparison, explained, interpretations, statistics
from bezierplan.analysis.explained import Evaluated
from bezierplan.analysis.results import Results
from bezierplan.analysis.search import confirm, search, within_reach
from bezierplan.analysis.search_job import Choice, Part, Search, Stage
from bezierplan.figures import specification
from bezierplan.schema import model
from bezierplan.study import choices, reading
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.seeds import generator

ROOT = Path(__file__).parents[1]
KEYS = ["song2016", "elhoseny2017", "ma2020", "tharwat2018", "meledje"]
GRID = from_lines(["..", ".."], 1.0, "m")
PROBLEMS = {"only": Problem("only", GRID, (0.5, 0.5), (1.5, 1.5))}
CHOICES = [Choice(f"O{n}", "", [None, 1, 2]) for n in range(6)]


@pytest.fixture(scope="module")
def studies():
    return reading.load(reading.read_config({}))


def numbers(in_range: list[bool], table: list[str] | None = None) -> pd.DataFrame:
    values = np.arange(float(len(in_range)))
    frame = {
        "method": list("abcdefgh")[: len(in_range)],
        "metric": "length",
        "statistic": "mean",
        "value_published": values,
    }
    return pd.DataFrame(
        frame
        | {
            "low": values,
            "high": values,
            "in_range": in_range,
            "possible": True,
            "table": table or "table1",
        }
    )


# The grid.


def test_grid_has_settings_worlds_and_metrics(studies):
    found = {choice.id: choice for choice in choices.choices(studies["tharwat2018"])}
    assert found["O2"].values == [None, 0.9, 0.7298]
    assert "cpso1_gauss" in found["O2"].methods
    assert found["workspace"].values == [None, "public"]
    assert found["profile"].values == [None, "tuned", "public_model"]
    assert found["profile"].overrules == {"tuned": ["O2b", "O2c"], "public_model": ["O7", "O8"]}
    # Roadmaps have no printed number.
    assert "O18" not in found


def test_what_the_paper_does_not_define_has_no_vote(studies):
    job = choices.interpretations_job(studies["tharwat2018"])
    assert "O10" not in {choice.id for choice in job.choices}
    assert {value.metric for table in job.tables.values() for value in table.spec.values} == {
        "rank",
        "objective",
    }
    # Its numbers stand in the same file as the others, and are passed over.
    both = printed(5.0, 6.0)
    found, likelihood, _ = interpretations.numbers_of(
        results(5.0), SPEC, pd.concat([both, both.assign(metric="length")]), "study/table"
    )
    assert found["metric"].to_list() == ["objective"] * 2
    assert likelihood == interpretations.numbers_of(results(5.0), SPEC, both, "study/table")[1]


@pytest.mark.parametrize("key", KEYS)
def test_every_study_has_a_grid_of_plain_values(studies, key):
    job = choices.interpretations_job(studies[key])
    written = model.plain(job)
    assert json.loads(json.dumps(written)) == written
    assert model.job(Stage, written) == job
    assert job.tables
    assert job.choices


@pytest.mark.parametrize("key", KEYS)
def test_a_thousand_runs_choose_among_finalists_and_a_thousand_others_judge_the_chosen_one(
    studies, key
):
    job = choices.search_job(studies[key])

    def runs(stage, table, method):
        chunk = job.stages[stage].tables[table].jobs[method]
        spec = job.stages[stage].tables[table].spec
        _, own = interpretations.in_world(spec, chunk, {})
        return {(problem, repeat) for problem in own.problems for repeat in range(*own.repeats)}

    for name, table in job.stages["finalists"].tables.items():
        drawn = "layout" in next(iter(next(iter(table.jobs.values())).problems.values()))
        for method in table.jobs:
            screened, judged, finalists, fresh = (
                runs(stage, name, method) for stage in choices.STAGES
            )
            assert screened <= judged
            assert judged.isdisjoint(finalists)
            assert fresh.isdisjoint(judged | finalists)
            for many in (finalists, fresh):
                counts = Counter("drawn" if drawn else problem for problem, _ in many)
                assert min(counts.values()) >= choices.MANY


def test_finalists_and_the_chosen_one_are_judged_on_fields_that_none_met_before(studies):
    job = choices.search_job(studies["elhoseny2017"])
    screened, judged, finalists, fresh = (
        {place["layout"] for place in job.stages[stage].worlds["fields100"].problems.values()}
        for stage in choices.STAGES
    )
    assert screened < judged
    assert len(judged) == len(finalists) == len(fresh)
    assert judged.isdisjoint(finalists)
    assert fresh.isdisjoint(judged | finalists)


# One interpretation.


def test_an_interpretation_changes_the_settings_of_its_methods_and_nothing_else(studies):
    job = choices.interpretations_job(studies["meledje"])
    chunk = job.tables["table2"].jobs["proposed"]
    changed = interpretations.chunk_under(chunk, {"M5": 1, "M18": "path"}, job.choices)
    assert changed.settings == chunk.settings | {"elitism": 1}
    assert interpretations.chunk_under(chunk, {}, job.choices) == chunk


@pytest.mark.parametrize("key", KEYS)
def test_every_choice_can_be_made_in_every_job(studies, key):
    job = choices.interpretations_job(studies[key])
    for choice in job.choices:
        for value in choice.values[1:]:
            chosen = {choice.id: value}
            changes = [
                interpretations.chunk_under(chunk, chosen, job.choices) != chunk
                for table in job.tables.values()
                for chunk in table.jobs.values()
            ]
            # A metric and a world change how runs are read, a workspace what they are made in, a
            # setting changes runs.
            assert any(changes) == bool(choice.setting), chosen


def test_a_choice_wins_over_the_settings_of_a_problem(studies):
    job = choices.interpretations_job(studies["ma2020"])
    chunk = job.tables["table2"].jobs["aco"]
    assert chunk.problems["environment2"]["settings"]["iterations"] == 100
    changed = interpretations.chunk_under(chunk, {"O12d": 200}, job.choices)
    assert changed.settings["iterations"] == 200
    assert "iterations" not in changed.problems["environment2"].get("settings", {})


def test_only_the_world_of_the_interpretation_is_run(studies):
    table = choices.interpretations_job(studies["tharwat2018"]).tables["table3"]
    chunk, given = table.jobs["cpso1_gauss"], table.spec
    for chosen, world in (
        ({}, ("equal", "default")),
        ({"workspace": "public", "profile": "tuned"}, ("public", "tuned")),
    ):
        spec, job = interpretations.in_world(given, chunk, chosen)
        assert (list(job.problems), job.vary) == ([world[0]], {"profile": [world[1]]})
        assert (spec.where["workspace"], spec.where["profile"]) == world


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


TABLE = {
    "where": {"method": ["a", "b"]},
    "index": ["method"],
    "values": [{"metric": "objective", "statistic": "mean"}],
}
SPEC = pivot_of(TABLE)


def printed(a: float, b: float) -> pd.DataFrame:
    frame = {
        "method": ["a", "b"],
        "metric": "objective",
        "statistic": "mean",
        "n": 10,
        "unit": "m",
        "value": [a, b],
    }
    return pd.DataFrame(frame)


def test_numbers_lie_in_range_where_the_comparison_says_so():
    near, *_ = interpretations.numbers_of(results(5.0), SPEC, printed(5.1, 9.0), "study/table")
    assert near["in_range"].to_list() == [True, False]
    ours = results(5.0).runs.query("method == 'a'")["objective"].to_numpy()
    *_, low, high = statistics.prediction("mean", np.sort(ours), 5.1, 10, None, generator("any"))
    assert near[["low", "high"]].iloc[0].to_list() == pytest.approx([low, high], abs=0.05)


def test_likelihood_is_highest_at_the_truth_and_knows_that_runs_are_common():
    def likelihood(mean, a, b):
        return interpretations.numbers_of(results(mean), SPEC, printed(a, b), "study/table")[1]

    assert likelihood(5.0, 5.0, 6.0) > likelihood(5.5, 5.0, 6.0) > likelihood(7.0, 5.0, 6.0)
    # Both lie equally far off, but together only where the same runs moved both.
    assert likelihood(5.0, 5.3, 6.3) > likelihood(5.0, 5.3, 5.7) + 1


def test_an_event_that_none_of_our_few_runs_had_may_be_in_print_once_or_twice():
    spec = pivot_of(TABLE | {"values": [{"metric": "feasible", "statistic": "count"}]})
    ours = results(5.0)
    ours = ours._replace(runs=ours.runs.assign(feasible=False))

    def likelihood(count):
        frame = printed(count, 0).assign(metric="feasible", statistic="count", n=100)
        return interpretations.numbers_of(ours, spec, frame, "study/table")[1]

    assert likelihood(0) > likelihood(2) > likelihood(0) - 2
    assert likelihood(50) < likelihood(0) - 50


def test_a_number_of_an_unstated_number_of_runs_is_as_likely_by_many_of_ours_as_by_few():
    def likelihood(runs):
        return interpretations.numbers_of(
            results(5.0, runs=runs), SPEC, printed(6.0, 7.0).assign(n=math.nan), "study/table"
        )[1]

    assert likelihood(4000) == pytest.approx(likelihood(100), abs=3)


@pytest.mark.parametrize(("failed", "explains"), [(4, True), (5, False)])
def test_an_interpretation_under_which_most_runs_fail_explains_nothing(failed, explains):
    eight = results(5.0, runs=8)
    runs = eight.runs.assign(
        objective=eight.runs["objective"].where(eight.runs["repeat"] >= failed)
    )
    found, likelihood, resampled = interpretations.numbers_of(
        eight._replace(runs=runs), SPEC, printed(5.0, 6.0), "study/table", 5
    )
    assert found["in_range"].all() == explains
    assert found[["low", "high"]].notna().all(axis=None) == explains
    assert (likelihood > -50) == explains
    assert np.isfinite([likelihood, *resampled]).all()


def test_mean_ranks_that_do_not_add_up_have_no_vote():
    spec = pivot_of(TABLE | {"values": [{"metric": "rank", "statistic": "mean", "decimals": 1}]})
    ranks = printed(1.0, 1.5).assign(metric="rank")
    assert comparison.impossible_ranks(ranks, spec).tolist() == [True, True]
    assert not comparison.impossible_ranks(ranks.assign(value=[1.4, 1.6]), spec).any()
    assert not comparison.impossible_ranks(ranks.assign(metric="objective"), spec).any()


def test_a_metric_takes_the_place_of_the_printed_word():
    spec, published = interpretations.under_metrics(
        SPEC,
        printed(5.0, 6.0),
        {"O1": "length"},
        [Choice("O1", "", [None, "length"], metric="objective")],
    )
    assert [value.metric for value in spec.values] == ["length"]
    assert set(published["metric"]) == {"length"}
    # A table that shows the metric already shows it once.
    both = pivot_of(
        TABLE | {"values": [*TABLE["values"], {"metric": "length", "statistic": "mean"}]}
    )
    spec, _ = interpretations.under_metrics(
        both,
        printed(5.0, 6.0),
        {"O1": "length"},
        [Choice("O1", "", [None, "length"], metric="objective")],
    )
    assert len(spec.values) == 1


def test_the_search_leaves_out_what_takes_too_long(studies):
    found = {choice.id: choice for choice in choices.choices(studies["meledje"])}
    assert found["M9b"].values == [None, "unrestricted"]


def test_the_length_that_a_fitness_uses_is_not_the_length_that_is_printed(studies):
    found = {choice.id: choice for choice in choices.choices(studies["elhoseny2017"])}
    assert found["O1b"].metric == "cells4"
    assert found["O2"].setting
    assert found["O2"].metric is None


def test_a_choice_for_some_problems_leaves_the_others_alone(studies):
    job = choices.interpretations_job(studies["meledje"])
    first, second = (job.tables[name].jobs["ref12"] for name in ("table2", "table4"))
    changed = [
        interpretations.chunk_under(chunk, {"M15": 50, "M15b": 200}, job.choices)
        for chunk in (first, second)
    ]
    assert all(chunk.settings["generations"] == 50 for chunk in changed)
    found = {
        name: place["settings"].get("generations")
        for chunk in changed
        for name, place in chunk.problems.items()
    }
    assert found["env1_initial"] is None
    assert found["env2_initial"] == found["env2_modified"] == 200


def test_methods_that_no_metric_compares_are_parts(studies):
    job = choices.search_job(studies["elhoseny2017"])
    parts = {part.methods[0]: part.choices for part in job.parts}
    assert list(parts) == ["mga", "prm", "abc_ep", "ga"]
    assert parts["prm"] == ["O1", "O1b", "O1g", "O1h", "O15b", "O15c", "O15d", "O15q", "O25b"]
    # Mean ranks are those of all methods together.
    assert len(choices.search_job(studies["tharwat2018"]).parts) == 1


@pytest.mark.parametrize("method", ["prm", "abc_ep", "ga"])
def test_every_rival_has_forty_settings_to_try(studies, method):
    found = {
        choice.id: len(choice.values)
        for choice in choices.choices(studies["elhoseny2017"])
        if choice.methods == [method]
    }
    assert math.prod(found.values()) >= 40


def test_a_share_of_the_runs_screens_interpretations(studies):
    job = choices.search_job(studies["elhoseny2017"])
    layouts = [
        {place["layout"] for place in job.stages[name].worlds["fields100"].problems.values()}
        for name in ("screened", "judged")
    ]
    assert list(map(len, layouts)) == [statistics.LEAST_RUNS, 20]
    job = choices.search_job(studies["ma2020"])
    assert [
        job.stages[name].tables["table1"].jobs["aco"].repeats for name in ("screened", "judged")
    ] == [[0, 25], [0, 100]]


# The search.

ALONE = [Part(["a"], [choice.id for choice in CHOICES])]


def evaluated(chosen: dict, planted: dict) -> Evaluated:
    """As many numbers in range as choices agree with the planted interpretation."""
    known = dict.fromkeys([choice.id for choice in CHOICES]) | planted
    agree = [chosen.get(choice) == value for choice, value in known.items()]
    return Evaluated(chosen, numbers(agree), {"table1": float(sum(agree))})


def evaluating(planted: dict):
    return lambda tasks: [evaluated(task.interpretation, planted) for task in tasks]


def test_a_small_grid_is_searched_completely():
    found = search(CHOICES[:3], [Part(["a"], ["O0", "O1", "O2"])], evaluating({}), "study", most=27)
    assert len(found.of_parts[0]) == 27
    assert found.interpretations[0].interpretation == {}


def test_a_large_grid_is_climbed_to_the_planted_interpretation():
    planted = {"O1": 2, "O3": 1, "O4": 2}
    found = search(CHOICES, ALONE, evaluating(planted), "study", most=60)
    assert max(found.interpretations, key=lambda each: each.rank).interpretation == planted


def test_a_change_is_paid_only_by_the_parts_that_it_concerns():
    asked = []

    def evaluate(tasks):
        asked.extend(tasks)
        return [evaluated(task.interpretation, {"O1": 2, "O5": 1}) for task in tasks]

    parts = [Part(["a"], ["O0", "O1", "O2"]), Part(["b"], ["O0", "O3", "O4", "O5"])]
    found = search(CHOICES, parts, evaluate, "study", most=200)
    assert (
        len({(task.part, explained.name_of(task.interpretation)) for task in asked})
        == len(asked)
        <= 27 + 81
    )
    assert all(task.interpretation.keys() <= set(parts[task.part].choices) for task in asked)
    assert max(found.interpretations, key=lambda each: each.rank).interpretation == {
        "O1": 2,
        "O5": 1,
    }


def test_an_interpretation_names_no_choice_that_its_world_makes_itself():
    """As a bundle of settings beats the single ones, `O1=2, world=other` would be the runs of
    `world=other` under another name.
    """
    world = Choice("world", "", [None, "other"], column="world", overrules={"other": ["O1"]})

    def tried(grid):
        parts = [Part(["a"], [choice.id for choice in [*grid, world]])]
        return search(
            [*grid, world],
            parts,
            lambda tasks: [
                evaluated(task.interpretation, {"O2": 1, "world": "other"}) for task in tasks
            ],
            "study",
            most=60,
        )

    for grid in (CHOICES[:2], CHOICES):
        made = [each.interpretation for each in tried(grid).interpretations]
        assert any("world" in interpretation for interpretation in made)
        assert not any({"world", "O1"} <= interpretation.keys() for interpretation in made)
    assert tried(CHOICES[:2]).tried == 9 + 3


def test_interpretations_that_exclude_themselves_are_left_out_and_the_budget_is_kept():
    asked = []

    def evaluate(tasks):
        asked.extend(explained.name_of(task.interpretation) for task in tasks)
        return [
            None if task.interpretation.get("O2") == 1 else evaluated(task.interpretation, {})
            for task in tasks
        ]

    found = search(CHOICES, ALONE, evaluate, "study", most=20)
    assert len(asked) == len(set(asked))
    assert 20 <= len(asked) < 20 + 3  # a batch is finished
    assert all(each.interpretation.get("O2") != 1 for each in found.interpretations)
    again = search(CHOICES, ALONE, evaluate, "study", most=20)
    assert [each.interpretation for each in again.interpretations] == [
        each.interpretation for each in found.interpretations
    ]


def test_finalists_are_judged_again():
    finalists = [{"O1": 2}, {"O1": 1}, {"O1": 1, "O2": 2}]
    confirmed = confirm(finalists, ALONE, evaluating({"O1": 1}))
    assert [each.interpretation for each in confirmed] == [
        {},
        {"O1": 1},
        *sorted(finalists, key=lambda each: -evaluated(each, {"O1": 1}).score)[1:],
    ]


def reached(scores: list[float], most: int, apart: list[float], impossible=()) -> list[int]:
    """The numbers of the interpretations within reach. scores: theirs. apart: how far the
    differences of their scores from that of the first go up and down in resampled runs.
    """
    up_and_down = np.tile([1.0, -1.0], 10)

    def evaluate(tasks):
        found = []
        for task in tasks:
            number = task.interpretation["O0"]
            possible = numbers([True]).assign(possible=number not in impossible)
            resampled = scores[number] + apart[number] * up_and_down
            found.append(
                Evaluated(task.interpretation, possible, {"table1": scores[number]}, resampled)
            )
        return found

    tried = [{"O0": number} for number in range(len(scores))]
    return [each["O0"] for each in within_reach(tried, ALONE, evaluate, most)]


def test_finalists_are_those_within_reach_of_the_best_given_the_error_of_the_difference():
    assert reached([0.0, -9.0, -9.5, -8.0], 4, apart=[0, 1, 5, 0]) == [0, 2]
    # What moves both alike tells them apart as before.
    assert reached([0.0, -9.0], 4, apart=[50, 50]) == [0]
    assert reached([-9.0, 0.0, -5.0], 4, apart=[0, 0, 9]) == [1, 2]


def test_finalists_are_limited_and_the_rest_is_not_asked_for():
    assert reached([0.0, -1.0, -2.0, -3.0], 2, apart=[0, 9, 9, 9]) == [0, 1]
    asked = within_reach(
        [{"O0": n} for n in range(9)],
        ALONE,
        lambda tasks: [
            evaluated(task.interpretation, {})._replace(
                likelihoods={"table1": -100.0 * task.interpretation["O0"]},
                resampled=np.zeros(5),
            )
            if task.interpretation["O0"] < 4
            else pytest.fail("asked for")
            for task in tasks
        ],
        2,
    )
    assert asked == [{"O0": 0}]


def test_a_choice_that_changes_nothing_stands_for_no_other_experiment():
    """Neither among those listed nor among those that may become finalists."""

    def evaluate(tasks):
        return [
            Evaluated(
                task.interpretation,
                numbers([True]),
                {"table1": float(task.interpretation.get("O0", 0))},
            )
            for task in tasks
        ]

    found = search(CHOICES[:2], [Part(["a"], ["O0", "O1"])], evaluate, "study", most=100)
    assert found.tried == math.prod(len(choice.values) for choice in CHOICES[:2])
    assert all("O1" not in each.interpretation for each in found.interpretations)
    assert len(found.interpretations) == len(CHOICES[0].values)


def test_finalists_are_no_interpretations_that_are_ruled_out_and_no_other_name_of_one():
    assert reached([0.0, -1.0, -2.0], 3, apart=[9, 0, 9], impossible=[0]) == [1, 2]
    assert reached([0.0, -1.0], 3, apart=[9, 9], impossible=[0, 1]) == []
    assert reached([0.0, 0.0, -1.0], 3, apart=[0, 0, 9]) == [0, 2]


def test_the_error_of_a_score_is_that_of_other_runs():
    """The spread of scores of resampled runs, beside that of the scores of runs made anew."""
    frame = printed(5.5, 6.5)

    def judged(seed, resamples=0):
        noise = generator(f"runs/{seed}").normal(size=40)
        runs = results(5.0)
        runs.runs["objective"] = (
            5.0 + runs.runs["method"].map({"a": 0.0, "b": 1.0}) + noise[runs.runs["repeat"]]
        )
        return interpretations.numbers_of(runs, SPEC, frame, "study/table", resamples)

    spread = np.std([judged(seed)[1] for seed in range(60)])
    error = np.mean([np.std(judged(seed, 25)[2]) for seed in range(10)])
    assert error == pytest.approx(spread, rel=0.5)


def test_an_experiment_within_one_of_our_groups_has_a_score_with_an_error():
    own = results(5.0)
    frame = own.runs.assign(layout=own.runs["repeat"] % 8, problem="only")
    spec = pivot_of(TABLE | {"within": "layout"})
    found = interpretations.numbers_of(
        own._replace(runs=frame), spec, printed(5.0, 6.0), "study/table", 3
    )
    assert np.isfinite(found[1])
    assert len(set(found[2])) == 3


def test_a_part_with_many_choices_leaves_the_others_their_trials():
    parts = [Part(["a"], ["O0", "O1", "O2", "O3"]), Part(["b"], ["O4", "O5"])]
    planted = {"O3": 1, "O5": 2}
    found = search(CHOICES, parts, evaluating(planted), "study", most=20)
    first, second = map(len, found.of_parts)
    assert first < 20 + 3  # a batch is finished
    assert second == 9
    assert found.interpretations[1].interpretation["O5"] == 2


def test_luck_does_not_choose_the_best_of_many(monkeypatch):
    """All interpretations are alike: the one that few runs flatter is judged by others, and the
    score that is reported is one that chose nothing.
    """
    names = ["screened", "judged", "finalists", "fresh"]
    stages = {name: Stage(name, {}, CHOICES[:3], {}, "") for name in names}
    job = Search("study", 27, 5, [Part(["a"], ["O0", "O1", "O2"])], {}, stages)
    asked = {}

    class Lucky:
        """Few runs have a large error, many a small one."""

        def __init__(self, stage, files, maps, folder, resamples=0):
            self.stage, self.resamples, self.published = stage.study, resamples, {}

        def __call__(self, methods, interpretation):
            name = explained.name_of(interpretation)
            asked.setdefault(self.stage, []).append(name)
            error = 9.0 if self.stage in ("screened", "judged") else 1.0
            luck = generator(f"{self.stage}/{name}").normal(0.0, error)
            again = luck + generator(f"{name}/again").normal(0.0, error, self.resamples)
            return Evaluated(interpretation, numbers([True]), {"table1": luck}, again)

    monkeypatch.setattr(interpretations, "Evaluator", Lucky)
    table = interpretations.found_by(job, {}, ROOT, ROOT, 1)["interpretations"]
    confirmed = table[table["confirmed"]]
    assert len(asked["finalists"]) == len(set(asked["finalists"])) == len(confirmed)
    assert 3 <= len(confirmed) <= 5 + 1
    # The best by the runs that choose among finalists, which the search has not seen.
    best = confirmed.iloc[0]
    assert best["score"] == pytest.approx(
        max(generator(f"finalists/{name}").normal(0.0, 1.0) for name in asked["finalists"])
    )
    assert asked["fresh"] == ["default", best["interpretation"]]
    for row in (best, table[table["interpretation"] == "default"].iloc[0]):
        assert row["fresh_score"] == pytest.approx(
            generator(f"fresh/{row['interpretation']}").normal(0.0, 1.0)
        )
    assert best["tried"] == 27


PLANTED = [("song2016", 0), ("ma2020", 0), ("meledje", 0), ("meledje", 1), ("ma2020", 1)]


@pytest.mark.parametrize(("key", "number"), PLANTED)
def test_a_planted_interpretation_is_found(studies, key, number):
    job = choices.search_job(studies[key])
    surface = planted.Surface(f"{key}/{number}", job.choices, job.parts)
    assert planted.found_by(surface, job.most) >= -planted.NEAR


@pytest.mark.parametrize(
    ("study", "found"),
    [("song2016", 2), ("elhoseny2017", 2), ("ma2020", 2), ("tharwat2018", 1), ("meledje", 2)],
)
def test_nine_of_ten_planted_interpretations_are_found(study, found):
    """By as many interpretations as each study tries, two surfaces a study."""
    surfaces = [planted.of_study(study, number) for number in range(2)]
    away = [planted.found_by(surface, surface.most) for surface in surfaces]
    assert sum(each >= -planted.NEAR for each in away) >= found, away


def test_noise_is_not_explained(studies):
    job = choices.search_job(studies["ma2020"])
    surface = planted.Surface("ma2020/noise", job.choices, job.parts, noise=True)
    found = search(surface.choices, surface.parts, surface.evaluate, "study", most=60)
    best = max(found.interpretations, key=lambda each: each.rank)
    assert best.numbers["in_range"].mean() < 0.5


# What is reported.


def test_by_chance_exchanges_the_printed_numbers():
    frame = numbers([True, True, True]).assign(low=[-1.0, -1.0, 1.5], high=[1.5, 0.5, 2.5])
    # The first accepts one of the two others, the second one, the third none.
    assert explained.by_chance(frame) == pytest.approx(0.5 + 0.5 + 0.0)
    assert explained.by_chance(numbers([True])) == 0.0


def test_tables_of_interpretations_numbers_and_tables_left_out():
    tables = ["table1", "table1", "table2"]
    default = Evaluated({}, numbers([True, False, True], tables), {"table1": -1.0, "table2": -1.0})
    other = Evaluated(
        {"O1": 2}, numbers([True, True, False], tables), {"table1": 0.0, "table2": -5.0}
    )
    found = explained.interpretations_table(
        "study", [default, other], [default, other], 2, [default, other], CHOICES
    )
    assert found["interpretation"].to_list() == ["default", "O1=2"]
    assert found[["in_range", "in_range_table1", "in_range_table2"]].to_numpy().tolist() == [
        [2, 1, 1],
        [2, 2, 0],
    ]
    numbers_found = explained.explained_table("study", [default, other], [[default, other]], set())
    assert numbers_found["interpretations"].to_list() == [1, 1, 2]
    assert numbers_found["default"].to_list() == [False, True, True]
    assert numbers_found["missed_by"].to_list() == [0.0, 0.0, 0.0]
    leave_one_table_out = explained.leave_one_table_out_table(
        "study", [default, other], {}
    ).set_index("table")
    # The other one is best on the first table, and is wrong on the second.
    assert leave_one_table_out.loc[
        "table2", ["interpretation", "chosen", "default", "most"]
    ].to_list() == [
        "O1=2",
        0,
        1,
        1,
    ]


def test_a_number_that_nothing_explains_has_the_interpretation_that_comes_nearest():
    far, near = (
        numbers([False]).assign(low=4.0, high=5.0),
        numbers([False]).assign(low=-3.0, high=-1.5),
    )
    tried = [Evaluated({}, far, {"table1": -9.0}), Evaluated({"O1": 2}, near, {"table1": -5.0})]
    (row,) = explained.explained_table("study", tried, [tried], set()).to_dict("records")
    assert (row["value_published"], row["missed_by"], row["nearest"]) == (0.0, 1.5, "O1=2")
    failed = [
        Evaluated({}, numbers([False]).assign(low=math.nan, high=math.nan), {"table1": -50.0})
    ]
    assert math.isnan(
        explained.explained_table("study", failed, [failed], set())["missed_by"].iloc[0]
    )


def told(*tried, lines=None):
    confirmed = list(tried)
    numbers_found = explained.explained_table("one", confirmed, [confirmed], set())
    leave_one_table_out = explained.leave_one_table_out_table("one", confirmed, lines or {})
    (*_, text) = explained.section(
        explained.interpretations_table(
            "one", confirmed, [], len(confirmed), [confirmed[0], confirmed[-1]], CHOICES
        ),
        numbers_found,
        leave_one_table_out,
        {"one": "The first"},
    )
    return text


def test_a_row_for_each_study_says_which_interpretation_is_most_likely(tmp_path):
    default = Evaluated({}, numbers([True, False]), {"table1": -9.0})
    better = Evaluated({"O1": 2}, numbers([True, True]), {"table1": 0.0})
    found = explained.interpretations_table(
        "one", [default, better], [], 2, [default, better], CHOICES
    )
    found.to_csv(tmp_path / "found.csv", index=False)
    (row,) = explained.brief(pd.read_csv(tmp_path / "found.csv")).reset_index().to_dict("records")
    assert row == {
        "study": "one",
        "most likely interpretation": "1 choice differs from the default",
        "numbers in range": "2 of 2",
        "with new seeds": "2",
        "by chance": "0",
        "default in range": "1",
        "likelihood over the default's": "10^4 times",
    }
    (row,) = explained.brief(
        explained.interpretations_table("one", [default], [], 1, [default], CHOICES)
    ).to_dict("records")
    assert row["most likely interpretation"] == "the default"


def test_summary_says_what_no_interpretation_gives_and_what_the_best_one_does():
    tables = ["table1", "table1", "table2", "table2"]
    default = Evaluated(
        {}, numbers([True, False, False, False], tables), {"table1": -1.0, "table2": -5.0}
    )
    better = Evaluated(
        {"O1": 2}, numbers([True, True, True, False], tables), {"table1": 0.0, "table2": -1.0}
    )
    text = told(default, better)
    assert (
        "are most likely from an experiment in which these choices differ from ours: : 2 (O1=2)"
        in text
    )
    assert (
        "log-likelihood ratio against the default, by runs that chose neither, +5.0 "
        "(10^2 times as likely)" in text
    )
    assert "it gains table2 +4.0, table1 +1.0." in text
    assert (
        "Judged again by runs with new seeds, it has 3 of 4 in range and a log-likelihood of "
        "-1.0 (by the runs" in text
    )
    assert "No interpretation explains 1 of the numbers: 1 of table2 for d." in text
    assert text.endswith(
        "interpretations bring 3 into range, the default 1: "
        "the tables left out agree with a change."
    )
    assert "none of 1 interpretations is more likely" in told(default)
    assert "explains their level" not in text
    # Ranges so wide that each holds every printed number of its kind say nothing about how these
    # differ.
    wide = Evaluated(
        {"O1": 2},
        better.numbers.assign(low=-10.0, high=10.0, in_range=True, method="a"),
        better.likelihoods,
    )
    assert "4 of 4 numbers in range (4 by chance): it explains their level" in told(default, wide)


def test_summary_does_not_follow_an_interpretation_that_other_tables_refuse():
    tables = ["table1", "table1", "table2"]
    default = Evaluated({}, numbers([False, False, True], tables), {"table1": -9.0, "table2": -1.0})
    fitted = Evaluated(
        {"O1": 2}, numbers([True, True, False], tables), {"table1": 0.0, "table2": -9.0}
    )
    text = told(default, fitted)
    assert "Each number is in range under some interpretation." in text
    assert text.endswith("left out, table2 (0 instead of 1) speaks against a change.")
    assert explained.section(pd.DataFrame(), pd.DataFrame(), pd.DataFrame(), {}) == []


def test_an_interpretation_under_which_a_printed_number_is_impossible_is_ruled_out():
    default = Evaluated({}, numbers([True, False]), {"table1": -9.0})
    likely = Evaluated(
        {"O1": 2}, numbers([True, True]).assign(possible=[True, False]), {"table1": 0.0}
    )
    assert max([default, likely], key=lambda each: each.rank) is default
    found = explained.interpretations_table("study", [default, likely], [], 2, [likely], CHOICES)
    assert found[["interpretation", "impossible"]].to_numpy().tolist() == [
        ["default", 0],
        ["O1=2", 1],
    ]
    text = told(default, likely)
    assert (
        "1 of 2 interpretations is ruled out: under it a printed mean or extreme lies below the "
        "exact bound of its map." in text
    )
    assert "none of 2 interpretations is more likely" in text
    # Ruled out, it is no place to climb from either.
    found = search(
        CHOICES,
        ALONE,
        lambda tasks: [likely if task.interpretation else default for task in tasks],
        "study",
        most=30,
    )
    assert found.interpretations[0].interpretation == {}


def test_a_line_that_describes_the_numbers_better_is_told():
    own = Evaluated({}, numbers([True, False]), {"table1": -9.0})
    assert (
        "below that of the most likely interpretation: so the interpretation describes them better"
        in told(own, lines={"table1": ("obstacles", -20.0)})
    )
    text = told(own, lines={"table1": ("obstacles", -2.0)})
    assert "A straight line in the column obstacles" in text
    assert (
        "has a log-likelihood 7.0 above that of the most likely interpretation: so the "
        "interpretation describes them worse" in text
    )


def test_a_line_predicts_numbers_on_it_and_not_others():
    frame = {
        "method": "a",
        "obstacles": [5, 10, 15, 20, 25],
        "metric": "length",
        "statistic": "mean",
        "n": 10,
        "unit": "m",
    }
    near, far = (
        explained.yardstick(pd.DataFrame(frame | {"value": values}), "obstacles")
        for values in ([1, 2.1, 2.9, 4, 5], [1, 4, 2, 9, 3])
    )
    assert near > far


def test_figure_shows_every_choice_that_some_interpretation_makes():
    judged = [evaluated(chosen, {}) for chosen in ({}, {"O1": 2}, {"O3": 1})]
    table = explained.interpretations_table("study", judged, [], 1, judged[:1], CHOICES)
    above, below = specification.draw(table, [choice.id for choice in CHOICES]).axes
    assert [label.get_text() for label in below.get_yticklabels()] == ["O1 = 2", "O3 = 1"]
    assert above.lines[0].get_ydata().tolist() == sorted(table["in_range"])


def test_a_search_goes_on_with_the_runs_that_it_kept_in_any_number_of_processes(
    studies, tmp_path, monkeypatch
):
    study = studies["song2016"]
    job = choices.search_job(study)._replace(most=2)
    for stage in job.stages.values():
        for table in stage.tables.values():
            for method, chunk in table.jobs.items():
                first = chunk.repeats[0]
                table.jobs[method] = chunk._replace(
                    settings=chunk.settings | {"generations": 5, "population": 20},
                    repeats=[first, first + statistics.LEAST_RUNS],
                )
    monkeypatch.chdir(ROOT)
    files = {"table1": study.published_file("table1")}

    def found(processes):
        return interpretations.found_by(job, files, study.folder, tmp_path, processes)

    first = found(2)
    assert first["explained"]["tried"].min() >= 2
    monkeypatch.setattr(
        interpretations.execution, "run_chunk", lambda *_, **__: pytest.fail("run again")
    )
    for name, table in found(1).items():
        pd.testing.assert_frame_equal(table, first[name])
