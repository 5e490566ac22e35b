"""The outcome that the repository keeps, and the summary that it is made from."""

from pathlib import Path

import pandas as pd
import pytest

from bezierplan import outcome
from bezierplan.analysis import summary

ROOT = Path(__file__).parents[1]


def test_readme_shows_the_outcome_that_is_kept():
    readme = (ROOT / outcome.README).read_text(encoding="utf-8")
    assert summary.with_block(readme, outcome.BLOCK, outcome.table(ROOT / outcome.KEPT)) == readme


def comparison(values, ours):
    reproduced = [abs(a - b) < 1 for a, b in zip(values, ours, strict=True)]
    frame = {"problem": "a", "method": ["plain", "other"], "metric": "length", "value_published": values, "value_ours": ours}
    return pd.DataFrame(frame | {"reproduced": reproduced})


def test_readings_that_do_not_decide_are_not_counted():
    numbers = summary.numbers({("one", "table1"): comparison([1.0, 9.0], [1.2, 1.2])}, {"one": ["other"]})
    claims = pd.DataFrame(
        {"study": "one", "id": ["C1", "C1", "C2"], "decides": [True, False, True], "verdict": ["supported", "in part", "no effect"]}
        | {"finding": False}
    )
    counted = summary.outcome(numbers, claims).loc["one"]
    assert (counted["numbers"], counted["reproduced"]) == (1, 1)
    assert (counted["supported"], counted["in part"], counted["no effect"]) == (1, 0, 1)


def test_published_number_that_is_wrong_is_counted_as_not_reproduced():
    numbers = summary.numbers({("one", "table1"): comparison([1.0, 9.0], [1.2, 1.2])}, {"one": []})
    claims = pd.DataFrame({"study": ["one"], "id": ["C1"], "decides": [True], "finding": [False], "verdict": ["supported"]})
    counted = summary.outcome(numbers, claims).loc["one"]
    assert (counted["numbers"], counted["reproduced"]) == (2, 1)


def test_numbers_without_a_published_value_are_left_out():
    table = comparison([1.0, float("nan")], [1.2, 1.2])
    assert summary.numbers({("one", "table1"): table}, {"one": []})["method"].tolist() == ["plain"]


def test_other_conditions_than_the_deciding_one_are_not_counted():
    table = comparison([1.0, 9.0], [1.2, 9.0]).assign(workspace=["first", "second"])
    numbers = summary.numbers({("one", "table1"): table}, {"one": []}, {("one", "table1"): {"workspace": "first"}})
    assert numbers["decides"].tolist() == [True, False]


def test_text_without_the_part_is_told():
    with pytest.raises(ValueError, match="no part between"):
        summary.with_block("nothing here", "outcome", "x")
