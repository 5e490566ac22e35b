"""The statistical tests of claims, on numbers alone.

A comparison has cells side by side: a group and the one that it is compared with, several groups, or the values of a factor. Each cell has
one value a unit (an independent replicate), in one or several conditions that are averaged with equal weight. A test takes a check (a
mapping, see config/README.md) and a comparison, and gives a finding. All p are two-sided and all intervals 95 %, by bootstrap over units
within each condition; above `statistics.MOST_RESAMPLED` units by its normal approximation.

| test | effect | statistic and test | effect size |
| --- | --- | --- | --- |
| lower, ordered | group - other | `rank`: Wilcoxon's signed ranks, Pratt's zeros (paired), Mann-Whitney | A12 in the claimed direction |
| | | of truths: McNemar's exact test (paired), Fisher's exact test | odds ratio |
| | | another statistic, or several conditions: bootstrap | A12, of spreads the difference |
| trend | change from lowest to highest x | least-squares slope of each unit, Wilcoxon against 0; `std`: bootstrap | slope |
| share | share | exact binomial, interval of Clopper and Pearson; all, none, some: one (counter)example decides | share |
| equal_within | group - other | two one-sided tests: 90 % interval of the difference within the margin | difference |
| difference | range of the means | two groups as `lower`; more: Friedman (paired), Kruskal-Wallis | Kendall's W, epsilon squared |

The effect of lower, ordered and equal_within is one of means, or of the statistic that the check names.
min, max and range depend on the number of runs: they are judged by how often the sentence holds in draws of the paper's number of runs.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bezierplan.analysis import statistics
from bezierplan.analysis.statistics import LEAST_RUNS, MOST_RESAMPLED, TAIL, WITHOUT_INTERVAL, generator

ALPHA = 0.05
# Of more differences the signed ranks are judged by their normal approximation.
MOST_EXACT = 50
# So many runs without a counterexample make it 95 % sure that fewer than 5 % of all runs are one.
LEAST_WITHOUT_EXAMPLE = 59
# An effect of so many standard errors is found with a power of at least 0.8 (simulated for both rank tests, normal data, 10 to 100 units).
DETECTED = 3.0
DETECTED_BELOW_20 = 3.2
# Share of draws in which a sentence about extremes has to hold.
SURE = 0.95

_SIDES = {"lower": -1, "higher": 1, "down": -1, "up": 1, "at_most": -1, "at_least": 1}
_EVENTS: dict[str, Callable] = {
    "below": np.less,
    "above": np.greater,
    "at_most": np.less_equal,
    "at_least": np.greater_equal,
    "equals": np.equal,
}


class Comparison(NamedTuple):
    """place: the combination of `every`, as text; name: the comparison in words. cells: groups, or values of x in rising order (k).

    strata: one table (units, k) for each condition that is averaged over (mostly one), by name; not a number where a unit has no value,
    infinite where it counts as worse than any. In a share the values are whether the event happened.
    printed: the published numbers of the cells (k,), not a number unless all are printed. paper_units: how many units the paper has.
    boolean: is the metric true or false? paired: do equal units of the cells belong together? note: what a reader of the row should know.
    """

    place: str
    name: str
    cells: tuple
    strata: dict[str, np.ndarray]
    printed: np.ndarray
    paper_units: int | None
    boolean: bool
    paired: bool
    note: str = ""


class Finding(NamedTuple):
    """What a test found; not a number for what does not exist.

    toward: 1 if the effect points as claimed, -1 if against it, 0 if neither. least_detectable: the effect that would have been found with
    a power of 0.8. mark: `+`, `-`, `0` or `?` where it does not follow from p (`claims.mark`). rho, r_squared: of trends.
    """

    effect: float = math.nan
    effect_size_name: str = ""
    effect_size: float = math.nan
    low: float = math.nan
    high: float = math.nan
    n: int = 0
    p: float = math.nan
    toward: int = 0
    margin: float = math.nan
    least_detectable: float = math.nan
    mark: str = ""
    reason: str = ""
    rho: float = math.nan
    r_squared: float = math.nan


# What a claim says about point values. All work on (..., k) numbers of cells, so that they serve ours, printed ones and draws.


def event(check: dict, values: np.ndarray) -> np.ndarray:
    """Did the event of a share happen? As 1 and 0; a value that is not a number stays. Without an event the values are truths already."""
    if "event" not in check:
        return values
    ((word, limit),) = check["event"].items()
    return np.where(np.isnan(values), np.nan, _EVENTS[word](values, limit))


def effect(check: dict, points: np.ndarray, cells: tuple) -> np.ndarray:
    """The effect (...) that point values (..., k) of the cells have.

    If relative: to the other group's value, to that at the lowest x, to the mean of more than two groups.
    """
    relative = check.get("scale") == "relative"
    with np.errstate(divide="ignore", invalid="ignore"):
        if check["test"] == "share":
            return points[..., 0]
        if check["test"] == "trend":
            change = points @ _change_weights(np.array(cells, dtype=float))
            return change / points[..., 0] if relative else change
        if len(cells) > 2:
            return np.ptp(points, axis=-1) / (points.mean(axis=-1) if relative else 1)
        group, other = points[..., 0], points[..., 1]
        return group / other - 1 if relative else group - other


def claimed(check: dict, effects: np.ndarray, margin: float) -> np.ndarray:
    """Is an effect what the claim says, by its value alone?"""
    match check["test"]:
        case "share":
            match check["threshold"]:
                case "all":
                    return effects == 1
                case "none":
                    return effects == 0
                case "some":
                    return effects > 0
            return _SIDES[check["direction"]] * (effects - check["threshold"]) >= 0
        case "equal_within":
            return np.abs(effects - check.get("target", 0)) <= margin
        case "difference":
            return np.abs(effects) >= margin
    return _SIDES[check["direction"]] * effects > check.get("least", 0)


def margin_of(check: dict, comparison: Comparison) -> float:
    """The smallest effect that matters: as given, or the printed difference of the same cells where it points as claimed.

    `{published: share}`: where the printed difference is zero, points the other way or is not printed, a share of the other group's value
    (of that at the lowest x). Not a number for tests without a margin.
    """
    margin = check.get("margin", math.nan)
    if not isinstance(margin, dict):
        return margin
    printed = effect(check, comparison.printed, comparison.cells)
    if printed * _SIDES.get(check.get("direction"), np.sign(printed)) > 0:
        return float(abs(printed))
    reference = points(comparison, point_statistic(check))[0 if check["test"] == "trend" else 1]
    return margin["published"] * (1.0 if check.get("scale") == "relative" else abs(float(reference)))


def point_statistic(check: dict) -> str:
    """The statistic that stands for a cell where one number has to."""
    if check["test"] == "share":
        return "share"
    named = check.get("statistic", "rank")
    return "mean" if named == "rank" else named


def _change_weights(x: np.ndarray) -> np.ndarray:
    """Weights (k,) of values over x (k,) that give least-squares slope times range of x; not a number for a single x."""
    from_mean = x - x.mean()
    return from_mean / (from_mean**2).sum() * np.ptp(x)


# Values of units, statistics of cells, and their bootstrap.


def counted(stratum: np.ndarray, paired: bool) -> list[np.ndarray]:
    """The values of each cell of a condition (units, k); if paired, of the units that have a value in every cell."""
    if paired:
        return list(stratum[~np.isnan(stratum).any(axis=1)].T)
    return [values[~np.isnan(values)] for values in stratum.T]


def _finite(stratum: np.ndarray, paired: bool) -> list[np.ndarray]:
    """The values that can be averaged."""
    return counted(np.where(np.isinf(stratum), np.nan, stratum), paired)


def points(comparison: Comparison, statistic: str) -> np.ndarray:
    """A named statistic of each cell (k,), averaged over the conditions."""
    each = [
        [statistics.statistic(statistic, values) for values in _finite(stratum, comparison.paired)]
        for stratum in comparison.strata.values()
    ]
    return np.mean(each, axis=0)


def drawn_points(comparison: Comparison, statistic: str, name: str, size: int | None = None) -> np.ndarray:
    """A named statistic of each cell in draws from its units (DRAWS, k), averaged over the conditions; not a number for an empty cell.

    name: from it the draws follow. Cells of the same name in comparisons at the same place are drawn alike, and paired cells unit by unit.
    size: units in a draw, of which as large a share counts as of ours; None to draw as many as there are.
    """
    total = np.zeros((statistics.DRAWS, len(comparison.cells)))
    for stratum_name, stratum in comparison.strata.items():
        for number, values in enumerate(_finite(stratum, comparison.paired)):
            if not len(values):
                total[:, number] = np.nan
                continue
            drawn = len(values) if size is None else max(1, round(size * len(values) / len(stratum)))
            own = "" if comparison.paired else f"/{comparison.cells[number]}"
            rng = generator(f"{name}/{comparison.place}/{stratum_name}{own}")
            total[:, number] += statistics.resampled(statistic, values, drawn, rng)
    return total / len(comparison.strata)


def _drawn_effects(check: dict, comparison: Comparison, name: str) -> np.ndarray:
    """The effect of the check's statistic in bootstrap draws (DRAWS,), or their normal approximation; not a number with an empty cell."""
    statistic = point_statistic(check)
    ours = points(comparison, statistic)
    gradient = _gradient(check, ours, comparison.cells)
    if gradient is None or any(len(v) <= MOST_RESAMPLED for s in comparison.strata.values() for v in _finite(s, comparison.paired)):
        return effect(check, drawn_points(comparison, statistic, name), comparison.cells)
    variance = 0.0
    for stratum in comparison.strata.values():
        moved = [g * statistics.influence(statistic, values) for g, values in zip(gradient, _finite(stratum, comparison.paired))]
        parts = [np.sum(moved, axis=0)] if comparison.paired else moved
        variance += sum(part.var(ddof=1) / len(part) for part in parts)
    return statistics.normal_draws(float(effect(check, ours, comparison.cells)), math.sqrt(variance) / len(comparison.strata))


