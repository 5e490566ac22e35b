"""What a printed table could be at all: ranges, ranks, orders and decimals: worked examples, real
data, planted errors.
"""

import math
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from studies import FOLDER

from bezierplan.analysis.audit import audit, possible
from bezierplan.analysis.table_kinds import Monotone


def table(*rows, n=10):
    """Published numbers: (method, metric, statistic, text)."""
    frame = pd.DataFrame(rows, columns=["method", "metric", "statistic", "as_printed"]).assign(
        n=n, unit="-"
    )
    return frame.assign(value=frame["as_printed"].astype(float))


def spec(columns=(), picks=(), monotone=()):
    """What the rules ask of a table's description."""
    values = [SimpleNamespace(metric=metric, where={"feasible": True}) for metric in picks]
    return SimpleNamespace(across=list(columns), values=values, monotone=monotone)


def read(name):
    return audit.read_printed_numbers(FOLDER / name)


def audited(*rows, n=10, **keys):
    return audit.check_any_paper({"table1": table(*rows, n=n)}, {"table1": spec(**keys)})


def marks(rows, word):
    """The marks of the rows whose rule has a word."""
    return [row["consistent"] for row in rows if word in row["rule"]]


# Statistics of one cell


@pytest.mark.parametrize("metric", ["evaluations", "cpu_s"])
@given(
    values=st.lists(st.integers(0, 40_000_000), min_size=2, max_size=60),
    scale=st.sampled_from([1, 1e-6]),
    decimals=st.integers(0, 4),
)
def test_tables_of_real_numbers_pass(metric, values, scale, decimals):
    values = [each * scale if metric == "cpu_s" else each for each in values]
    numbers = {
        "min": min(values),
        "median": np.median(values),
        "max": max(values),
        "mean": math.fsum(values) / len(values),
        "std": np.std(values, ddof=1),
    }
    rows = [("a", metric, name, f"{value:.{decimals}f}") for name, value in numbers.items()]
    found = audited(*rows, n=len(values))
    assert len(found) == 5 + len(marks(found, "multiples of 1"))
    assert all(row["consistent"] for row in found)


MIN, MAX = ("a", "cpu_s", "min", "1.0"), ("a", "cpu_s", "max", "3.0")


@pytest.mark.parametrize(
    ("rule", "cells", "statistic", "texts"),
    [
        # Five at either end have the largest standard deviation, one at either end and eight midway
        # the least.
        ("(max - min)", [MIN, MAX], "std", {"1.05": 1, "1.20": 0, "0.48": 1, "0.30": 0}),
        # With ten values, nine of which are 1 or 3, a mean lies from 1.2 to 2.8.
        ("a mean lies", [MIN, MAX], "mean", {"1.20": 1, "1.00": 0, "2.80": 1, "2.99": 0}),
        ("min <= max", [MAX], "min", {"3.0": 1, "3.1": 0}),
        ("median <= max", [MAX], "median", {"3.0": 1, "3.3": 0}),
        # Nine times of 0 and one of 10 have the mean 1 and the standard deviation sqrt(10).
        ("largest", [("a", "cpu_s", "mean", "1.00")], "std", {"3.16": 1, "3.17": 1, "3.40": 0}),
    ],
)
def test_planted_errors_of_one_cell_are_found(rule, cells, statistic, texts):
    for text, fits in texts.items():
        rows = audited(*cells, ("a", "cpu_s", statistic, text))
        assert marks(rows, rule) == [bool(fits)], text


def test_fewer_runs_than_printed_can_spread_more():
    """Two values at the ends have a larger standard deviation than ten."""
    cells = [("a", "length", *each[2:]) for each in (MIN, MAX, ("", "", "std", "1.40"))]
    assert marks(audited(*cells), "(max - min)") == [True]
    cells = [("a", "cpu_s", *each[2:]) for each in cells]
    assert marks(audited(*cells), "(max - min)") == [False]
    assert marks(audited(*cells, picks=["cpu_s"]), "(max - min)") == [True]
    assert audited(*cells[2:], n=np.nan) == []


@given(st.lists(st.integers(0, 20), min_size=2, max_size=30))
def test_two_ends_limit_the_standard_deviation_further(values):
    mean = possible.Printed(Fraction(sum(values), len(values)), Fraction(0))
    limit = possible.compute_largest_std(mean, len(values), Fraction(0), Fraction(20))
    assert np.std(values, ddof=1) <= limit * (1 + 1e-12)
    assert limit <= possible.compute_largest_std(mean, len(values), Fraction(0), None) * (1 + 1e-12)


def test_counts_are_whole_and_not_above_the_runs():
    cells = [
        (name, "optimal", "count", text) for name, text in zip("abcd", ["10", "11", "2.5", "0"])
    ]
    assert marks(audited(*cells), "a count of 10 runs") == [False, False, True]


