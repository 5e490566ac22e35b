"""What a figure shows, in words."""

import numpy as np
import pandas as pd
import pytest
from test_figures import comparing_panels, comparison, drawn, panels, results
from test_legibility import COMPARED
from test_legibility import drawn as drawn_of_all_kinds

from bezierplan.figures import seen


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (
            {"a": 2.0, "b": 1.0, "c": 3.25},
            "lowest median: b (1), highest: c (3.25)",
        ),
        ({"a": 2.0, "b": np.inf, "c": 3.0}, "lowest median: a (2), highest: c (3)"),
        ({"a": 1.0, "b": 1.0, "c": 3.0}, "lowest median: a and b (1), highest: c (3)"),
        ({"a": 1.0, "b": 1.0}, "median 1 of all"),
        ({"a": 12345.6, "b": 0.00123456}, "lowest median: b (0.001235), highest: a (12,346)"),
        ({"a": 2.0, "b": np.nan}, ""),
        ({}, ""),
    ],
)
def test_the_ends_of_several_values(values, expected):
    assert seen.extremes("median", values) == expected


def test_who_is_lowest_and_highest_in_most_rows():
    table = pd.DataFrame(
        {"a": [1.0, 2, 3, np.nan], "b": [2.0, 1, 2, 7], "c": [3.0, 4, 2.5, np.nan]}
    )
    assert seen.mostly("mean", table) == "lowest mean in 2 of 3: b, highest mean in 2 of 3: c"
    assert seen.mostly("mean", table.iloc[:1]) == "lowest mean: a (1), highest: c (3)"
    assert seen.mostly("mean", table.iloc[3:]) == ""


def test_a_figure_says_in_the_last_line_of_its_caption_what_is_seen(tmp_path):
    told, last = drawn(comparison(), comparing_panels()[:8], 2, tmp_path).get_label().split("\n")
    assert "run" in told
    assert "lowest" not in told
    assert last.split(". ")[:2] == [
        "(a) lowest final mean: coarse (26.83), highest: random (46.83)",
        "(b) lowest final median: points = 2 (35.5), highest: points = 5 (38.5)",
    ]
    assert (
        "(d), (f) lowest mean length in 3 of 3: coarse, highest mean length in 3 of 3: random"
        in last
    )
    assert "(h) lowest median: coarse (27), highest: random (47)" in last
    one_run = drawn(results(), panels()[:3], 2, tmp_path).get_label()
    assert "\n" not in one_run, "nothing is compared"


def test_comparisons_of_all_planners_say_who_is_best(tmp_path):
    last = drawn_of_all_kinds(results(), COMPARED, 2, tmp_path).get_label().splitlines()[-1]
    assert "(a) lowest mean rank: smooth (quadratic pieces) (1.2), highest: random (2.9)" in last
    assert "; never: random. (c)" in last
    assert "(c) lowest share of problems on which it is the best: " in last