def _gradient(check: dict, ours: np.ndarray, cells: tuple) -> np.ndarray | None:
    """How the effect changes with the point value of each cell (k,); None where it has no linear approximation."""
    reference = 1.0
    if check.get("scale") == "relative":
        reference = ours[0] if check["test"] == "trend" else ours[1]
    if not reference or (len(cells) > 2 and check["test"] != "trend"):
        return None
    if check["test"] == "trend":
        return _change_weights(np.array(cells, dtype=float)) / reference
    return np.array([1.0, -ours[0] / reference if check.get("scale") == "relative" else -1.0]) / reference


def _two_sided(draws: np.ndarray) -> float:
    """Bootstrap p of draws of an effect against none."""
    if not np.isfinite(draws).all():
        return math.nan
    return float(min(1.0, 2 * min(np.mean(draws <= 0), np.mean(draws >= 0))))


def _interval(draws: np.ndarray) -> tuple[float, float]:
    if not np.isfinite(draws).all():
        return math.nan, math.nan
    low, high = np.quantile(draws, [TAIL, 1 - TAIL])
    return float(low), float(high)


def _least_detectable(low: float, high: float, n: int) -> float:
    error = (high - low) / 2 / 1.96
    return error * (DETECTED_BELOW_20 if n < 20 else DETECTED)


