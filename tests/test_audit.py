"""What a printed table could be at all: GRIM, GRIMMER, ranges, ranks, orders and digits: worked
examples, real data, planted errors.
"""

import itertools
import math
from fractions import Fraction

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from bezierplan.analysis import audit, possible
from bezierplan.analysis.metrics import METRICS
from bezierplan.analysis.table_kinds import Layout, Monotone

ONE = Fraction(1)
LAYOUT = Layout()


def printed(text):
    return possible.printed(text)


def table(*rows, n=10):
    """Published numbers: (method, metric, statistic, text)."""
    frame = pd.DataFrame(rows, columns=["method", "metric", "statistic", "printed"]).assign(
        n=n, unit="-"
    )
    return frame.assign(value=frame["printed"].astype(float))


def audited(*rows, n=10, **layout):
    return audit.of_any_paper({"table1": table(*rows, n=n)}, {"table1": Layout(**layout)})


def marks(rows, word):
    """The marks of the rows whose rule has a word."""
    return [row["consistent"] for row in rows if word in row["rule"]]


# GRIM


@pytest.mark.parametrize(
    ("text", "n", "total"),
    [
        ("5.19", 28, None),  # Brown and Heathers (2017): 145 / 28 = 5.18, 146 / 28 = 5.21
        ("5.18", 28, 145),
        ("5.21", 28, 146),
        ("7.35", 20, 147),
        ("7.36", 20, None),
        ("2.5", 2, 5),
        ("0.33", 3, 1),
        ("0.34", 3, None),
        ("4.125", 4, None),
        ("-0.33", 3, -1),
    ],
)
def test_grim_on_worked_examples(text, n, total):
    assert list(possible.sums(printed(text), n, ONE)) == ([] if total is None else [total])


def test_grim_accepts_halves_rounded_either_way():
    assert (
        len(possible.sums(printed("0.12"), 8, ONE))
        == len(possible.sums(printed("0.13"), 8, ONE))
        == 1
    ), "1 / 8 = 0.125"


def test_grim_says_when_it_cannot_tell():
    assert possible.grim_decides(printed("7.35"), 99, ONE)
    assert not possible.grim_decides(printed("7.35"), 100, ONE)
    assert possible.grim_decides(printed("7.35"), 40, Fraction(1, 2))
    assert not possible.grim_decides(printed("7.35"), 50, Fraction(1, 2))


def test_a_row_shows_its_arithmetic():
    (right,) = audited(("a", "evaluations", "mean", "7.35"), n=20)
    assert right["consistent"]
    assert right["arithmetic"].startswith("7.35 x 20 = 147;")
    (wrong,) = audited(("a", "evaluations", "mean", "7.36"), n=20)
    assert wrong["consistent"] is False
    assert wrong["arithmetic"] == "7.36 x 20 = 147.2; nearest possible: 147 / 20 = 7.35"
    assert wrong["limit"] == 7.35
    (open_,) = audited(("a", "evaluations", "mean", "7.3"), n=20)
    assert open_["consistent"] is None
    assert "every one is possible" in open_["arithmetic"]


def test_a_mean_of_an_unknown_number_of_runs_cannot_be_judged():
    (row,) = audited(("a", "evaluations", "mean", "7.36"), n=20, selected=["evaluations"])
    assert row["consistent"] is None
    assert "how many is not printed" in row["arithmetic"]
    assert audited(("a", "evaluations", "mean", "7.36"), n=np.nan) == []


def test_what_is_no_count_has_no_grim_row():
    assert audited(("a", "objective", "mean", "7.36"), n=20) == []


# GRIMMER


