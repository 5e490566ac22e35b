"""Printed lengths as those of polylines through cell centres, and the rules by which verdicts
follow from more than one comparison.
"""

import itertools
import math

import numpy as np
import pandas as pd
import pytest
from studies import FOLDER, drawing, problem_of, published

from bezierplan.analysis import measures
from bezierplan.analysis.audit import audit, identified
from bezierplan.analysis.claims import verdicts
from bezierplan.analysis.table_kinds import Identify
from bezierplan.papers.song2016 import metrics as song2016
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Path, Problem

OPEN = from_lines(["...", "...", "..."], 10.0, "unit")
WALL = from_lines([".#.", ".#.", "..."], 10.0, "unit")


def found(grid, start, target, value, decimals=4, edges=3):
    return identified.find_polylines(
        Problem("", grid, grid.centre(start), grid.centre(target)), value, decimals, edges
    )


def by_force(grid, start, target, edges):
    """Lengths of all free polylines, in units, from every order of cells; edges as
    `identified.list_edges` finds them.
    """
    ways = identified.list_edges(grid)
    places = {int(cell): number for number, cell in enumerate(ways.cells)}
    for count in range(edges):
        for inner in itertools.product(places, repeat=count):
            path = (start, *inner, target)
            length = sum(
                ways.lengths[places[one], places[other]] for one, other in itertools.pairwise(path)
            )
            if math.isfinite(length):
                yield path, grid.cell * length


def test_an_edge_may_touch_an_occupied_cell_but_not_pass_through_it():
    ways = identified.list_edges(WALL)
    at = {int(cell): number for number, cell in enumerate(ways.cells)}
    assert ways.lengths[at[0], at[2]] == pytest.approx(2)
    assert math.isinf(ways.lengths[at[3], at[5]])
    assert ways.lengths[at[3], at[1]] == pytest.approx(math.sqrt(2))


def test_all_paths_of_a_printed_length_are_found():
    for path, length in by_force(WALL, 6, 8, 4):
        same = {other for other, own in by_force(WALL, 6, 8, 4) if abs(own - length) < 1e-6}
        fewest = min(map(len, same))
        own = found(WALL, 6, 8, round(length, 4), edges=4)
        assert set(own.paths) == {each for each in same if len(each) == fewest}, path
        assert own.length * 10 == pytest.approx(length)


def test_a_length_of_no_path_is_not_identified():
    own = found(OPEN, 0, 8, 28.2943)
    assert own.paths == []
    assert math.isnan(own.length)


@pytest.mark.parametrize(("printed", "named"), [(28.2, False), (28.3, True), (28.4, False)])
def test_a_length_is_named_if_it_rounds_to_the_printed_one(printed, named):
    """Of the diagonal, 28.284..., with one digit."""
    assert bool(found(OPEN, 0, 8, printed, decimals=1, edges=1).paths) == named


def test_chance_is_the_share_of_numbers_nearby():
    assert found(OPEN, 0, 8, 28.2843, edges=1).chance == pytest.approx(1 / 10001, rel=0.01)


def test_ends_beside_the_centres_are_not_tried():
    assert (
        identified.find_polylines(Problem("", OPEN, (0.0, 0.0), (25.0, 25.0)), 28.2843, 4, 3)
        is None
    )


def test_a_length_has_the_chance_of_the_printed_numbers_to_which_it_rounds():
    lengths = np.array([9.996, 10.004, 10.026])  # as 10.00, 10.00 and 10.03
    numbers = 2 * round(identified.NEARBY / 0.01) + 1
    assert identified._compute_chance(lengths, 10.0, 0.005) == pytest.approx(2 / numbers)


def test_chance_of_as_many():
    assert identified.compute_chance_of_at_least(2, [0.1, 0.2]) == pytest.approx(0.02)
    assert identified.compute_chance_of_at_least(1, [0.1, 0.2]) == pytest.approx(0.28)


def of_song2016(method):
    """What the audit says of the printed lengths of one of its methods, and of all together."""
    published = audit.read_printed_numbers(FOLDER / "song2016/published/table1.csv")
    problems = {name: problem_of("song2016", name) for name in published["problem"].unique()}
    entry = Identify(metric="objective", where={"method": method}, edges=7, because="polyline")
    *rows, together = identified.check_declared_paths("table1", published, [entry], problems)
    return rows, together


