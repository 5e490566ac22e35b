"""Claims judged: every kind of test on a true and on a false case, the way from marks to a verdict,
and degenerate runs.
"""

import itertools
import json
import math
from pathlib import Path

import checks_of_claims
import numpy as np
import pandas as pd
import pytest
from scipy import stats

from bezierplan.analysis import legend, metrics, statistics
from bezierplan.analysis.claims import judge as judging
from bezierplan.analysis.claims import sentences, variants, verdicts
from bezierplan.analysis.claims.check import SIDES
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.effects import Finding
from bezierplan.analysis.claims.kinds import trend
from bezierplan.analysis.claims.material import Display, Material, StudyForClaims
from bezierplan.analysis.claims.published import PrintedTable, find_cell
from bezierplan.analysis.claims.ranks import compute_p_of_signed_ranks
from bezierplan.analysis.columns import COLUMNS_OF
from bezierplan.analysis.metrics import Metric
from bezierplan.analysis.results import Results
from bezierplan.schema import checked
from bezierplan.schema.checked import Fault
from bezierplan.schema.model import convert_to_list
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.seeds import generator

DATA = checked.read(Path(__file__).parent / "data" / "claims.yaml")
GRID = from_lines(["..", ".."], 1.0, "m")
PROBLEMS = {name: Problem(name, GRID, (0.5, 0.5), (1.5, 1.5)) for name in ("first", "second")}
UNITS = 40
END = 1.952
"""Of 1,000 evenly spaced draws of a normal distribution (`few_draws`), 95 % lie within."""

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture(autouse=True)
def few_draws(monkeypatch):
    monkeypatch.setattr(statistics, "DRAWS", 1000)


def sample(name: str, mean: float = 0.0, n: int = UNITS, std: float = 1.0) -> np.ndarray:
    """Normal values (n,) of exactly this mean and standard deviation, the same for a name."""
    values = generator(name).normal(size=n)
    return mean + std * (values - values.mean()) / values.std(ddof=1)


def table(values: dict[str, np.ndarray], metric: str = "objective", **columns) -> pd.DataFrame:
    """Runs of one condition: method -> one value of the metric a repeat, in an order of their
    own.
    """
    described = {
        "experiment": "tried",
        "problem": "first",
        "workspace": "grid",
        "drew": True,
        "feasible": True,
        "claimed_feasible": True,
    } | columns
    condition = ",".join(f"{key}={value}" for key, value in {**described, **columns}.items())
    rows = [
        described | {"condition": condition, "method": method, "repeat": repeat, metric: value}
        for method, numbers in values.items()
        for repeat, value in enumerate(numbers)
    ]
    return pd.DataFrame(rows)


def judge(claim: dict, *runs: pd.DataFrame, **material) -> tuple[pd.DataFrame, pd.DataFrame]:
    of_study = ("variant_of", "paired", "repeats", "labels")
    given = {name: {} for name in ("published", "artefacts", "functions", *of_study)}
    given |= {"repeats": {"tried": 10}} | material
    results = {}
    if runs:
        every = pd.concat(runs, ignore_index=True)
        results["tried"] = Results(every, PROBLEMS, pd.DataFrame())
    claims = [Claim.model_validate({"id": "C1", "place": "1", "statement": "It is so."} | claim)]
    artefacts = {
        name: [Display.model_validate(part) for part in parts]
        for name, parts in given["artefacts"].items()
    }
    study = StudyForClaims("study", claims, artefacts, *(given[key] for key in of_study))
    return judging.judge_claims(Material(study, results, given["published"], given["functions"]))


def compared(checks: pd.DataFrame) -> list[str]:
    """What rows of comparisons compare."""
    return [f"{row.group} {row.relation} {row.other}" for row in checks.itertuples()]


def judged(check: dict, *runs: pd.DataFrame, **material) -> pd.Series:
    """The row of the deciding variant of a claim of one check."""
    return judge({"checks": [check]}, *runs, **material)[0].iloc[0]


def comparisons_of(check: dict, *runs: pd.DataFrame, **material) -> pd.DataFrame:
    """The comparisons of a claim of one check."""
    return judge({"checks": [check]}, *runs, **material)[1]


def marks(check: dict, *runs: pd.DataFrame, **material) -> list[str]:
    return comparisons_of(check, *runs, **material)["mark"].to_list()


def verdict_on(check: dict, *runs: pd.DataFrame, **material) -> str:
    return judged(check, *runs, **material)["verdict"]


def say(row: pd.Series) -> tuple[str, str]:
    """The verdict of a claim, and the reason for it."""
    return row["verdict"], row["reason"]


@pytest.mark.parametrize("statistic", ["rank", "mean", "median"])
@pytest.mark.parametrize(("value", "mark"), [(5100, "+"), (5995, "0"), (7000, "-")])
def test_two_constants_that_differ_have_a_mark_and_no_p(statistic, value, mark):
    """As numbers of evaluations that settings fix: nothing varies by chance."""
    runs = table({"a": np.full(60, value), "b": np.full(60, 6000)})
    check = LOWER | {"statistic": statistic, "margin": 10}
    (row,) = comparisons_of(check, runs).to_dict("records")
    assert (row["mark"], row["mark_family"]) == (mark, mark)
    assert math.isnan(row["p"])
    assert math.isnan(row["p_family"])


@pytest.mark.parametrize(("findings", "mark", "number"), DATA["together"])
def test_comparisons_together_hold_if_all_do_and_fail_if_one_does(findings, mark, number):
    found, decisive = verdicts.combine_findings([Finding(**each) for each in findings])
    assert (verdicts.choose_mark(found, found.p), decisive) == (mark, number)


def test_a_superlative_is_one_comparison_at_a_place_and_its_pairs_are_details():
    """Of three rivals a beats two: no third of the sentence is true."""
    check = LOWER | {"than": ["b", "c", "d"], "together": True, "every": ["workspace"]}
    best = table({"a": sample("a"), "b": sample("b", 1), "c": sample("c", 2), "d": sample("d", 3)})
    third = table(
        {"a": sample("a", 1), "b": sample("b"), "c": sample("c", 2), "d": sample("d", 3)},
        workspace="other",
    )
    claims, checks = judge({"checks": [check]}, best, third)
    assert claims.iloc[0][["verdict", "holds"]].to_list() == ["partly", "1 of 2"]
    assert claims.iloc[0]["where_it_holds"].startswith("Holds: ")
    deciding = checks[checks["primary"]]
    assert deciding["together"].to_list() == [3, 3]
    assert deciding["mark"].to_list() == ["+", "-"]
    assert checks.loc[~checks["primary"], "mark"].to_list() == ["+", "+", "+", "-", "+", "+"]


