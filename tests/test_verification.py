"""`verify --outcome`: equal numbers pass, chance seldom fails, and a real difference is
found.
"""

import re

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from studies import studies

from bezierplan import __main__
from bezierplan.analysis.outcome import verification


def rows(values, unit="m", n=50, width=1.0):
    """A comparison of some numbers."""
    values = np.asarray(values, dtype=float)
    named = pd.DataFrame(
        {
            "method": [f"m{i}" for i in range(len(values))],
            "metric": "length",
            "statistic": "mean",
            "unit": unit,
        }
    )
    measured = {"n_published": np.nan, "value_published": 1.0, "n_ours": n, "value_ours": values}
    return named.assign(**measured, low95_ours=values - width / 2, high95_ours=values + width / 2)


def test_equal_numbers_pass():
    found = verification.compared(rows([1.0, 2.0]), rows([1.0, 2.0]))
    assert found["p"].tolist() == [1.0, 1.0]
    assert verification.failed(found).empty


def test_a_difference_beyond_chance_is_found_and_named():
    found = verification.compared(rows([1.0, 2.0, 3.0]), rows([1.1, 2.0, 5.0]))
    assert verification.failed(found)["method"].tolist() == ["m2"]
    assert found["p"][0] > 0.5


@pytest.mark.parametrize(("p", "fails"), [(0.0049, True), (0.0051, False)])
def test_two_numbers_share_the_rate_of_one_percent(p, fails):
    numbers = pd.DataFrame({"p": [p, 0.5, np.nan]})
    assert len(verification.failed(numbers)) == fails


def test_p_is_that_of_welch_s_t_for_means():
    """Of two samples of 10 with standard errors 3 and 4: the difference 10 is 2 of its errors."""
    errors = (3 * np.sqrt(0.9), 4 * np.sqrt(0.9))  # a bootstrap's are smaller
    widths = [np.array([2 * stats.norm.ppf(0.975) * each]) for each in errors]
    values = [np.array([0.0]), np.array([10.0])]
    (p,) = verification.p_values(values, widths, [np.array([10]), np.array([20])])
    own = np.hypot(3, 4 * np.sqrt(0.9 / 0.95))
    assert p == pytest.approx(2 * stats.t.sf(10 / own, 9))


def test_numbers_that_no_chance_decides_must_be_equal():
    found = verification.compared(
        rows([100.0, 100.0], width=0.0), rows([100.0 + 1e-7, 100.1], width=0.0)
    )
    assert found["p"].tolist() == [1.0, 0.0]


@pytest.mark.parametrize("given", [{"unit": "s"}, {"n": 1}, {"n": 0}, {"width": np.nan}])
def test_nothing_is_said_of_times_single_runs_and_extremes(given):
    found = verification.compared(rows([1.0], **given), rows([9.0], **given))
    assert found["p"].isna().all()
    assert verification.failed(found).empty


def test_names_match_however_a_column_was_read():
    kept, own = (rows([1.0, 2.0]).assign(method=method) for method in (["10.0", "20.0"], [10, 20]))
    assert len(verification.compared(kept, own)) == 2


DRAWS = {
    "skewed": lambda rng, n: rng.lognormal(0.0, 1.0, n),
    "two corridors": lambda rng, n: (
        np.where(rng.random(n) < 0.8, 7.5, 9.3) + 0.05 * rng.standard_normal(n)
    ),
    "counts": lambda rng, n: rng.poisson(2.0, n).astype(float),
    "a share": lambda rng, n: (rng.random(n) < 0.3).astype(float),
}


