"""The outcome that the repository keeps, and the summary that it is made from."""

from pathlib import Path

import outcome
import pandas as pd
import pytest

from bezierplan.analysis.outcome import summary
from bezierplan.commands import read_studies

ROOT = Path(__file__).parents[1]


def test_readme_shows_the_outcome_that_is_kept():
    readme = (ROOT / outcome.README).read_text(encoding="utf-8")
    shown = outcome.build_block(ROOT / outcome.KEPT, read_studies())
    assert outcome.replace_block(readme, outcome.BLOCK, shown) == readme


def comparison(values, ours, methods=("plain", "other")):
    frame = {
        "problem": "a",
        "method": methods,
        "metric": "length",
        "value_published": values,
        "value_ours_scaled": ours,
        "wide": False,
        "reason": "",
    }
    position = ["inside" if abs(a - b) < 1 else "above" for a, b in zip(values, ours, strict=True)]
    return pd.DataFrame(
        frame
        | {
            "statistic": "mean",
            "n_published": 10,
            "position": position,
            "possible": True,
        }
    )


def counted(*tables):
    return summary.list_numbers({("one", f"table{n}"): table for n, table in enumerate(tables)})[
        "counted"
    ].tolist()


def test_repeats_in_another_table_are_counted_once():
    first = comparison([1.0, 9.0], [1.2, 9.0])
    assert counted(first, comparison([1.0, 8.0], [1.2, 9.0])) == [True, True, False, True]
    assert counted(first, comparison([1.0, 9.0], [1.2, 9.0]).assign(problem="b")) == [True] * 4
    # Two tables may tell different columns apart: what both have decides.
    assert counted(first, first.drop(columns="problem")) == [True, True, False, False]


def test_impossible_and_unjudged_numbers_are_not_counted():
    table = comparison([1.0, 9.0], [1.2, 9.0])
    assert counted(table.assign(possible=[True, False], metric="feasible")) == [True, False]
    # A length below the bound is impossible on our map alone.
    assert counted(table.assign(possible=[True, False])) == [
        True,
        True,
    ]
    assert counted(table.assign(position=["no range", "inside"])) == [False, True]


def test_counts_that_add_up_are_one_number_fewer():
    table = comparison([4.0, 6.0], [4.0, 6.0]).assign(
        method="plain", metric=["optimal", "infeasible"], statistic="count"
    )
    assert counted(table) == [True, False]
    assert counted(table.assign(n_published=11)) == [True, True]
    assert counted(table.assign(method=["plain", "other"])) == [True, True]


def test_verdict_at_the_papers_size_stands_next_to_that_of_many_runs():
    claims = pd.DataFrame({"study": "one", "id": ["C1", "C1", "C2"], "variant": ["", "other", ""]})
    extended, full = (
        claims.assign(verdict=["supported", "partly", "contradicted"]),
        claims.assign(verdict=["undecided", "partly", "contradicted"]),
    )
    found = outcome.add_papers_size(extended, full.iloc[::-1])
    assert found["verdict"].to_list() == ["supported", "partly", "contradicted"]
    assert found["verdict_papers_size"].to_list() == ["undecided", "partly", "contradicted"]


def test_text_without_the_part_is_told():
    with pytest.raises(ValueError, match="no part between"):
        outcome.replace_block("nothing here", "outcome", "x")