NAMES = {
    "words of a sentence": ("lower", "higher", "low inertia", "high inertia"),
    "parts of relations": ("a lower than b", "than, as", "all 3 together", "in at_least 0.5"),
    "signs of keys": ("x=1, y=2", '{"a": "b"}', "c=3", "d, e"),
}


@pytest.mark.parametrize("names", NAMES.values(), ids=NAMES)
@pytest.mark.parametrize("together", [{}, {"together": True}])
def test_any_names_make_right_sentences(names, together, tmp_path):
    """From claim_checks.csv, which pandas reads."""
    group, other, *labels = names
    check = LOWER | {"groups": [group], "than": [other], "every": ["workspace"]} | together
    runs = table({group: sample("a"), other: sample("b", 1)}, workspace="a, b=c")
    comparisons_of(check, runs).to_csv(tmp_path / "claim_checks.csv", index=False)
    row = pd.read_csv(tmp_path / "claim_checks.csv").iloc[0]
    assert [row["group"], row["relation"], row["other"]] == [group, "lower than", other]
    assert json.loads(row["place"]) == {"workspace": "a, b=c"}
    row, check = row.astype(object).where(row.notna(), None), checks_of_claims.check_of(check)
    printed = dict(zip(names, labels))
    title = "all 1 together" if together else f"{labels[0]} lower than {labels[1]}"
    assert sentences.name_comparison(row, check, printed) == f"{title}, workspace a, b=c"


def over_x(slope: float, std: float = 1.0) -> pd.DataFrame:
    """Runs of one method at five values of `particles`; the mean grows with slope, the standard
    deviation is std times the number.
    """
    return pd.concat(
        table(
            {"plain": 100 + slope * x + sample(f"x{x}", std=std * x if std < 1 else std)},
            particles=x,
        )
        for x in (5, 10, 20, 30, 50)
    )


LOWER, PAIRS, TREND, SHARE, ALL, WITHIN, ORDERED = DATA["checks"].values()
TIERS = {"a": sample("a"), "b": sample("b", 1), "c": sample("c", 1.2), "d": sample("d", 2.5)}
APART, ALIKE = (
    table({"a": sample("a"), "b": sample("b", 1)}),
    table({"a": sample("a"), "b": sample("b", 0.1)}),
)
MOSTLY = table({"a": np.r_[np.full(35, -1.0), np.full(5, 1.0)]})
TRUTHS = table({"a": np.arange(UNITS) < 5, "b": np.arange(UNITS) < 25}, metric="claimed_feasible")

RUNS = {
    "apart": APART,
    "alike": ALIKE,
    "truths": TRUTHS,
    "tiers": table(TIERS),
    "rising": over_x(0.2),
    "falling": over_x(-0.2),
    "spreading": over_x(0.0, std=0.2),
    "mostly below": MOSTLY,
    "all below": table({"a": np.full(59, -1.0)}),
    "all above": table({"a": np.full(59, 1.0)}),
    "one of ten below": table({"a": np.r_[np.ones(9), -1]}),
}


def runs_of(described) -> pd.DataFrame:
    """Runs by their name, or of methods with means, or means and deviations."""
    if isinstance(described, str):
        return RUNS[described]
    both = {name: [*convert_to_list(each), 1.0][:2] for name, each in described.items()}
    return table({name: sample(name, mean, std=std) for name, (mean, std) in both.items()})


# Name -> a check with runs on which it holds; and on which its contrary does.
CASES = {
    name: tuple((DATA["checks"][check] | changed, runs_of(runs)) for changed, runs in ways)
    for name, (check, *given) in DATA["cases"].items()
    for ways in [(given[:2], given[2:])]
}


@pytest.mark.parametrize("name", CASES)
def test_a_case_is_supported_and_its_contrary_contradicted(name):
    for (check, runs), verdict in zip(CASES[name], ("supported", "contradicted")):
        row = judged(check, runs)
        holds, of = row["holds"].split(" of ")
        assert (row["verdict"], holds) == (verdict, of if verdict == "supported" else "0")


# Effects and their sizes.


@pytest.mark.parametrize("units", [6, 11, 17])
def test_signed_ranks_are_exact_with_ties_and_zeros(units):
    difference = np.round(2 * sample("ties", 0.4, units))
    difference[0] = 0.0
    ranks = stats.rankdata(np.abs(difference)) * (difference != 0)
    sums = np.array(list(itertools.product([0, 1], repeat=units))) @ ranks
    least = min(
        np.mean(sums <= ranks[difference > 0].sum()), np.mean(sums >= ranks[difference > 0].sum())
    )
    assert compute_p_of_signed_ranks(difference) == pytest.approx(min(1.0, 2 * least), rel=1e-12)


def test_pairs_need_both_runs():
    runs = table({"a": sample("a"), "b": sample("b", 1)}, metric="length")
    runs.loc[runs["repeat"] == runs["method"].map({"a": 3, "b": 4}), "feasible"] = False
    check = LOWER | {"metric": "length"}
    assert judged(check, runs)["n"] == UNITS - 1
    assert judged(check | {"paired": True}, runs)["n"] == UNITS - 2
    # What an experiment pairs is the default.
    assert judged(check, runs, paired={"tried": True})["n"] == UNITS - 2


@pytest.mark.parametrize("conditions", [1, 2])
@pytest.mark.parametrize("paired", [True, False])
def test_truths_in_closed_form(paired, conditions):
    """Of 40, 5 of the one and 25 of the other, which meet in 2: one success and one failure more in
    each (Agresti and Caffo 2000), or half a pair of each kind (Agresti and Min 2005).
    """
    unit = np.arange(UNITS)
    values = {"a": unit < 5, "b": (unit >= 3) & (unit < 28)}
    runs = pd.concat(
        table(values, "claimed_feasible", problem=name) for name in [*PROBLEMS][:conditions]
    )
    check = LOWER | {"metric": "claimed_feasible", "paired": paired, "pool": ["problem"]}
    row = comparisons_of(check, runs).iloc[0]
    if paired:
        p = stats.binomtest(3, 26).pvalue
        variance = (27 / 42 - (20 / 42) ** 2) / 42
    else:
        p = stats.fisher_exact([[5, 35], [25, 15]]).pvalue
        variance = (6 * 36 + 26 * 16) / 42**3
    assert row["effect"] == -0.5
    ends = -20 / 42 + END * math.sqrt(variance / conditions) * np.array([-1, 1])
    assert row[["low95", "high95"]].to_list() == pytest.approx(ends.tolist(), abs=1e-3)
    if conditions == 1:
        assert row["p"] == p


