"""The statistical tests of claims, on numbers alone.

A test takes a check (a mapping, see config/README.md) and a comparison (`claim_effects`), and gives a finding. All p are two-sided and all
intervals 95 %, by bootstrap over units within each condition; above `statistics.MOST_RESAMPLED` units by its normal approximation.

| test | effect | statistic and test | effect size |
| --- | --- | --- | --- |
| lower, ordered | group - other | `rank`: Wilcoxon's signed ranks, Pratt's zeros (paired), Mann-Whitney | A12 in the claimed direction |
| | | of truths: McNemar's exact test (paired), Fisher's exact test | odds ratio |
| | | `mean`: Student's t of the differences (paired), Welch's t | A12 |
| | | another statistic, or several conditions: bootstrap | A12, of spreads the difference |
| trend | change from lowest to highest x | least-squares slope of each unit, Wilcoxon against 0; `std`: bootstrap | slope |
| share | share | exact binomial, interval of Clopper and Pearson; all, none, some: one (counter)example decides | share |
| | | of six pooled conditions or more: Student's t over their shares | |
| equal_within | group - other | two one-sided tests: 90 % interval of the difference within the margin | difference |
| difference | range of the means | two groups as `lower`; more: Friedman (paired), Kruskal-Wallis | Kendall's W, epsilon squared |

The effect of lower, ordered and equal_within is one of means, or of the statistic that the check names.
min, max and range depend on the number of runs: they are judged by how often the sentence holds in draws of the paper's number of runs.
"""

import math
from collections.abc import Callable

import numpy as np

from bezierplan.analysis import statistics
from bezierplan.analysis.claim_effects import (
    LEAST_WITHOUT_EXAMPLE,
    SIDES,
    Comparison,
    Finding,
    change_weights,
    claimed,
    counted,
    drawn_effects,
    drawn_points,
    effect,
    finite,
    interval,
    is_negligible,
    least_detectable,
    margin_of,
    no_difference,
    point_statistic,
    points,
    too_few,
    two_sided,
    units,
)
from bezierplan.analysis.statistics import LEAST_RUNS, MOST_RESAMPLED, WITHOUT_INTERVAL, generator

ALPHA = 0.05
# Of more differences the signed ranks are judged by their normal approximation.
MOST_EXACT = 50
# Share of draws in which a sentence about extremes has to hold.
SURE = 0.95

# The tests. Each takes a check, a comparison and a name from which its draws follow.


def lower(check: dict, comparison: Comparison, name: str) -> Finding:
    """Is the first cell lower (higher) than the second one?"""
    ours = float(effect(check, points(comparison, point_statistic(check)), comparison.cells))
    n, reason = units(comparison), too_few(comparison)
    if reason:
        return Finding(effect=ours, n=n, mark="?", reason=reason)
    if point_statistic(check) in WITHOUT_INTERVAL:
        return _by_draws(check, comparison, name)
    side, least = SIDES[check["direction"]], check.get("least", 0)
    margin = margin_of(check, comparison)
    draws = drawn_effects(check, comparison, name)
    low, high = interval(draws)
    toward = np.sign(side * ours - least)
    if "least" not in check and abs(ours) < margin:
        toward = 0
    (stratum, *others) = comparison.strata.values()
    group, other = counted(stratum, comparison.paired)
    named = check.get("statistic", "rank")
    if others or named not in ("rank", "mean") or (comparison.boolean and "least" in check):
        p = two_sided(side * draws - least)
    elif comparison.boolean:
        p = _boolean_test(group, other, comparison.paired)
    elif named == "mean":
        p = _t_test(*_shifted(check, *finite(stratum, comparison.paired)), comparison.paired)
    else:
        p, ranked = _rank_test(*_shifted(check, group, other), comparison.paired)
        # The means have to differ in the direction of the ranks, unless some values have no mean.
        toward = side * ranked if np.isinf(stratum).any() or toward == side * ranked else 0
    infinite = any(np.isinf(each).any() for each in comparison.strata.values())
    if not (math.isfinite(ours) or infinite):
        p = math.nan
    size_name, size = _effect_size(check, comparison, side, ours)
    found = Finding(ours, size_name, size, low, high, n, p, int(np.nan_to_num(toward)), margin)
    reason = _why_none(p) or ("" if toward else no_difference(low, high, n))
    negligible = not infinite and is_negligible(low, high, margin, n, side * least)
    return found._replace(negligible=negligible, least_detectable=least_detectable(low, high, n), reason=reason)


