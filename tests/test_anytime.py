"""Anytime curves of the comparison with other libraries, on attempts whose answers are known."""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

sys.path.insert(0, str(Path(__file__).parent / "benchmark"))

from anytime import best_at, quartiles, time_table, times_until

# Three runs: one gets within 1 %, one within 10 %, and one has no path that the checker accepts.
ATTEMPTS = pd.DataFrame(
    [
        (0, 1.0, 0.5),
        (0, 2.0, 0.08),
        (0, 4.0, 0.005),
        (1, 1.0, np.inf),
        (1, 3.0, 0.1),
        (1, 5.0, 0.2),
        (2, 1.0, np.inf),
    ],
    columns=["seed", "cpu_s", "excess"],
).assign(problem="room", method="walk")


def test_the_best_path_by_a_time_is_never_a_later_or_a_worse_one() -> None:
    best = best_at(
        np.array([0.5, 1.0, 2.5, 3.0, 9.0]), np.array([3.0, 1.0, 2.0]), np.array([0.4, 0.3, 0.1])
    )
    assert best.tolist() == [np.inf, 0.3, 0.1, 0.1, 0.1]


def test_quartiles_are_values_of_single_runs_and_infinite_while_too_few_have_a_path() -> None:
    low, median, high = quartiles(ATTEMPTS, np.array([0.5, 2.0, 3.0, 6.0]))
    assert low.tolist() == [np.inf, 0.08, 0.08, 0.005]
    assert median.tolist() == [np.inf, np.inf, 0.1, 0.1]
    assert np.isinf(high).all()


@pytest.mark.parametrize(
    ("share", "times"), [(0.1, [2.0, 3.0, np.inf]), (0.05, [4.0, np.inf, np.inf])]
)
def test_the_first_attempt_within_a_share_counts(share: float, times: list[float]) -> None:
    assert times_until(ATTEMPTS, share).tolist() == times


def test_the_order_of_rows_does_not_matter() -> None:
    shuffled = ATTEMPTS.sample(frac=1, random_state=0)
    assert times_until(shuffled, 0.1).tolist() == times_until(ATTEMPTS, 0.1).tolist()
    assert (
        quartiles(shuffled, np.array([2.0])).tolist()
        == quartiles(ATTEMPTS, np.array([2.0])).tolist()
    )


def test_table_counts_runs_that_never_get_there() -> None:
    table = time_table(pd.concat([ATTEMPTS, ATTEMPTS.assign(method="run", cpu_s=1.0)]), (0.1, 0.01))
    assert table[["method", "within"]].to_records(index=False).tolist() == [
        ("walk", 0.1),
        ("walk", 0.01),
        ("run", 0.1),
        ("run", 0.01),
    ]
    assert table["median_s"].tolist() == [3.0, np.inf, 1.0, np.inf]
    assert table["reached"].tolist() == pytest.approx([2 / 3, 1 / 3, 2 / 3, 1 / 3])