def _units(comparison: Comparison) -> int:
    """Units of the smallest cell, over all conditions."""
    return min(map(sum, zip(*(map(len, counted(stratum, comparison.paired)) for stratum in comparison.strata.values()))))


def _too_few(comparison: Comparison) -> str:
    """Why a comparison says nothing, empty if it may say something."""
    for stratum in comparison.strata.values():
        for cell, values in zip(comparison.cells, stratum.T):
            if np.isnan(values).all():
                return f"no run of {cell} counts"
        if np.isinf(stratum[~np.isnan(stratum)]).all():
            return "no run succeeded"
        if min(map(len, counted(stratum, comparison.paired))) < LEAST_RUNS:
            return f"fewer than {LEAST_RUNS} units"
    return ""


# The tests. Each takes a check, a comparison and a name from which its draws follow.


def lower(check: dict, comparison: Comparison, name: str) -> Finding:
    """Is the first cell lower (higher) than the second one?"""
    ours = float(effect(check, points(comparison, point_statistic(check)), comparison.cells))
    n, reason = _units(comparison), _too_few(comparison)
    if reason:
        return Finding(effect=ours, n=n, mark="?", reason=reason)
    if point_statistic(check) in WITHOUT_INTERVAL:
        return _by_draws(check, comparison, name)
    side, least = _SIDES[check["direction"]], check.get("least", 0)
    draws = _drawn_effects(check, comparison, name)
    low, high = _interval(draws)
    toward = np.sign(side * ours - least)
    if check.get("statistic", "rank") != "rank" or len(comparison.strata) > 1:
        p = _two_sided(side * draws - least)
    else:
        (stratum,) = comparison.strata.values()
        group, other = counted(stratum, comparison.paired)
        if comparison.boolean:
            p = _boolean_test(group, other, comparison.paired)
        else:
            p, ranked = _rank_test(*_shifted(check, group, other), comparison.paired)
            # The means have to differ in the direction of the ranks, unless some values have no mean.
            toward = side * ranked if np.isinf(stratum).any() or toward == side * ranked else 0
    size_name, size = _effect_size(check, comparison, side, ours)
    found = Finding(ours, size_name, size, low, high, n, p, int(np.nan_to_num(toward)), reason=_why_none(p))
    return found._replace(margin=margin_of(check, comparison), least_detectable=_least_detectable(low, high, n))


def _why_none(number: float) -> str:
    """Why there is no such p or effect, empty if there is one."""
    return "" if math.isfinite(number) else "relative to a value that is zero or does not exist"