def _t_test(group: np.ndarray, other: np.ndarray, paired: bool) -> float:
    """p of two means; of the ranks where values that do not spread leave no t."""
    from scipy import stats

    spread = (group - other).std() if paired else group.std() + other.std()
    if spread <= 1e-12 * max(np.abs(group).max(), np.abs(other).max(), 1e-300):
        return _rank_test(group, other, paired)[0]
    test = stats.ttest_rel(group, other) if paired else stats.ttest_ind(group, other, equal_var=False)
    return float(test.pvalue)


def _why_none(number: float) -> str:
    """Why there is no such p or effect, empty if there is one."""
    return "" if math.isfinite(number) else "relative to a value that is zero or does not exist"


def _shifted(check: dict, group: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values of both groups, the other's moved by the claimed least effect; infinite ones replaced by one beyond any difference."""
    finite = np.concatenate([values[np.isfinite(values)] for values in (group, other)])
    worst = finite.max() + 2 * np.ptp(finite) + 1
    group, other = (np.where(np.isinf(values), worst, values) for values in (group, other))
    move = SIDES[check["direction"]] * check.get("least", 0)
    return group, other * (1 + move) if check.get("scale") == "relative" else other + move


def _rank_test(group: np.ndarray, other: np.ndarray, paired: bool) -> tuple[float, int]:
    """p of two groups' ranks, and the side (1: higher) on which the first group's lie."""
    from scipy import stats

    if paired:
        difference = group - other
        if not difference.any():
            return 1.0, 0
        ranks = np.sign(difference) * stats.rankdata(np.abs(difference))
        return signed_rank_test(difference), int(np.sign(ranks.sum()))
    if np.ptp(np.concatenate([group, other])) == 0:
        return 1.0, 0
    return float(stats.mannwhitneyu(group, other).pvalue), int(np.sign(_wins(group, other) - 0.5))


def signed_rank_test(difference: np.ndarray) -> float:
    """p of Wilcoxon's signed ranks with Pratt's zeros, against a median of zero; exact, ties or not, of up to `MOST_EXACT` differences.

    scipy's test is as exact with ties up to 13 differences only, and takes a second for it.
    """
    from scipy import stats

    if len(difference) > MOST_EXACT:
        return float(stats.wilcoxon(difference, zero_method="pratt", method="asymptotic").pvalue)
    # Twice a rank is a whole number, tied or not.
    ranks = np.rint(2 * stats.rankdata(np.abs(difference))).astype(int)
    # How many of the equally likely assignments of signs give each sum of the positive ranks.
    signs = np.ones(1)
    for rank in ranks[difference != 0]:
        signs = np.pad(signs, (0, rank)) + np.pad(signs, (rank, 0))
    positive = ranks[difference > 0].sum()
    return min(1.0, 2 * float(min(signs[: positive + 1].sum(), signs[positive:].sum()) / signs.sum()))


def _boolean_test(group: np.ndarray, other: np.ndarray, paired: bool) -> float:
    """McNemar's exact p of pairs of truths, Fisher's of two groups."""
    from scipy import stats

    if paired:
        more, fewer = int(np.sum(group > other)), int(np.sum(group < other))
        return float(stats.binomtest(more, more + fewer).pvalue) if more + fewer else 1.0
    return float(stats.fisher_exact(_contingency(group, other)).pvalue)


def _contingency(group: np.ndarray, other: np.ndarray) -> list[list[int]]:
    return [[int(values.sum()), int(len(values) - values.sum())] for values in (group, other)]


def _wins(group: np.ndarray, other: np.ndarray) -> float:
    """Share of all pairs in which the first group's value is higher, ties half."""
    ordered = np.sort(other)
    above, at_least = (np.searchsorted(ordered, group, side=side).sum() for side in ("left", "right"))
    return float((above + at_least) / 2 / len(group) / len(other))


def _effect_size(check: dict, comparison: Comparison, side: int, ours: float) -> tuple[str, float]:
    """Name and value: odds ratio of truths; A12, the share of pairs won in the claimed direction; or the difference itself."""
    pairs = [counted(stratum, comparison.paired) for stratum in comparison.strata.values()]
    if comparison.boolean and len(pairs) == 1:
        ((group, other),) = pairs
        if comparison.paired:
            odds = np.array([np.sum(group > other), np.sum(group < other)], dtype=float)
        else:
            (a, b), (c, d) = _contingency(group, other)
            odds = np.array([a * d, b * c], dtype=float)
        with np.errstate(divide="ignore", invalid="ignore"):
            return "odds ratio", float(odds[0] / odds[1])
    if point_statistic(check) not in ("mean", "median"):
        return "difference", ours
    if comparison.paired:
        won = [np.mean((group > other) + 0.5 * (group == other)) for group, other in pairs]
    else:
        won = [_wins(group, other) for group, other in pairs]
    return "A12", float(np.mean(won)) if side > 0 else 1 - float(np.mean(won))


def _by_draws(check: dict, comparison: Comparison, name: str) -> Finding:
    """A sentence about extremes: how often it holds in experiments of the paper's size, drawn from ours."""
    statistic = point_statistic(check)
    ours = float(effect(check, points(comparison, statistic), comparison.cells))
    margin, n = margin_of(check, comparison), units(comparison)
    finding = Finding(effect=ours, effect_size_name="difference", effect_size=ours, n=n, margin=margin)
    if comparison.paper_units is None:
        return finding._replace(mark="?", reason="the paper's number of runs is unknown")
    effects = effect(check, drawn_points(comparison, statistic, name, comparison.paper_units), comparison.cells)
    held = np.mean(claimed(check, effects, margin))
    matters = check["test"] == "equal_within" or abs(ours) >= margin
    return finding._replace(
        mark="?" if not matters else "+" if held >= SURE else "-" if held <= 1 - SURE else "?",
        reason=f"holds in {held:.3f} of draws of {comparison.paper_units}",
    )


def equal_within(check: dict, comparison: Comparison, name: str) -> Finding:
    """Is the difference of two cells, less the target, within the margin? Two one-sided tests; p of being outside where it is outside."""
    ours = float(effect(check, points(comparison, point_statistic(check)), comparison.cells))
    n, reason = units(comparison), too_few(comparison)
    if reason:
        return Finding(effect=ours, n=n, mark="?", reason=reason)
    if point_statistic(check) in WITHOUT_INTERVAL:
        return _by_draws(check, comparison, name)
    margin = margin_of(check, comparison)
    draws = drawn_effects(check, comparison, name)
    low, high = interval(draws)
    toward = 1 if bool(claimed(check, ours, margin)) else -1
    beyond = draws - check.get("target", 0)
    if math.isnan(low):
        p = math.nan
    elif toward > 0:
        p = float(max(np.mean(beyond <= -margin), np.mean(beyond >= margin)))
    else:
        p = min(1.0, 2 * float(np.mean(beyond <= margin) if ours > check.get("target", 0) else np.mean(beyond >= -margin)))
    return Finding(ours, "difference", ours, low, high, n, p, toward, margin, reason=_why_none(ours))


def trend(check: dict, comparison: Comparison, name: str) -> Finding:
    """Does a metric change with x as claimed?"""
    from scipy import stats

    x = np.array(comparison.cells, dtype=float)
    (stratum,) = comparison.strata.values()
    slopes = _slopes(x, stratum)
    n, statistic = len(slopes), point_statistic(check)
    if n < LEAST_RUNS:
        return Finding(n=n, mark="?", reason=f"fewer than {LEAST_RUNS} units with at least 3 values of {check['x']}")
    # A unit counts where it has a value, whether or not it has one at every x.
    each = comparison._replace(paired=False)
    ours = points(each, statistic)
    if statistic == "mean":
        slope = float(slopes.mean())
        changes = slopes * np.ptp(x)
        if check.get("scale") == "relative":
            changes = changes / ours[0] if ours[0] else np.full(n, np.nan)
        change = float(changes.mean())
        if n > MOST_RESAMPLED:
            draws = statistics.normal_draws(change, changes.std(ddof=1) / math.sqrt(n))
        else:
            draws = statistics.resampled("mean", changes, n, generator(name))
        p = signed_rank_test(slopes)
    else:
        slope = float(change_weights(x) @ ours / np.ptp(x))
        change = float(effect(check, ours, comparison.cells))
        draws = drawn_effects(check, comparison, name)
        p = two_sided(draws)
    low, high = interval(draws)
    margin = margin_of(check, each)
    known = np.isfinite(ours)
    linear = known.sum() >= 3 and np.ptp(ours[known]) > 0
    return Finding(
        *(change, "slope", slope, low, high, n, p),
        toward=0 if abs(change) < margin else int(np.sign(SIDES[check["direction"]] * np.nan_to_num(change))),
        margin=margin,
        negligible=is_negligible(low, high, margin, n),
        least_detectable=least_detectable(low, high, n),
        reason=_why_none(change) or no_difference(low, high, n),
        rho=float(stats.spearmanr(x[known], ours[known]).statistic) if linear else math.nan,
        r_squared=float(np.corrcoef(x[known], ours[known])[0, 1] ** 2) if linear else math.nan,
    )


def _slopes(x: np.ndarray, stratum: np.ndarray) -> np.ndarray:
    """Least-squares slopes over x of units that have a finite value at 3 of x or more."""
    usable = stratum[np.isfinite(stratum).sum(axis=1) >= 3]
    return np.array([change_weights(x[there]) @ values[there] / np.ptp(x[there]) for values in usable for there in [np.isfinite(values)]])


def share(check: dict, comparison: Comparison, name: str) -> Finding:
    """In which share of the units does the event happen?"""
    from scipy import stats

    happened = np.concatenate([counted(stratum, False)[0] for stratum in comparison.strata.values()])
    n, k = len(happened), int(happened.sum())
    if not n:
        return Finding(mark="?", reason="no run counts")
    found = Finding(k / n, "share", k / n, n=n)
    holds = bool(claimed(check, np.array(k / n), math.nan))
    if "pick" in check:
        return found._replace(mark="+" if holds else "-")
    exact = stats.binomtest(k, n).proportion_ci(method="exact")
    found = found._replace(low=float(exact.low), high=float(exact.high))
    if isinstance(check["threshold"], str):
        # For `some` one example decides and many misses are needed against it; for `all` and `none` it is the other way round.
        decided = holds == (check["threshold"] == "some") or n >= LEAST_WITHOUT_EXAMPLE
        mark = ("+" if holds else "-") if decided else "?"
        return found._replace(mark=mark, reason="" if decided else f"fewer than {LEAST_WITHOUT_EXAMPLE} runs")
    if n < LEAST_RUNS:
        return found._replace(mark="?", reason=f"fewer than {LEAST_RUNS} units")
    threshold = check["threshold"]
    if len(comparison.strata) >= LEAST_RUNS:
        return _share_of_conditions(found, comparison, threshold, SIDES[check["direction"]])
    # Twice the smaller tail, the test that belongs to the interval of Clopper and Pearson.
    p = min(1.0, 2 * float(min(stats.binom.cdf(k, n, threshold), stats.binom.sf(k - 1, n, threshold))))
    return found._replace(p=p, toward=int(np.sign(SIDES[check["direction"]] * (k / n - threshold))))


def _share_of_conditions(found: Finding, comparison: Comparison, threshold: float, side: int) -> Finding:
    """Conditions that are drawn, such as layouts, are the units: runs of one are alike. Student's t over their shares."""
    from scipy import stats

    shares = np.array([np.nanmean(stratum) for stratum in comparison.strata.values() if not np.isnan(stratum).all()])
    mean = float(shares.mean())
    toward = int(np.sign(side * (mean - threshold)))
    if not np.ptp(shares):
        return found._replace(effect=mean, effect_size=mean, low=mean, high=mean, n=len(shares), p=0.0 if toward else 1.0, toward=toward)
    test = stats.ttest_1samp(shares, threshold)
    low, high = (float(np.clip(end, 0, 1)) for end in test.confidence_interval(0.95))
    return found._replace(effect=mean, effect_size=mean, low=low, high=high, n=len(shares), p=float(test.pvalue), toward=toward)


def difference(check: dict, comparison: Comparison, name: str) -> Finding:
    """Do the cells differ at all?"""
    from scipy import stats

    ours = float(effect(check, points(comparison, "mean"), comparison.cells))
    n, reason = units(comparison), too_few(comparison)
    if reason:
        return Finding(effect=ours, n=n, mark="?", reason=reason)
    if len(comparison.cells) == 2:
        found = lower(check | {"direction": "higher"}, comparison, name)
        return found._replace(toward=abs(found.toward))
    (stratum,) = comparison.strata.values()
    groups = counted(stratum, comparison.paired)
    total = sum(map(len, groups))
    low, high = interval(drawn_effects(check, comparison, name))
    margin = margin_of(check, comparison)
    if comparison.paired:
        same = all(np.ptp(values) == 0 for values in zip(*groups))
        tested = None if same else stats.friedmanchisquare(*groups)
        size_name, largest = "Kendall's W", n * (len(groups) - 1)
    else:
        tested = None if np.ptp(np.concatenate(groups)) == 0 else stats.kruskal(*groups)
        size_name, largest = "epsilon squared", total - 1
    return Finding(
        *(ours, size_name, float(tested.statistic / largest) if tested else 0.0, low, high, n, float(tested.pvalue) if tested else 1.0),
        toward=int(ours >= margin),
        margin=margin,
        negligible=is_negligible(low, high, margin, n),
        least_detectable=least_detectable(low, high, n),
        reason=no_difference(low, high, n),
    )


TESTS: dict[str, Callable[[dict, Comparison, str], Finding]] = {
    "lower": lower,
    "ordered": lower,
    "trend": trend,
    "share": share,
    "equal_within": equal_within,
    "difference": difference,
}