def test_grimmer_on_worked_examples():
    # 62 / 18 = 3.44, and 317 alone lies between 17 x 2.465^2 + 62^2 / 18 and 17 x 2.475^2 + 62^2 /
    # 18: odd, while the sum is even.
    assert possible.grimmer(printed("3.44"), printed("2.47"), 18, ONE) is None
    assert possible.grimmer(printed("3.44"), printed("2.45"), 18, ONE) is not None
    # 1, 2, ..., 5: sum 15, sum of squares 55, standard deviation sqrt(2.5).
    assert possible.grimmer(printed("3.00"), printed("1.58"), 5, ONE) == (15, 55)
    assert possible.grimmer(printed("3.00"), printed("1.57"), 5, ONE) is None
    # Four numbers with the sum 6 are at best 1, 1, 2, 2; equal numbers of 1.5 would give 0.
    assert possible.least_squares(6, 4) == 10
    assert possible.grimmer(printed("1.50"), printed("0.00"), 4, ONE) is None
    assert possible.grimmer(printed("1.50"), printed("0.58"), 4, ONE) == (6, 10)
    assert possible.grimmer(printed("5.19"), printed("1.00"), 28, ONE) is None, (
        "no mean, no standard deviation"
    )


def test_grimmer_refuses_nothing_real_and_most_that_is_not():
    """Three whole numbers with a mean from 0 to 2 and a standard deviation below 4: none lies 5
    from the mean, so these are all of them.
    """
    data = np.array(list(itertools.combinations_with_replacement(range(-5, 8), 3)))
    pairs = [
        (f"{mean:.2f}", f"{std:.2f}")
        for mean, std in zip(data.mean(axis=1), data.std(axis=1, ddof=1))
        if 0 <= mean <= 2 and std < 3.995
    ]
    means, stds = (
        ("0.00", "0.33", "0.67", "1.00", "1.33", "1.67", "2.00"),
        [f"{k / 100:.2f}" for k in range(400)],
    )
    accepted = {
        (mean, std)
        for mean in means
        for std in stds
        if possible.grimmer(printed(mean), printed(std), 3, ONE)
    }
    assert set(pairs) <= accepted
    assert len(accepted) < 2 * len(set(pairs)), (
        "some sums of squares belong to no three numbers: the conditions are not sufficient"
    )
    assert len(accepted) < 0.05 * len(means) * len(stds)


whole = st.lists(st.integers(0, 40), min_size=2, max_size=60)


def of_one_cell(metric, n, **texts):
    return audit.of_cells(audit.Cell("table1", "method=a", metric, texts, n, exact=True))


@given(whole, st.integers(0, 4), st.integers(0, 4))
def test_tables_of_real_whole_numbers_pass(values, decimals, std_decimals):
    mean, std = np.mean(values), np.std(values, ddof=1)
    quantiles = {"min": min(values), "median": np.median(values), "max": max(values)}
    texts = {name: f"{value:.{decimals}f}" for name, value in {"mean": mean, **quantiles}.items()}
    found = of_one_cell("evaluations", len(values), **texts, std=f"{std:.{std_decimals}f}")
    assert [row for row in found if row["consistent"] is False] == []
    assert {"GRIM", "GRIMM"} <= {row["rule"][:5].rstrip(":") for row in found}


@given(st.lists(st.floats(0, 1e4), min_size=2, max_size=40))
def test_tables_of_real_times_pass(values):
    values = [round(each, 6) for each in values]
    numbers = {
        "min": min(values),
        "max": max(values),
        "mean": math.fsum(values) / len(values),
        "std": np.std(values, ddof=1),
    }
    found = of_one_cell(
        "cpu_s", len(values), **{name: f"{value:.4f}" for name, value in numbers.items()}
    )
    assert len(found) == 4
    assert all(row["consistent"] for row in found)


# Standard deviation, mean and range


def test_planted_errors_of_spread_and_order_are_found():
    ends = [("a", "cpu_s", "min", "1.0"), ("a", "cpu_s", "max", "3.0")]
    # Five at either end have the largest standard deviation, one at either end and eight midway the
    # least.
    largest, least = 1.0 * math.sqrt(10 / 9), 2 / math.sqrt(18)
    assert np.std([1] * 5 + [3] * 5, ddof=1) == pytest.approx(largest)
    assert np.std([1, 3] + [2] * 8, ddof=1) == pytest.approx(least)
    for text, fits in (("1.05", True), ("1.20", False), ("0.48", True), ("0.30", False)):
        assert marks(audited(*ends, ("a", "cpu_s", "std", text)), "(max - min)") == [fits], text
    # With ten values, nine of which are 1 or 3, a mean lies from 1.2 to 2.8.
    for text, fits in (
        ("1.20", True),
        ("1.00", False),
        ("2.80", True),
        ("2.99", False),
        ("3.50", False),
    ):
        assert marks(audited(*ends, ("a", "cpu_s", "mean", text)), "a mean of 10") == [fits], text
    assert marks(
        audited(("a", "cpu_s", "min", "3.1"), ("a", "cpu_s", "max", "3.0")), "min <= max"
    ) == [False]
    assert marks(
        audited(("a", "cpu_s", "median", "3.3"), ("a", "cpu_s", "max", "3.0")), "median <= max"
    ) == [False]


