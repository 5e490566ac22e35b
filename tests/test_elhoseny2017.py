"""elhoseny2017: its printed numbers, worked example, audit and claims of its own; faults of its
random fields and settings.
"""

from pathlib import Path as File

import pandas as pd
import pytest
from studies import study

from bezierplan.analysis.audit import audit
from bezierplan.analysis.claims.kinds import function
from bezierplan.analysis.results import Results
from bezierplan.papers.elhoseny2017 import audit as own_audit
from bezierplan.papers.elhoseny2017 import functions as elhoseny2017
from bezierplan.running import execution, problems
from bezierplan.running.chunk import Condition
from bezierplan.study import jobs
from bezierplan.study.jobs import build_chunk, build_problems_job

FOLDER = File(__file__).parents[1] / "config" / "studies" / "elhoseny2017"
PUBLISHED = {
    file.stem: audit.read_printed_numbers(str(file))
    for file in sorted((FOLDER / "published").glob("*.csv"))
}


# The worked example.


def test_the_table_of_the_example():
    table = elhoseny2017.q_table(PUBLISHED).set_index("solutions")
    pairs = table.loc[["S1, S2", "S1, S3", "S2, S3"]]
    assert pairs[["N11", "N00", "N10", "N01"]].to_numpy().tolist() == [
        [3, 2, 2, 3],
        [2, 3, 3, 2],
        [2, 2, 4, 2],
    ]
    assert pairs["Q"].tolist() == [0.0, 0.0, -0.3333]
    assert table.loc["mean", "Q"] == -0.1111
    assert table.loc["S3", [f"gene {gene}" for gene in range(1, 11)]].tolist() == [
        1,
        1,
        1,
        1,
        0,
        0,
        0,
        0,
        0,
        0,
    ]


def test_the_example_agrees_with_the_text():
    mark, effect, interval, units = elhoseny2017.q_example({}, {}, PUBLISHED)
    assert (mark, interval, units) == ("+", None, 3)
    assert effect == pytest.approx(1 / 9 - 0.11, abs=1e-12)


# The audit.


@pytest.fixture(scope="module")
def rows():
    return audit.build_audit("elhoseny2017", own_audit.audit(PUBLISHED))


def broken(rows, rule):
    return set(rows.loc[rows["rule"].str.contains(rule) & ~rows["consistent"], "place"])


def test_where_roadmaps_are_not_the_longest(rows):
    assert broken(rows, "PRM the longest") == {
        "route=case2, obstacles=5, method=prm",
        "route=case2, obstacles=25, method=prm",
    }


def test_the_proposed_method_is_printed_as_the_shortest_and_ga_as_second(rows):
    assert broken(rows, "proposed method the shortest") == set()
    assert broken(rows, "GA second") == set()


def test_the_least_possible_length_is_kept(rows):
    assert broken(rows, "counts less than 1.5") == set()
    turning_back = broken(rows, "at most 2 cells")
    assert {
        "route=case2, obstacles=25, method=mga",
        "route=case1, obstacles=25, method=mga",
    } <= turning_back
    assert "route=case1, obstacles=20, method=mga" not in turning_back


def test_where_the_proposed_method_is_not_the_cheapest(rows):
    places = {f"method=mga, obstacles={obstacles}, beside mga_plain" for obstacles in (5, 10, 15)}
    assert broken(rows, "cheaper than all others") == places | {
        "method=mga, obstacles=5, beside ga"
    }


def test_tables_5_and_6_agree_on_the_proposed_method_and_not_on_ga(rows):
    assert broken(rows, "same time of the proposed method") == set()
    assert len(broken(rows, "what both call GA")) == 5


def test_the_text_swaps_two_counts_and_has_eta_end_at_0(rows):
    assert broken(rows, "counts as it defines") == {"S1, S2: N10", "S1, S2: N01"}
    assert broken(rows, "Q of the counts in the text") == set()
    last = rows[rows["rule"].str.contains("eta decreases to 0")].iloc[0]
    assert not last["consistent"]
    assert last["limit"] == pytest.approx(0.358, abs=5e-4)


def test_a_falling_eta_accepts_less_and_two_of_four_mutations_stay_in_the_subspace(rows):
    assert broken(rows, "more similar solutions are accepted") == {"3.3"}
    subspace = rows[rows["rule"].str.contains("subspace")].iloc[0]
    assert (subspace["printed"], subspace["limit"], bool(subspace["consistent"])) == (4, 2, False)


def test_the_title_has_a_dynamic_field_and_no_table_obstacles_that_move(rows):
    assert broken(rows, "dynamic field") == {"title"}


# The claim on printed lengths over the bounds.


def results(side, least):
    table = pd.DataFrame(
        [
            {
                "problem": f"{route}_{obstacles}_{layout}",
                "route": route,
                "obstacles": obstacles,
                "side": side,
                "octile_bound": least + layout,
            }
            for route in ("case1", "case2")
            for obstacles in (5, 10, 15, 20, 25)
            for layout in range(4)
        ]
    )
    twice = pd.concat([table.assign(method="mga"), table.assign(method="prm")], ignore_index=True)
    return Results(twice, {}, pd.DataFrame())


CHECK = function.Options(
    test="function", name="printed_over_bound", statistic="ratio", effect_unit="-"
)


def test_printed_lengths_over_the_bounds():
    found = {"fields100": results(100, 150.0), "fields200": results(200, 300.0)}
    mark, effect, _, fields = elhoseny2017.printed_over_bound(CHECK, found, PUBLISHED)
    assert (mark, fields) == ("-", 80)
    largest = {
        name: PUBLISHED[name].query("method != 'mga'")["value"].max()
        for name in ("table2", "table3")
    }
    assert effect == pytest.approx(
        max(largest["table2"] / 151.5, largest["table3"] / 301.5), rel=1e-12
    )


def test_the_control_without_the_loop_evaluates_as_many_paths():
    """Claim C32 compares both."""
    own = study("elhoseny2017")
    made, _ = problems.build_all(build_problems_job(own, "worth", "full"), own.folder)
    evaluations = {}
    for method in ("mga", "mga_plain_200"):
        described = build_chunk(own, "worth", method, "full", 0)
        plans = [execution.run(described, Condition(name, {}), 0, made[name]) for name in made]
        evaluations[method] = sum(plan.evaluations for plan in plans)
    assert evaluations["mga_plain_200"] == pytest.approx(evaluations["mga"], rel=0.1)


@pytest.mark.parametrize(
    ("key", "reconstructed"),
    [
        ("song2016", set()),
        ("tharwat2018", {"table3", "table4", "table5", "table6"}),
        ("elhoseny2017", {"table2", "table3", "table5", "table6"}),
        ("meledje", {"table2", "table3", "table4", "table5"}),
        ("ma2020", {"table1", "table2"}),
    ],
)
def test_numbers_of_maps_that_are_not_printed_are_not_compared_with_bounds(key, reconstructed):
    assert set(jobs.build_audit(study(key), "smoke").reconstructed) == reconstructed


@pytest.mark.parametrize(
    ("key", "table", "reconstructed"),
    [
        ("song2016", "table1", []),
        ("elhoseny2017", "table2", ["published_like"]),
        ("tharwat2018", "table6", ["random"]),
        ("ma2020", "table1", ["environment1", "environment2"]),
    ],
)
def test_a_table_knows_which_of_its_maps_are_not_printed_drawn_ones_too(key, table, reconstructed):
    """The table's runs are of problems that are named after their layout: the workspace is not."""
    job = jobs.build_table_of_runs(study(key), "full", table)
    assert job.reconstructed == reconstructed