def _shifted(check: dict, group: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values of both groups, the other's moved by the claimed least effect; infinite ones replaced by one beyond any difference."""
    finite = np.concatenate([values[np.isfinite(values)] for values in (group, other)])
    worst = finite.max() + 2 * np.ptp(finite) + 1
    group, other = (np.where(np.isinf(values), worst, values) for values in (group, other))
    move = _SIDES[check["direction"]] * check.get("least", 0)
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
    margin, n = margin_of(check, comparison), _units(comparison)
    finding = Finding(effect=ours, effect_size_name="difference", effect_size=ours, n=n, margin=margin)
    if comparison.paper_units is None:
        return finding._replace(mark="?", reason="the paper's number of runs is unknown")
    effects = effect(check, drawn_points(comparison, statistic, name, comparison.paper_units), comparison.cells)
    held = np.mean(claimed(check, effects, margin))
    return finding._replace(
        mark="+" if held >= SURE else "-" if held <= 1 - SURE else "?", reason=f"holds in {held:.3f} of draws of {comparison.paper_units}"
    )


def equal_within(check: dict, comparison: Comparison, name: str) -> Finding:
    """Is the difference of two cells, less the target, within the margin? Two one-sided tests; p of being outside where it is outside."""
    ours = float(effect(check, points(comparison, point_statistic(check)), comparison.cells))
    n, reason = _units(comparison), _too_few(comparison)
    if reason:
        return Finding(effect=ours, n=n, mark="?", reason=reason)
    if point_statistic(check) in WITHOUT_INTERVAL:
        return _by_draws(check, comparison, name)
    margin = margin_of(check, comparison)
    draws = _drawn_effects(check, comparison, name)
    low, high = _interval(draws)
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
        slope = float(_change_weights(x) @ ours / np.ptp(x))
        change = float(effect(check, ours, comparison.cells))
        draws = _drawn_effects(check, comparison, name)
        p = _two_sided(draws)
    low, high = _interval(draws)
    known = np.isfinite(ours)
    linear = known.sum() >= 3 and np.ptp(ours[known]) > 0
    return Finding(
        *(change, "slope", slope, low, high, n, p),
        toward=int(np.sign(_SIDES[check["direction"]] * np.nan_to_num(change))),
        margin=margin_of(check, each),
        least_detectable=_least_detectable(low, high, n),
        reason=_why_none(change),
        rho=float(stats.spearmanr(x[known], ours[known]).statistic) if linear else math.nan,
        r_squared=float(np.corrcoef(x[known], ours[known])[0, 1] ** 2) if linear else math.nan,
    )


def _slopes(x: np.ndarray, stratum: np.ndarray) -> np.ndarray:
    """Least-squares slopes over x of units that have a finite value at 3 of x or more."""
    usable = stratum[np.isfinite(stratum).sum(axis=1) >= 3]
    return np.array([_change_weights(x[there]) @ values[there] / np.ptp(x[there]) for values in usable for there in [np.isfinite(values)]])


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
    # Twice the smaller tail, the test that belongs to the interval of Clopper and Pearson.
    p = min(1.0, 2 * float(min(stats.binom.cdf(k, n, threshold), stats.binom.sf(k - 1, n, threshold))))
    return found._replace(p=p, toward=int(np.sign(_SIDES[check["direction"]] * (k / n - threshold))))


def difference(check: dict, comparison: Comparison, name: str) -> Finding:
    """Do the cells differ at all?"""
    from scipy import stats

    ours = float(effect(check, points(comparison, "mean"), comparison.cells))
    n, reason = _units(comparison), _too_few(comparison)
    if reason:
        return Finding(effect=ours, n=n, mark="?", reason=reason)
    if len(comparison.cells) == 2:
        return lower(check | {"direction": "higher"}, comparison, name)._replace(toward=1, margin=margin_of(check, comparison))
    (stratum,) = comparison.strata.values()
    groups = counted(stratum, comparison.paired)
    total = sum(map(len, groups))
    low, high = _interval(_drawn_effects(check, comparison, name))
    if comparison.paired:
        same = all(np.ptp(values) == 0 for values in zip(*groups))
        tested = None if same else stats.friedmanchisquare(*groups)
        size_name, largest = "Kendall's W", n * (len(groups) - 1)
    else:
        tested = None if np.ptp(np.concatenate(groups)) == 0 else stats.kruskal(*groups)
        size_name, largest = "epsilon squared", total - 1
    return Finding(
        *(ours, size_name, float(tested.statistic / largest) if tested else 0.0, low, high, n, float(tested.pvalue) if tested else 1.0),
        toward=1,
        margin=margin_of(check, comparison),
        least_detectable=_least_detectable(low, high, n),
    )


TESTS: dict[str, Callable[[dict, Comparison, str], Finding]] = {
    "lower": lower,
    "ordered": lower,
    "trend": trend,
    "share": share,
    "equal_within": equal_within,
    "difference": difference,
}