@pytest.mark.parametrize("paired", [True, False])
@pytest.mark.parametrize("scale", ["absolute", "relative"])
@pytest.mark.parametrize("statistic", ["rank", "mean"])
def test_a_claimed_least_effect_moves_the_other_group(statistic, scale, paired):
    a, b = np.round(sample("a", 10)), np.round(sample("b", 14, std=2))
    check = LOWER | {"statistic": statistic, "scale": scale, "paired": paired, "margin": 0.1}
    row = comparisons_of(check | {"least": 0.25}, table({"a": a, "b": b})).iloc[0]
    moved = b * 0.75 if scale == "relative" else b - 0.25
    tests = {
        ("rank", True): lambda: compute_p_of_signed_ranks(a - moved),
        ("rank", False): lambda: stats.mannwhitneyu(a, moved).pvalue,
        ("mean", True): lambda: stats.ttest_rel(a, moved).pvalue,
        ("mean", False): lambda: stats.ttest_ind(a, moved, equal_var=False).pvalue,
    }
    assert row["p"] == pytest.approx(tests[statistic, paired](), rel=1e-9)
    apart = a.mean() / b.mean() - 1 if scale == "relative" else a.mean() - b.mean()
    assert row["effect"] == pytest.approx(apart)
    assert (row["n"], row["unit"]) == (UNITS, "m")


def test_failures_are_worse_than_any_success_in_pairs_too():
    a, b = sample("a", n=20), sample("b", 1, n=20, std=9)
    runs = table({"a": a, "b": b}, metric="length")
    runs.loc[(runs["method"] == "a") & (runs["repeat"] < 4), "feasible"] = False
    row = comparisons_of(LOWER | {"metric": "length", "failures": "last", "paired": True}, runs)
    expected = compute_p_of_signed_ranks(np.where(np.arange(20) < 4, 1e6, a) - b)
    assert row.iloc[0]["p"] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("apart", "factor"), [(0.9, 1), (1.1, 2)])
def test_p_of_two_one_sided_tests(apart, factor, side):
    """That of the nearer margin; beside it, twice that of lying within."""
    runs = table({"a": sample("a", side * apart - 2, n=300), "b": sample("b", n=300)})
    row = comparisons_of(WITHIN | {"target": -2}, runs).iloc[0]
    tail = stats.norm.sf(0.1 / math.sqrt(2 / 300))
    assert row["p"] == pytest.approx(factor * tail, abs=0.002)


@pytest.mark.parametrize("direction", ["at_least", "at_most"])
@pytest.mark.parametrize("shares", DATA["shares"])
def test_a_share_over_conditions_by_student(shares, direction):
    """Six of ten runs each are enough."""
    runs = pd.concat(
        table({"a": np.where(np.arange(10) < k, -1.0, 1.0)}, layout=n) for n, k in enumerate(shares)
    )
    check = SHARE | {"pool": ["layout"], "direction": direction}
    (row,) = comparisons_of(check, runs).to_dict("records")
    shares = np.array(shares) / 10
    mean = shares.mean()
    test = stats.ttest_1samp(shares, 0.5) if np.ptp(shares) else None
    low, high = test.confidence_interval(0.95) if test else (mean, mean)
    assert (row["effect"], row["n"]) == (pytest.approx(mean), 6)
    assert (row["low95"], row["high95"]) == pytest.approx((low, min(high, 1)))
    assert row["p"] == pytest.approx(test.pvalue if test else float(mean == 0.5))
    sides = {"at_least": "+", "at_most": "-"}
    assert row["mark"] == (sides[direction] if mean > 0.5 else "?")


def test_share_and_its_exact_interval():
    row = judged(SHARE, MOSTLY)
    assert (row["effect"], row["n"]) == (35 / 40, 40)
    # Clopper and Pearson (1934).
    assert (row["low95"], row["high95"]) == pytest.approx((0.7320, 0.9581), abs=1e-4)
    alike = judged(SHARE, MOSTLY.assign(drew=False))
    assert (alike["n"], alike["verdict"]) == (1, "undecided"), "a deterministic method's one run"


@pytest.mark.parametrize(("threshold", "misses", "n", "expected"), DATA["examples"])
def test_59_runs_without_an_example_are_enough(threshold, misses, n, expected):
    """Or as many that all of the paper's thirty runs are likely, or not."""
    runs = table({"a": np.where(np.arange(n) < misses, 1.0, -1.0)})
    check = ALL | {"threshold": threshold}
    assert marks(check, runs, repeats={"tried": 30}) == [expected]


def test_a_chance_that_enough_runs_tell_is_not_undecided():
    """Ten times the paper's ten are enough."""
    check = LOWER | {"statistic": "min"}
    found = [
        judged(check, table({"a": sample("a", n=n), "b": sample("b", n=n)})) for n in (99, 100)
    ]
    assert [row["verdict"] for row in found] == ["undecided", "depends"]
    assert found[1]["reason"].startswith("holds in ")


def test_what_is_computed_of_runs_selects_them():
    """Where the straight line is blocked; elsewhere b would be the longer one."""
    runs = table({"a": sample("a"), "b": sample("b", 1)}, bound=2.0)
    free = table({"a": sample("a", 9), "b": sample("b")}, bound=math.sqrt(2))
    free["repeat"] += UNITS
    row = judged(LOWER | {"where": {"blocked": True}}, runs, free)
    assert (row["verdict"], row["n"]) == ("supported", UNITS)