def chance_of(together):
    return float(together["arithmetic"].rpartition(": ")[2])


def test_non_smooth_lengths_of_song2016_are_identified():
    rows, together = of_song2016("nonsmooth")
    assert [row["consistent"] for row in rows] == [True] * 4
    assert "240 179 181 235 255;" in rows[2]["arithmetic"]
    assert (together["printed"], together["limit"]) == (4, 4)
    # "once in ten million" in the README
    assert 0.5e-7 < chance_of(together) < 1.5e-7


def test_smooth_lengths_of_song2016_may_be_those_of_control_polygons():
    """The README says so: three of four, and the chance."""
    _, together = of_song2016("smooth")
    assert (together["printed"], together["limit"]) == (3, 4)
    assert chance_of(together) == pytest.approx(1 / 9000, rel=0.1)


@pytest.mark.parametrize(
    ("marks", "verdict"),
    [
        ("++", "supported"),
        ("+-", "contradicted"),
        ("?-", "contradicted"),
        ("+0", "contradicted"),
        ("00", "no effect"),
        ("0?", "no effect"),
        ("+?", "undecided"),
    ],
)
def test_one_comparison_refutes_a_sentence_about_all_together(marks, verdict):
    assert verdicts.judge_marks(marks, marks, "together") == verdict


def test_signed_curvature_counts_left_turns_alone():
    left = Path("bezier", np.array([[0.0, 0], [4, 0], [4, 4]]))
    right = Path("bezier", np.array([[0.0, 0], [4, 0], [4, -4]]))
    assert (
        song2016.signed_curvature(left)
        == measures.max_curvature(left)
        == measures.max_curvature(right)
        > 0
    )
    assert song2016.signed_curvature(right) < 0


def test_generation_by_which_a_share_of_the_improvement_is_made():
    runs = pd.DataFrame({"history": [np.array([110.0, 102, 101, 100]), np.array([5.0, 5])]})
    assert song2016.find_generation_improved_by(0.9, runs, {}).tolist() == [2, 0]


@pytest.mark.parametrize("ends", ["0_15", "15_255", "240_255", "0_240"])
def test_drawn_paths_of_song2016_have_the_printed_length(ends):
    table = published("song2016")["table1"].query("metric == 'objective'")
    printed = table.set_index(["problem", "method"])["value"][ends, "nonsmooth"]
    marks = drawing("song2016", f"identified_{ends}")
    for _, line in marks[marks["mark"] == "line"].groupby("group"):
        length = np.hypot(*np.diff(line[["x", "y"]].to_numpy(), axis=0).T).sum()
        assert length == pytest.approx(printed, abs=5e-5)


def test_seven_minima_of_ma2020_are_straight_and_diagonal_moves_and_no_maximum_is():
    names, found = ("environment1", "environment2"), {"min": 0, "max": 0}
    problems = {name: problem_of("ma2020", name) for name in names}
    for n in (1, 2):
        published = audit.read_printed_numbers(FOLDER / f"ma2020/published/table{n}.csv")
        for statistic in ("min", "max"):
            where = {"method": ["aco", "ga", "aco_ga", "asfa_ga"]}
            told = {"metric": "length", "statistic": statistic, "where": where, "because": "cells"}
            entry = Identify(**told, diagonal=1.414)
            *rows, together = identified.check_declared_paths(
                f"table{n}", published, [entry], problems
            )
            found[statistic] += together["printed"]
            if statistic == "min":
                assert chance_of(together) < 1e-5
    assert found == {"min": 7, "max": 0}
    assert rows[3]["printed"] == 34.7728
    square = problems["environment1"]
    moves = identified.find_moves(square, 32.3821, 1.414)
    assert (moves.paths, moves.length) == ([(14, 13)], pytest.approx(32.382))
    assert 0 < moves.chance < 0.02
    # A root to four decimals does not give it, nor does an odd number of straight moves.
    assert identified.find_moves(square, 32.3821, 1.4142).paths == []
    assert identified.find_moves(square, 15 + 13 * 1.414, 1.414).paths == []