def test_times_above_0_limit_the_standard_deviation_by_the_mean():
    """Nine times of 0 and one of 10 have the mean 1 and the standard deviation sqrt(10)."""
    assert np.std([0] * 9 + [10], ddof=1) == pytest.approx(math.sqrt(10))
    for text, fits in (("3.16", True), ("3.17", True), ("3.40", False)):
        assert marks(
            audited(("a", "cpu_s", "mean", "1.00"), ("a", "cpu_s", "std", text)),
            "largest standard deviation",
        ) == [fits], text


@given(st.lists(st.integers(0, 20), min_size=2, max_size=30))
def test_two_ends_limit_the_standard_deviation_further(values):
    mean = possible.Printed(Fraction(sum(values), len(values)), Fraction(0))
    limit = possible.std_of_mean(mean, len(values), Fraction(0), Fraction(20))
    assert np.std(values, ddof=1) <= limit * (1 + 1e-12)
    assert limit <= possible.std_of_mean(mean, len(values), Fraction(0), None) * (1 + 1e-12)


def test_a_mean_beyond_both_ends_of_a_metric_is_found():
    assert marks(
        audited(("a", "collisions_a", "mean", "20.0"), ("b", "collisions_a", "mean", "20.2")),
        "0 to 20",
    ) == [True, False]


def test_counts_are_whole_and_not_above_the_runs():
    rows = audited(
        *((name, "optimal", "count", text) for name, text in zip("abcd", ("10", "11", "2.5", "0")))
    )
    assert marks(rows, "a count of 10 runs") == [True, False, False, True]
    assert marks(
        audited(("a", "corners", "max", "2.5"), ("b", "corners", "min", "2")), "an extreme"
    ) == [False, True]


# Ranks


def ranks(*texts, **layout):
    return audited(*((str(k), "rank", "mean", text) for k, text in enumerate(texts)), **layout)


@settings(deadline=None, max_examples=10)
@given(st.integers(2, 8), st.integers(1, 12), st.randoms(use_true_random=False))
def test_ranks_of_real_data_pass(methods, units, random):
    values = np.array([[random.randint(0, 9) for _ in range(methods)] for _ in range(units)])
    mean = stats.rankdata(values, axis=1).mean(axis=0)
    found = ranks(*(f"{each:.2f}" for each in mean), n=units)
    assert len(marks(found, "add to")) == 1
    assert not any(row["consistent"] is False for row in found)


def test_planted_errors_of_ranks_are_found():
    assert marks(ranks("1.2", "2.0", "2.8"), "add to") == [True]
    assert marks(ranks("1.2", "2.0", "2.2"), "add to") == [False]
    assert marks(ranks("0.5", "2.0", "3.5"), "lies between") == [False, True, False]
    (row,) = [row for row in ranks("1.2", "2.0", "2.8") if "add to" in row["rule"]]
    assert row["arithmetic"] == "1.2 + 2.0 + 2.8 = 6; 3 x 4 / 2 = 6"


def test_ranks_are_added_within_the_columns_of_a_table():
    rows = [
        (name, "rank", "mean", text) for name, text in zip("abab", ("1.2", "1.8", "1.5", "1.5"))
    ]
    numbers = table(*rows).assign(problem=["p", "p", "q", "q"])
    found = audit.of_any_paper({"table1": numbers}, {"table1": Layout(columns=["problem"])})
    assert marks(found, "add to") == [True, True]
    assert marks(audit.of_any_paper({"table1": numbers}, {"table1": LAYOUT}), "add to") == [False]