@pytest.mark.parametrize("scale", ["absolute", "relative"])
@pytest.mark.parametrize(("n", "near"), [(40, 0.1), (300, 0.0012)])
def test_a_trend_of_units_with_slopes_of_their_own(n, near, scale):
    """Units with three values of five count, and none with two."""
    slopes = sample("slopes", 0.2, n=n, std=0.05)
    runs = pd.concat(
        table({"plain": (100 + slopes * x)[k // 2 :]}, particles=x).assign(
            repeat=lambda each, k=k: each["repeat"] + k // 2
        )
        for k, x in enumerate((5, 10, 20, 30, 50))
    )
    (row,) = comparisons_of(TREND | {"scale": scale, "margin": 1e-3}, runs).to_dict("records")
    used = slopes[1:]
    first = (100 + 5 * slopes).mean() if scale == "relative" else 1.0
    assert row["n"] == n - 1
    assert row["effect"] == pytest.approx(45 * used.mean() / first)
    ends = (np.array([row["low95"], row["high95"]]) - row["effect"]) * first / 45
    spread = used.std(ddof=1) / math.sqrt(n - 1)
    assert ends == pytest.approx([-END * spread, END * spread], rel=near)


@pytest.mark.parametrize(
    ("statistic", "factor", "n", "near"),
    [
        ("mean", 1, 100, 0.1),
        ("mean", 1, 300, 0.0012),
        ("std", 0.5, 100, 0.2),
        ("std", 0.5, 300, 0.05),
    ],
)
def test_both_ends_of_an_interval_of_an_effect(statistic, factor, n, near):
    """Of two means, or standard deviations, of n normal values with the standard deviations 1 and
    2: two standard errors away, resampled or not.
    """
    row = judged(
        LOWER | {"statistic": statistic},
        table({"a": sample("a", 0, n=n), "b": sample("b", 1, n=n, std=2)}),
    )
    ends = (row[["low95", "high95"]].to_numpy(dtype=float) + 1) / math.sqrt(factor * 5 / n)
    assert row["effect"] == pytest.approx(-1)
    assert ends == pytest.approx([-END, END], rel=near)


@pytest.mark.parametrize("paired", [True, False])
@pytest.mark.parametrize("n", [100, 300])
def test_both_ends_of_an_interval_of_a_ratio(n, paired):
    """Of the means 8 and 10: the variance of a / b - 1 by its derivatives 1 / b and -a / b**2."""
    a, b = sample("a", 8, n=n), sample("b", 10, n=n)
    check = LOWER | {"statistic": "mean", "scale": "relative", "paired": paired}
    row = judged(check, table({"a": a, "b": b}))
    parts = [a / 10, -0.08 * b]
    variance = (
        np.var(parts[0] + parts[1], ddof=1) if paired else np.var(parts, axis=1, ddof=1).sum()
    )
    ends = (row[["low95", "high95"]].to_numpy(dtype=float) + 0.2) / math.sqrt(variance / n)
    assert ends == pytest.approx([-END, END], rel=0.0012 if n == 300 else 0.1)


def test_rest_leaves_out_variants():
    runs = table({"a": sample("a", 0), "b": sample("b", 9), "ours": sample("ours", -9)})
    check = LOWER | {"groups": ["a"], "than": ["rest"]}
    assert verdict_on(check, runs, variant_of={"ours": "a"}) == "supported"
    assert verdict_on(check, runs) == "partly"


def test_extremes_need_the_size_of_the_papers_experiment():
    check, runs = CASES["lower, extremes"][0]
    row = judged(check, runs, repeats={})
    assert say(row) == ("undecided", "the paper's number of runs is unknown")
    assert verdict_on(WITHIN | {"statistic": "min", "margin": 9}, ALIKE) == "supported"


# From marks to a verdict.


def judge_both(alone: str, together: str) -> list[str]:
    """The verdict on marks where all have to hold, and where any may."""
    return [verdicts.judge_marks(alone, together, holds) for holds in ("all", "any")]


@pytest.mark.parametrize("found", DATA["verdicts"])
def test_verdict(found):
    for order in {found, found[::-1], found[1:] + found[:1]}:
        assert judge_both(order, order) == DATA["verdicts"][found]


@pytest.mark.parametrize(("alone", "together", "all_hold", "any_holds"), DATA["alone"])
def test_verdict_by_marks_alone_and_in_the_family(alone, together, all_hold, any_holds):
    assert judge_both(alone, together) == [all_hold, any_holds]


def test_family_against_a_worked_example():
    """The fifteen p of Benjamini and Hochberg (1995, Section 3.2): four are rejected at 0.05."""
    p = np.array(DATA["p"])
    assert (verdicts.compute_family_p(p) < 0.05).sum() == 4
    assert len(verdicts.compute_family_p(np.array([]))) == 0


@pytest.mark.parametrize(
    ("apart", "wrong"),
    [(0.0, {"supported", "contradicted", "partly"}), (1.0, {"contradicted", "no effect"})],
)
def test_at_most_one_sentence_in_twenty_is_judged_wrongly(apart, wrong):
    """Of sentences of twenty comparisons without an effect few get another verdict than undecided;
    true ones are never refused.
    """
    given = []
    for number in range(100):
        values = generator(f"sentence {number}").normal(apart, 1, (20, 20))
        found = [
            Finding(effect=mean, p=p, toward=int(np.sign(mean)), margin=0.3)
            for mean, p in zip(values.mean(axis=1), stats.ttest_1samp(values, 0, axis=1).pvalue)
        ]
        together = verdicts.compute_family_p(np.array([each.p for each in found]))
        alone, in_family = (
            [verdicts.choose_mark(each, p) for each, p in zip(found, chances)]
            for chances in ([each.p for each in found], together)
        )
        given.append(verdicts.judge_marks(alone, in_family, "all"))
    assert sum(verdict in wrong for verdict in given) <= 10


@pytest.mark.parametrize(("toward", "p", "negligible", "expected"), DATA["marks"])
def test_mark(toward, p, negligible, expected):
    assert verdicts.choose_mark(Finding(p=p, toward=toward, negligible=negligible), p) == expected
    assert verdicts.choose_mark(Finding(p=p, toward=toward, mark="-"), p) == "-"


def places(first: float, second: float) -> pd.DataFrame:
    """Two groups on two problems, where they differ by the given amounts."""
    return pd.concat(
        table({"a": sample("a"), "b": sample("b", apart)}, problem=problem)
        for problem, apart in (("first", first), ("second", second))
    )


def test_every_makes_one_comparison_a_combination_and_pool_averages():
    every, pool = LOWER | {"every": ["problem"]}, LOWER | {"pool": ["problem"]}
    assert marks(every, places(2, -1)) == ["+", "-"]
    assert verdict_on(every, places(2, -1)) == "partly"
    pooled = judged(pool, places(2, -1))
    assert (pooled["verdict"], pooled["holds"], pooled["n"]) == ("supported", "1 of 1", 2 * UNITS)
    assert pooled["effect"] == pytest.approx(-0.5)
    assert verdict_on(pool | {"margin": 0.6}, places(1, -1)) == "no effect"
    assert verdict_on(WITHIN | {"pool": ["problem"]}, places(1.2, -1.2)) == "supported"
    assert verdict_on(WITHIN | {"every": ["problem"]}, places(4, -4)) == "contradicted"


def test_conditions_of_equal_weight_whatever_their_numbers_of_runs():
    few = pd.concat(
        [
            table({"a": np.zeros(10), "b": np.full(10, 2.0)}),
            table({"a": np.zeros(40), "b": np.full(40, -1.0)}, problem="second"),
        ]
    )
    row = judged(LOWER | {"pool": ["problem"]}, few)
    assert (row["n"], row["effect"]) == (50, pytest.approx(-0.5))


def test_runs_of_several_conditions_are_never_mixed():
    with pytest.raises(
        Fault,
        match="claim C1: lower of objective: "
        "several values of condition are neither told apart nor pooled",
    ):
        judged(LOWER, places(1, 1))
    with pytest.raises(Fault, match="several values of method"):
        judged(SHARE | {"where": {"problem": "first"}}, APART)


def test_the_family_is_that_of_the_deciding_checks():
    reported = LOWER | {"groups": ["b"], "than": ["a"], "secondary": True}
    summary, details = judge({"checks": [LOWER, reported]}, APART)
    assert (summary.iloc[0]["verdict"], summary.iloc[0]["holds"]) == ("supported", "1 of 1")
    assert details["mark"].to_list() == ["+", "-"]
    assert details["primary"].to_list() == [True, False]
    assert details["mark_family"].to_list() == ["+", ""]
    assert details["p_family"].isna().to_list() == [False, True]


def test_the_worst_comparison_is_shown():
    for differences, worst in (((-1, -2), 2), ((2, 1), -1)):
        row = judged(LOWER | {"every": ["problem"]}, places(*differences))
        assert row["effect"] == pytest.approx(worst)
    # Five and six beside the target.
    row = judged(WITHIN | {"every": ["problem"], "target": -3}, places(8, -3))
    assert row["effect"] == pytest.approx(3)


@pytest.mark.parametrize(("runs", "holds", "decisive"), DATA["decisive"])
def test_what_holds_without_a_p_is_surer_and_what_is_open_less_sure(runs, holds, decisive):
    claim = {"checks": [LOWER, LOWER | {"statistic": "min"}], "holds": holds}
    assert judge(claim, runs_of(runs))[1]["decisive"].to_list() == decisive


def test_a_side_is_a_sign():
    assert {*map(abs, SIDES.values())} == {1}


@pytest.mark.parametrize(("name", "changed"), DATA["refused"])
def test_keys_that_do_not_belong_together_are_refused(name, changed):
    with pytest.raises(ValueError, match="validation error"):
        checks_of_claims.check_of(DATA["checks"][name] | changed)


# Selections.


def test_factors_across_and_where():
    runs = pd.concat([over_x(0.2), over_x(-0.2).assign(method="other")])
    check = LOWER | {
        "across": "particles",
        "groups": [5],
        "than": [30, 50],
        "where": {"method": "plain"},
    }
    assert judged(check, runs)["holds"] == "2 of 2"
    assert judged(check | {"where": {"method": ["other"]}}, runs)["holds"] == "0 of 2"
    every = comparisons_of(TREND | {"every": ["method"]}, runs)
    assert dict(zip(every["place"], every["mark"])) == {
        '{"method": "plain"}': "+",
        '{"method": "other"}': "-",
    }


def test_rest_is_what_the_artefact_shows_and_the_check_does_not_name():
    artefacts = {
        "table1": [{"experiment": "tried", "where": {"method": ["a", "b", "d"]}}],
        "figure1": [{"experiment": "tried", "where": {"method": method}} for method in "dba"],
    }
    check, runs = LOWER | {"than": ["rest"]}, table(TIERS)
    for name in artefacts:
        found = judge({"checks": [check], "artefact": name}, runs, artefacts=artefacts)[1]
        assert sorted(compared(found)) == ["a lower than b", "a lower than d"]
    everything = compared(comparisons_of(check, runs))
    assert everything == ["a lower than b", "a lower than c", "a lower than d"]
    ordered = ORDERED | {"order": [["a"], ["rest"], ["d"]]}
    summary, _ = judge({"checks": [ordered], "artefact": "table1"}, runs, artefacts=artefacts)
    assert summary.iloc[0]["holds"] == "2 of 2"


def test_variants_take_the_place_of_what_the_checks_name():
    runs = pd.concat(
        [table(TIERS), table({"a": sample("a", 9), "b": sample("b")}, workspace="other")]
    )
    claim = {"checks": [LOWER], "variants": {"method": ["a", "d"], "workspace": ["grid", "other"]}}
    summary, details = judge(claim, runs)
    assert summary["variant"].to_list() == [
        f"method={m}, workspace={w}" for m in "ad" for w in ("grid", "other")
    ]
    assert summary["primary"].to_list() == [True, False, False, False]
    expected = ["supported", "contradicted", "contradicted", "undecided"]
    assert summary["verdict"].to_list() == expected
    assert set(compared(details)) == {"a lower than b", "d lower than b"}
    metric = {"checks": [LOWER], "variants": {"metric": ["objective", "evaluations"]}}
    runs = runs[runs["workspace"] == "grid"].assign(evaluations=lambda each: -each["objective"])
    assert judge(metric, runs)[0]["verdict"].to_list() == ["supported", "contradicted"]
    check, wanted = checks_of_claims.check_of(LOWER), {"blocked": None}
    assert variants.apply_variant([check], wanted, wanted) == [check]
    (changed,) = variants.apply_variant([check], wanted, {"blocked": True})
    assert changed.where == check.where | {"blocked": True}


def test_variant_that_is_a_list_is_exchanged_member_by_member():
    written = LOWER | {"than": ["b", "c"], "where": {"method": ["a", "b", "c"]}}
    check, first = checks_of_claims.check_of(written), {"method": ["b", "c"]}
    (changed,) = variants.apply_variant([check], first, {"method": ["e", "f"]})
    assert (changed.than, changed.where) == (["e", "f"], {"method": ["a", "e", "f"]})
    assert variants.apply_variant([check], first, first) == [check]


def test_rest_is_the_same_in_every_variant():
    claim = {"checks": [LOWER | {"than": ["rest"]}], "variants": {"method": ["a", "d"]}}
    artefacts = {"table1": [{"experiment": "tried", "where": {"method": ["a", "b"]}}]}
    found = judge(claim | {"artefact": "table1"}, table(TIERS), artefacts=artefacts)[1]
    assert compared(found) == ["a lower than b", "d lower than b"]


def test_failures():
    lengths = table({"a": sample("a"), "b": sample("b", 1)}, metric="length")
    lengths.loc[(lengths["method"] == "a") & (lengths["repeat"] < 30), "feasible"] = False
    check = LOWER | {"metric": "length"}
    dropped = judged(check, lengths)
    reason = "compared on successes alone, which are of different number"
    assert (*say(dropped), dropped["n"]) == ("supported", reason, 10)
    last = judged(check | {"failures": "last"}, lengths)
    assert (last["verdict"], last["n"]) == ("contradicted", UNITS)
    share = SHARE | {"metric": "length"}
    assert judged(share, lengths)["n"] == 10
    for event in ({"below": 99}, {"at_most": 99}, {"above": -99}, {"at_least": -99}):
        row = judged(share | {"failures": "count", "event": event}, lengths)
        assert (row["n"], row["effect"]) == (UNITS, 0.25)


def test_no_success_against_some():
    lengths = table({"a": sample("a"), "b": sample("b", 1)}, metric="length")
    lengths["feasible"] = lengths["method"] == "b"
    check = LOWER | {"metric": "length"}
    assert verdict_on(check | {"failures": "last"}, lengths) == "contradicted"
    assert judged(check, lengths)["reason"].startswith("no run of a counts")
    nowhere = judged(check | {"failures": "last"}, lengths.assign(feasible=False))
    assert say(nowhere) == ("undecided", "no run succeeded")


def test_pick_takes_one_run_of_each_condition():
    runs = pd.concat(
        [table({"a": [3.0, -1.0, 2.0]}), table({"a": [3.0, 1.0, 2.0]}, problem="second")]
    )
    check = ALL | {"pick": {"lowest": "objective"}, "every": ["problem"]}
    details = comparisons_of(check, runs)
    assert details[["mark", "n"]].to_numpy().tolist() == [["+", 1], ["-", 1]]
    assert details["p"].isna().all()
    runs["feasible"] = runs["problem"] == "first"
    assert marks(check, runs) == ["+", "?"]


def test_rows_of_one_unit_are_averaged_first():
    layouts = pd.concat(
        table({"a": sample(f"a{k}", k), "b": sample(f"b{k}", k + 0.5)}).assign(layout=k)
        for k in range(8)
    )
    layouts["condition"] = layouts["layout"].astype(str)
    row = judged(LOWER | {"replicate": "layout"}, layouts)
    assert (row["n"], row["verdict"]) == (8, "supported")
    assert (
        judged(SHARE | {"replicate": "layout", "event": {"below": 3.5}}, layouts)["effect"] == 0.5
    )


def test_where_on_an_outcome_keeps_places_without_such_runs():
    runs = places(1, 1).reset_index(drop=True)
    runs["feasible"] = runs["problem"] == "first"
    found = judge({"checks": [LOWER | {"every": ["problem"], "where": {"feasible": True}}]}, runs)
    assert found[1]["mark"].to_list() == ["+", "?"]
    assert found[0].iloc[0]["verdict"] == "undecided"


def test_rank_is_one_among_the_rows_of_the_artefact(monkeypatch):
    among = Metric(
        "-",
        "rank",
        compute=lambda runs, problems: runs.groupby("repeat")["objective"].rank(),
        among_rows=True,
    )
    monkeypatch.setitem(metrics.METRICS, "rank", among)
    artefacts = {"table1": [{"experiment": "tried", "where": {"method": ["a", "b", "d"]}}]}
    claim = {
        "checks": [LOWER | {"metric": "rank", "than": ["d"], "margin": 0.5}],
        "artefact": "table1",
    }
    row = judge(
        claim,
        table({"a": np.zeros(9), "b": np.ones(9), "c": np.full(9, 2.0), "d": np.full(9, 3.0)}),
        artefacts=artefacts,
    )[0].iloc[0]
    assert (row["verdict"], row["effect"]) == ("supported", -2)


# The printed numbers.

PRINTED = pd.DataFrame(
    {
        "method": ["a", "b", "c"],
        "metric": "objective",
        "statistic": "mean",
        "n": [10.0, 10.0, math.nan],
        "unit": "m",
        "value": [5.0, 6.0, 4.0],
    }
)
TABLE = {"table1": [{"experiment": "tried", "published": "table1.csv"}]}


def with_printed(
    check: dict, printed: pd.DataFrame = PRINTED, runs=None, **material
) -> tuple[pd.Series, pd.DataFrame]:
    claim = {"checks": [check], "artefact": "table1"}
    runs = table(TIERS) if runs is None else runs
    summary, details = judge(
        claim, runs, published={"table1": printed}, artefacts=TABLE, **material
    )
    return summary.iloc[0], details


def test_a_cell_is_looked_up_in_tables_of_its_experiment_and_keys():
    other, finer, own = (
        PrintedTable(experiment, keys, {("a", 1)[: len(keys)]: {"mean": (value, 9.0)}})
        for experiment, keys, value in (
            ("other", ["method"], 1.0),
            ("tried", ["method", "speed"], 2.0),
            ("tried", ["method"], 3.0),
        )
    )
    cell = [{"experiment": "tried", "method": "a"}]
    assert find_cell(cell, [other, finer, own], {}) == {"mean": (3.0, 9.0)}
    assert find_cell(cell, [other, finer], {}) is None


def test_the_same_check_on_the_printed_numbers():
    row, details = with_printed(LOWER | {"than": ["b", "c", "d"]})
    assert row["published"] == "1 of 2"
    assert details["published"].to_list() == ["holds", "fails", "not printed"]
    assert details["effect_published"].to_list()[:2] == [-1, 1]
    assert with_printed(LOWER | {"statistic": "median"})[0]["published"] == "not printed"
    assert with_printed(LOWER, PRINTED.assign(statistic="unstated"))[0]["published"] == "1 of 1"
    assert with_printed(WITHIN)[0]["published"] == "1 of 1"
    assert with_printed(WITHIN | {"margin": 0.5})[0]["published"] == "0 of 1"
    assert with_printed(SHARE | {"event": {"below": 5.5}})[0]["published"] == "1 of 1"


@pytest.mark.parametrize(("value", "published"), [(7.0, "1 of 1"), (4.0, "0 of 1")])
def test_a_superlative_holds_in_the_printed_numbers_if_all_of_it_does(value, published):
    check = LOWER | {"than": ["b", "c"], "together": True}
    printed = PRINTED.assign(value=[5.0, 6.0, value])
    assert with_printed(check, printed)[0]["published"] == published


def test_a_median_of_seconds_is_set_beside_the_printed_mean():
    check = LOWER | {"metric": "cpu_s", "scale": "relative", "statistic": "median", "margin": 0.25}
    runs = table({"a": sample("a", 10), "b": sample("b", 20)}, metric="cpu_s")
    row, _ = with_printed(check, PRINTED.assign(metric="cpu_s"), runs)
    assert row[["verdict", "published"]].to_list() == ["supported", "1 of 1"]


@pytest.mark.parametrize(
    ("values", "published"), [([1, 3, 2, 4, 9], "1 of 1"), ([9, 7, 8, 2, 1], "0 of 1")]
)
def test_trend_over_printed_numbers(values, published):
    same = {"metric": "objective", "statistic": "mean", "n": 10, "unit": "m"}
    printed = pd.DataFrame({"particles": [5, 10, 20, 30, 50], **same, "value": values})
    row, _ = with_printed(TREND, printed, over_x(0.2))
    assert row["published"] == published


def test_a_variant_stands_beside_the_numbers_of_its_method():
    row, _ = with_printed(LOWER | {"groups": ["d"], "direction": "higher"}, variant_of={"d": "a"})
    assert row["published"] == "0 of 1"


def test_printed_counts_are_shares():
    counts = PRINTED.assign(metric="claimed_feasible", statistic="count", value=[2.0, 8.0, 1.0])
    _, details = with_printed(LOWER | {"metric": "claimed_feasible"}, counts, TRUTHS)
    assert details["effect_published"].to_list() == [pytest.approx(-0.6)]


def test_slopes_that_should_be_equal_are_equal_on_every_processor():
    """Their test ranks them: rounding would tell constants apart, and rises from falls by the same
    amount.
    """
    x = np.array([5.0, 10.0, 15.0, 20.0, 25.0])
    constant = np.repeat(np.arange(280, 320)[:, None] * 0.5, 5, axis=1)
    assert not trend._compute_slopes(x, constant).any()
    changes = 0.5 * np.array([[0, 0, 1, 2, 2], [2, 2, 1, 0, 0], [0, 0, 0, 0, 0], [1, 0, 0, 0, 1]])
    slopes = np.abs(trend._compute_slopes(x, (constant[:, None] + changes).reshape(-1, 5)))
    assert sorted(set(slopes.tolist())) == [0.0, pytest.approx(0.06)]


def test_conditions_that_the_paper_does_not_tell_apart_are_not_printed():
    runs = pd.concat([table(TIERS), table({"a": sample("other")}, workspace="other")])
    check = LOWER | {"across": "workspace", "groups": ["grid"], "than": ["other"]}
    row, _ = with_printed(check | {"where": {"method": "a"}}, runs=runs)
    assert row["published"] == "not printed"


def test_margin_is_a_share_or_the_printed_difference_where_that_is_smaller():
    _, details = with_printed(LOWER | {"than": ["b", "c", "d"], "margin": {"published": 0.01}})
    assert details["margin"].to_list() == pytest.approx([0.01, 0.01 * 1.2, 0.01 * 2.5])
    _, details = with_printed(
        LOWER | {"than": ["b", "c"], "margin": {"published": 0.5}, "scale": "relative"}
    )
    # The printed difference of a and c points the other way.
    assert details["margin"].to_list() == pytest.approx([1 / 6, 0.5])
    # One that is zero points nowhere.
    _, details = with_printed(LOWER | {"margin": {"published": 0.01}}, PRINTED.assign(value=5.0))
    assert details["margin"].to_list() == pytest.approx([0.01])
    share = LOWER | {"metric": "claimed_feasible", "margin": {"published": 0.01}}
    assert comparisons_of(share, TRUTHS)["margin"].to_list() == [0.01]


def test_function_of_the_study():
    check = {
        "test": "function",
        "name": "counted",
        "statistic": "runs",
        "effect_unit": "-",
        "experiment": "tried",
        "where": {"method": "a"},
    }

    def counted(check, results, published):
        n = int((results["tried"].runs["method"] == check.where["method"]).sum())
        return "+", float(n), None, n

    functions = {"counted": counted}
    row = judged(check, APART, functions=functions)
    assert row[["verdict", "effect", "n"]].to_list() == ["supported", UNITS, UNITS]
    assert comparisons_of(check, APART, functions=functions)["statistic"].to_list() == ["runs"]
    with pytest.raises(Fault, match="claim C1: function counted: unknown; did you mean count"):
        judged(check, APART, functions={"count": counted})
    assert verdict_on(check, functions=functions) == "untestable"


# Times.


def test_times_are_compared_by_ratio_only(monkeypatch):
    monkeypatch.setitem(metrics.METRICS, "cpu_s", Metric("s", "CPU time of the run"))
    runs = table({"a": sample("a", 20), "b": sample("b", 40)}, metric="cpu_s")
    check = LOWER | {"metric": "cpu_s"}
    row = judged(check | {"scale": "relative", "margin": 0.1}, runs)
    assert (row["verdict"], bool(row["timed"])) == ("supported", True)
    assert verdict_on(check, runs) == "untestable"
    assert not judged(LOWER, APART)["timed"]


# Degenerate runs.


@pytest.mark.parametrize(
    "check",
    [
        LOWER,
        LOWER | {"paired": True},
        LOWER | {"statistic": "median"},
        LOWER | {"scale": "relative"},
    ],
)
def test_no_difference_in_any_unit(check):
    """Units that do not differ at all say nothing of those that may, unless there are enough of
    them.
    """
    for n, verdict in ((9, "undecided"), (58, "undecided"), (59, "no effect")):
        row = judged(check, table({"a": np.full(n, 3.0), "b": np.full(n, 3.0)}))
        found = row[["verdict", "p", "effect", "low95", "high95"]]
        assert found.to_list() == [verdict, 1, 0, 0, 0]


@pytest.mark.parametrize("paired", [True, False])
def test_what_never_happened_may_happen(paired):
    """No success of 100 against none of 100: by rule of three either may have up to 3 %."""
    check = LOWER | {"metric": "claimed_feasible", "paired": paired}
    never = table(dict.fromkeys("ab", np.zeros(100, dtype=bool)), metric="claimed_feasible")
    for margin, verdict in ((0.01, "undecided"), (0.04, "no effect")):
        assert verdict_on(check | {"margin": margin}, never) == verdict


ANY_KIND = {
    "lower": LOWER,
    "paired": LOWER | {"paired": True},
    "median": LOWER | {"statistic": "median", "scale": "relative"},
    "min": LOWER | {"statistic": "min"},
    "published margin": LOWER | {"margin": {"published": 0.01}},
    "ordered": ORDERED,
    "trend": TREND | {"x": "problem_size", "where": {"method": "a"}},
    "share": SHARE,
    "all": ALL,
    "equal_within": WITHIN,
}


@pytest.mark.parametrize("value", [math.nan, math.inf, 0.0])
@pytest.mark.parametrize("n", [1, 5, 20])
def test_degenerate_values_give_no_fault(n, value):
    runs = pd.concat(
        table({name: np.full(n, value) for name in "abcd"}).assign(
            problem_size=size, condition=str(size)
        )
        for size in (1, 2, 3, 4)
    )
    for kind, check in ANY_KIND.items():
        where = check.get("where", {}) | ({} if kind == "trend" else {"problem_size": 1})
        row = judged(check | {"where": where}, runs)
        assert row["verdict"] in ("no effect", "undecided", "contradicted", "supported")
        # One counterexample decides `all`.
        if math.isnan(value) or (n < 6 and kind != "all"):
            assert (row["verdict"], bool(row["reason"])) == ("undecided", True)


@pytest.mark.parametrize("kind", ["lower", "median", "ordered", "equal_within"])
def test_missing_group_is_undecided(kind):
    row = judged(ANY_KIND[kind], table({"a": sample("a")}))
    assert say(row) == ("undecided", "no run of b counts")


def test_without_runs_a_claim_is_untestable():
    for check in ANY_KIND.values():
        row = judged(check)
        assert say(row) == ("untestable", "the experiment tried was not run")
        assert pd.isna(row["n"])


@pytest.mark.parametrize(
    ("check", "reason"),
    [
        (
            SHARE | {"where": {"method": "z"}},
            "no run is of the conditions that the claim names",
        ),
        (LOWER | {"metric": "evaluations"}, "the runs of tried have no evaluations"),
    ],
)
def test_without_such_runs_a_claim_is_untestable(check, reason):
    assert say(judged(check, APART)) == ("untestable", reason)


def test_reported_check_that_cannot_be_judged_decides_nothing():
    reported = LOWER | {"experiment": "other", "secondary": True}
    summary, details = judge({"checks": [LOWER, reported]}, APART)
    assert summary.iloc[0]["verdict"] == "supported"
    assert details["reason"].to_list() == ["", "the experiment other was not run"]


def test_relative_to_zero():
    row = judged(
        LOWER | {"scale": "relative", "statistic": "mean"},
        table({"a": np.ones(9), "b": np.zeros(9)}),
    )
    assert say(row) == ("undecided", "relative to a value that is zero or does not exist")
    nothing = table({"a": np.zeros(9), "b": np.zeros(9)})
    assert verdict_on(WITHIN | {"scale": "relative"}, nothing) == "undecided"


# What must not matter, and what must.


@pytest.mark.parametrize("name", CASES)
def test_order_of_the_runs_never_changes_a_byte(name):
    check, runs = CASES[name][0]
    mixed = runs.sample(frac=1, random_state=1)
    both = (judge({"checks": [check]}, each) for each in (runs, mixed))
    for own, other in zip(*both):
        assert own.to_csv() == other.to_csv()


REVERSED = {
    "supported": "contradicted",
    "contradicted": "supported",
    "no effect": "no effect",
    "undecided": "undecided",
}


@pytest.mark.parametrize("apart", [-1.0, -0.3, 0.0, 0.3, 1.0])
@pytest.mark.parametrize(
    "options",
    [{}, {"paired": True}, {"statistic": "mean"}, {"statistic": "iqr"}, {"statistic": "min"}],
)
def test_exchanging_the_direction_reverses_the_verdict(options, apart):
    runs = table({"a": sample("a"), "b": sample("b", apart, std=1 + abs(apart))})
    check = LOWER | options
    assert verdict_on(check | {"direction": "higher"}, runs) == REVERSED[verdict_on(check, runs)]


def test_the_decisive_comparison_is_marked_even_among_equal_ones():
    """Of two equal checks the row of the claim repeats the first, and only that one is decisive."""
    summary, details = judge({"checks": [LOWER, LOWER | {"secondary": True}, LOWER]}, APART)
    assert details["decisive"].to_list() == [True, False, False]
    assert details["effect"].nunique() == 1
    assert summary.iloc[0]["effect"] == details.iloc[0]["effect"]
    untestable = {"test": "untestable", "reason": "nobody knows"}
    assert not judge({"checks": [LOWER, untestable]}, APART)[1]["decisive"].any()


def test_columns():
    summary, details = judge({"checks": [LOWER]}, APART)
    assert summary.columns.to_list() == COLUMNS_OF["claims"]
    assert details.columns.to_list() == COLUMNS_OF["claim_checks"]
    assert details[["experiments", "statistic"]].to_numpy().tolist() == [["tried", "rank"]]
    assert set(summary["verdict"]) <= set(legend.select_words("claim"))


# How often a verdict is right.


def normal_runs(trial: int, shift: float) -> pd.DataFrame:
    """Runs of two methods, drawn at random: b's mean is by `shift` above a's, both have standard
    deviation 1.
    """
    a, b = generator(f"trial {trial}").normal(size=(2, 400))
    return table({"a": a, "b": shift + b})


@pytest.mark.parametrize(
    ("shift", "truth"), [(0.6, "supported"), (-0.6, "contradicted"), (0.0, "no effect")]
)
def test_verdict_from_many_runs_is_right_95_times_in_100(shift, truth):
    found = [verdict_on(LOWER, normal_runs(trial, shift)) for trial in range(100)]
    assert found.count(truth) >= 95