def test_means_of_whole_numbers_where_some_printed_number_is_impossible():
    """GRIM (Brown and Heathers 2017), their first example: no 28 whole numbers have the mean
    5.19.
    """
    cells = {text: ("a", "evaluations", "mean", text) for text in ("5.19", "5.18", "5.2")}
    found = {text: marks(audited(cell, n=28), "multiples of 1") for text, cell in cells.items()}
    assert found == {"5.19": [False], "5.18": [True], "5.2": []}
    assert marks(audited(cells["5.19"], n=np.nan), "multiples") == []
    assert marks(audited(("a", "feasible", "share", "0.33")), "multiples of 1") == [False]
    assert marks(audited(("a", "length", "mean", "5.19"), n=28), "multiples") == []


def test_cells_of_an_unknown_number_of_runs():
    """Any two values at the ends have a standard deviation of the range over the root of 2."""
    for statistic, texts in {
        "mean": {"3.0": True, "3.1": True, "3.2": False},
        "std": {"0.00": True, "1.48": True, "1.50": False},
    }.items():
        for text, fits in texts.items():
            cells = audited(MIN, MAX, ("a", "cpu_s", statistic, text), n=np.nan)
            assert [row["consistent"] for row in cells if statistic in row["place"]] == [fits], text


# Ranks


def ranks(*texts, **layout):
    return audited(*((str(k), "rank", "mean", text) for k, text in enumerate(texts)), **layout)


@settings(max_examples=10)
@given(st.integers(2, 8), st.integers(1, 12), st.randoms(use_true_random=False))
def test_ranks_of_real_data_pass(methods, units, random):
    values = np.array([[random.randint(0, 9) for _ in range(methods)] for _ in range(units)])
    mean = stats.rankdata(values, axis=1).mean(axis=0)
    found = ranks(*(f"{each:.2f}" for each in mean), n=units)
    assert len(marks(found, "add to")) == 1
    assert all(row["consistent"] for row in found)


def test_planted_errors_of_ranks_are_found():
    assert marks(ranks("1.2", "2.0", "2.2"), "add to") == [False]
    assert marks(ranks("0.5", "2.0", "3.5"), "lies between") == [False, True, False]
    (row,) = [row for row in ranks("1.2", "2.0", "2.8") if "add to" in row["rule"]]
    assert row["consistent"]
    assert row["arithmetic"] == "1.2 + 2.0 + 2.8 = 6; 3 x 4 / 2 = 6"


def test_ranks_are_added_within_the_columns_of_a_table():
    rows = [
        (name, "rank", "mean", text) for name, text in zip("abab", ("1.2", "1.8", "1.5", "1.5"))
    ]
    numbers = table(*rows)
    numbers.insert(0, "problem", ["p", "p", "q", "q"])
    for columns, sums in ((["problem"], [True, True]), ([], [False])):
        assert marks(audit.check_ranks("table1", numbers, columns), "add to") == sums


# Orders


def test_an_order_that_must_be_kept():
    numbers = table(
        ("a", "length", "mean", "5.0"),
        ("a", "length", "mean", "5.2"),
        ("a", "length", "mean", "5.1"),
        ("a", "length", "max", "1"),
    )
    numbers.insert(1, "obstacles", [1, 3, 2, 4])
    rule = Monotone(
        metric="length",
        statistic="mean",
        along="obstacles",
        direction="up",
        because="it is said",
    )
    assert [row["consistent"] for row in audit.check_orders("table1", numbers, rule)] == [
        True,
        True,
    ]
    (first, second) = audit.check_orders("table1", numbers, rule.but(direction="down"))
    assert (first["consistent"], second["consistent"]) == (False, False)
    assert (second["place"], second["arithmetic"]) == (
        "method=a, obstacles=3, metric=length, statistic=mean",
        "5.1 >= 5.2",
    )


# What the numbers of a whole table say


@pytest.mark.parametrize(
    ("printed", "bound", "consistent"),
    [
        ("29.94", 29.9449, True),
        ("29.94", 29.9451, False),
        ("30", 30.49, True),
        ("30", 30.51, False),
        ("30.0", 30.051, False),
        ("31", 30.0, True),
    ],
)
def test_a_printed_length_may_lie_below_the_bound_by_half_a_unit_of_its_last_digit(
    printed, bound, consistent, tmp_path
):
    file = tmp_path / "table1.csv"
    file.write_text(
        f"problem,method,metric,statistic,n,unit,value\nacross,plain,length,min,10,m,{printed}\nacross,plain,cpu_s,min,10,s,1\n"
    )
    bounds = pd.DataFrame({"bound": [bound]}, index=["across"])
    (row,) = audit.check_lengths("table1", audit.read_printed_numbers(str(file)), bounds, {})
    assert bool(row["consistent"]) == consistent
    assert (row["printed"], row["limit"]) == (float(printed), bound)
    assert row["place"].startswith("problem=across, method=plain")