def test_orders_of_means_and_ranks_that_differ_are_told_but_not_blamed():
    same = [
        ("a", "rank", "mean", "1.0"),
        ("b", "rank", "mean", "2.0"),
        ("a", "objective", "mean", "5.0"),
        ("b", "objective", "mean", "6.0"),
    ]
    assert marks(audited(*same), "different orders") == [True]
    (row,) = [
        row
        for row in audited(*same[:2], ("a", "objective", "mean", "7.0"), same[3])
        if "different orders" in row["rule"]
    ]
    assert (row["consistent"], row["printed"]) == (None, 1)
    assert row["arithmetic"] == "1 of 1 pairs; 6.0 < 7.0 but 2.0 > 1.0"


# Orders


def test_an_order_that_must_be_kept():
    numbers = table(
        ("a", "length", "mean", "5.0"),
        ("a", "length", "mean", "5.2"),
        ("a", "length", "mean", "5.1"),
        ("a", "length", "max", "1"),
    )
    numbers = numbers.assign(obstacles=[1, 3, 2, 4])
    rule = Monotone(
        metric="length",
        statistic="mean",
        along="obstacles",
        direction="up",
        because="it is said",
    )
    assert [row["consistent"] for row in audit.of_orders("table1", numbers, rule)] == [True, True]
    (first, second) = audit.of_orders("table1", numbers, rule.but(direction="down"))
    assert (first["consistent"], second["consistent"]) == (False, False)
    assert (second["place"], second["arithmetic"]) == (
        "method=a, obstacles=3, metric=length, statistic=mean",
        "5.1 >= 5.2",
    )


# Digits


@pytest.mark.parametrize("counts", [[3, 0], [2, 1, 0], [2, 2, 1], [4, 0, 1]])
def test_the_test_of_digits_counts_every_way(counts):
    ways = [
        np.bincount(way, minlength=len(counts))
        for way in itertools.product(range(len(counts)), repeat=sum(counts))
    ]
    uneven = [np.sum(way**2) >= np.sum(np.square(counts)) for way in ways]
    assert possible.digits_p(counts) == pytest.approx(np.mean(uneven))


def test_lost_zeros_are_last_digits_too():
    assert possible.last_digits(["1.50", "1.9", "2.09", "10.883", "-0.17"]) == [0, 0, 9, 8, 7]


def numbers_of(texts):
    return audited(*((str(k), "cpu_s", "mean", text) for k, text in enumerate(texts)))


def test_invented_digits_are_found_and_others_are_not():
    rng = np.random.default_rng(5)
    drawn = rng.uniform(1, 9, 40)
    assert marks(numbers_of([f"{each:.2f}" for each in drawn]), "last digits") == [True]
    assert marks(numbers_of([f"{each:.1f}7" for each in drawn]), "last digits") == [False]
    assert marks(numbers_of([f"{each:.2f}" for each in drawn[:29]]), "last digits") == [], "too few"
    assert marks(numbers_of([f"{4 + each / 100:.2f}" for each in drawn]), "last digits") == [], (
        "too near to each other"
    )


def test_numbers_printed_twice_count_once():
    numbers = table(*((str(k), "cpu_s", "mean", f"{k / 7 + 1:.2f}") for k in range(20)))
    both = audit.of_any_paper(
        {"table1": numbers, "table2": numbers}, {"table1": LAYOUT, "table2": LAYOUT}
    )
    assert marks(both, "last digits") == []


def test_means_and_extremes_are_allowed_to_be_rounded(monkeypatch):
    share = METRICS["feasible"]._replace(least=0.0, most=1.06, step=0.13)
    monkeypatch.setitem(METRICS, "feasible", share)

    def judged(find, name, text):
        rows = find(
            audit.Cell("table1", "", "feasible", {name: text}, 10, True), {name: printed(text)}
        )
        return [row["consistent"] for row in rows]

    # The end, 1.06, is printed as 1.1, and 0.13 as 0.1.
    assert judged(audit._in_range, "mean", "1.08") == [False]
    assert judged(audit._in_range, "mean", "1.1") == [True]
    assert judged(audit._of_steps, "max", "0.1") == [True]
    assert judged(audit._of_steps, "max", "0.16") == [False]