@pytest.mark.parametrize("name", DRAWS)
@pytest.mark.parametrize("statistic", [np.mean, np.median])
def test_independent_samples_of_one_distribution_seldom_fail(name, statistic):
    """Of pairs of samples of ten runs, hardly any have a p as small as fails one of 628 numbers: so
    these keep the stated rate.
    """
    rng, pairs, n = np.random.default_rng(0), 1000, 10
    samples = DRAWS[name](rng, 2 * pairs * n).reshape(2, pairs, n)
    again = rng.integers(0, n, (200, n))
    spread = statistic(samples[:, :, again], axis=-1)
    widths = np.quantile(spread, 0.975, axis=-1) - np.quantile(spread, 0.025, axis=-1)
    p = verification.p_values(
        list(statistic(samples, axis=-1)), list(widths), [np.full(pairs, n)] * 2
    )
    assert (p < 0.001).mean() <= 0.005
    assert (p < verification.ERROR_RATE / 628).mean() <= 0.001


@pytest.fixture
def made(tmp_path):
    """A folder with all tables as docs/outcome has them, and the file of song2016's."""
    outcome = pd.read_csv(verification.OUTCOME)
    for (study, table), rows in outcome.groupby(["study", "table"]):
        file = tmp_path / study / "paper" / f"{table}.comparison.csv"
        file.parent.mkdir(parents=True, exist_ok=True)
        more = rows[["route", "obstacles", "workspace", "profile"]].dropna(axis=1, how="all")
        others = ["study", "table", "primary", "counted", *more]
        pd.concat([more, rows.drop(columns=others)], axis=1).to_csv(file, index=False)
    return tmp_path / "song2016/paper/table1.comparison.csv"


TABLES = [(key, name) for key, own in studies().items() for name in own.with_published()]


def test_docs_outcome_agrees_with_itself_and_each_row_is_told_of(made):
    (first, last), sound = verification.against_outcome(made.parents[2], TABLES)
    compared, equal, worse, times, others, same = map(int, re.findall(r"\d+", first))
    assert (equal, worse, same) == (compared, 0, others)
    assert compared + times + others == len(pd.read_csv(verification.OUTCOME))
    assert last.startswith("sound: ")
    assert sound


SHORT = {
    "half of the rows": lambda kept: kept[::2],
    "a study": lambda kept: kept[kept["study"] != "meledje"],
    "all but three rows": lambda kept: kept[:3],
    "a metric of another name": lambda kept: kept.replace({"metric": {"objective": "length"}}),
    "a printed number": lambda kept: kept.assign(
        value_published=kept["value_published"] * ([1.1] + [1.0] * (len(kept) - 1))
    ),
    "no times": lambda kept: kept[kept["unit"] != "s"],
}


@pytest.mark.parametrize("case", SHORT)
def test_rows_without_a_partner_are_differences(made, tmp_path, monkeypatch, case):
    outcome = pd.read_csv(verification.OUTCOME)
    SHORT[case](outcome).to_csv(tmp_path / "kept.csv", index=False)
    monkeypatch.setattr(verification, "OUTCOME", tmp_path / "kept.csv")
    lines, sound = verification.against_outcome(made.parents[2], TABLES)
    assert not sound
    assert " 0 different" not in lines[0]


def test_a_wrong_planner_ends_the_command_with_status_1(made, capsys):
    """Every objective of one method is half as long again."""
    frame = pd.read_csv(made)
    wrong = (frame["method"] == "smooth") & (frame["metric"] == "objective")
    assert wrong.any()
    frame.loc[wrong, ["value_ours", "low95_ours", "high95_ours"]] *= 1.5
    frame.to_csv(made, index=False)
    with pytest.raises(SystemExit) as ended:
        __main__.main(["verify", str(made.parents[2]), "--outcome"])
    lines = capsys.readouterr().out.splitlines()
    assert ended.value.code == 1
    assert any("song2016/table1" in line and "smooth" in line for line in lines)
    assert lines[-1].startswith("not sound: ")


def test_a_missing_table_is_named(made):
    made.unlink()
    with pytest.raises(FileNotFoundError, match=r"table1\.comparison\.csv: not there; make verify"):
        verification.against_outcome(made.parents[2], TABLES)
