"""The comparisons of a claim, their effects on point values, and the bootstrap draws and intervals
of these effects.

A comparison consists of cells: a group and the one that it is compared with, several groups, or the
values of a factor. Each cell has one value per unit (an independent replicate), in one or several
conditions that are averaged with equal weight.

The interval of a difference of booleans is Wald's with one success and one failure added to each
group (Agresti and Caffo 2000), or one half added to each kind of pair (Agresti and Min 2005):
resampling says nothing about events that never happened.
"""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from bezierplan.analysis import statistics
from bezierplan.analysis.claims.check import SIDES, OfRuns, PublishedMargin
from bezierplan.analysis.statistics import LEAST_RUNS, MOST_RESAMPLED, TAIL, WITHOUT_INTERVAL
from bezierplan.workspaces.seeds import generator

ALPHA = 0.05
# Share of draws in which a sentence about extremes must hold.
SURE = 0.95
# As many times the runs of an experiment hardly repeat its extremes when they are drawn from.
ENOUGH = 10
# This many runs without a counterexample show with 95 % confidence that fewer than 5 % of all runs
# are counterexamples.
LEAST_WITHOUT_EXAMPLE = 59
_EVENTS: dict[str, Callable] = {
    "below": np.less,
    "above": np.greater,
    "at_most": np.less_equal,
    "at_least": np.greater_equal,
}


class Terms(NamedTuple):
    """The words of a comparison: a group, a relation, and another group; empty where there is
    nothing.

    For a share they are the event and the required share; for a trend, the column and the claimed
    direction; for a function, its name.
    """

    group: Any = ""
    relation: str = ""
    other: Any = ""

    @property
    def name(self) -> str:
        """Return the name by which random draws are seeded."""
        return " ".join(str(part) for part in self if part != "")


class Contrast(NamedTuple):
    """The values of the cells of one comparison; the terms alone if no runs are compared.

    terms: the words of the comparison. place: the values of `every` there, by column. cells:
    groups, or values of x in rising order (k).

    strata: one table (units, k) for each condition that is averaged over (mostly one), by name; NaN
    where a unit has no value, infinite where it counts as worse than any other. For a share, the
    values say whether the event happened. printed: the published numbers of the cells (k,), NaN
    unless all are printed. paper_units: number of units in the paper. boolean: whether the metric
    is true or false. paired: whether equal units of the cells belong together. note: for the reader
    of the row. conditions: how many a cell pools.
    """

    terms: Terms = Terms()
    place: tuple[tuple[str, Any], ...] = ()
    cells: tuple = ()
    strata: Mapping[str, np.ndarray] = MappingProxyType({})
    printed: np.ndarray = np.full(1, np.nan)
    paper_units: int | None = None
    boolean: bool = False
    paired: bool = False
    note: str = ""
    conditions: int | None = None

    @property
    def seed(self) -> str:
        """Return the name of its place, by which random draws are seeded."""
        return ", ".join(f"{column}={value}" for column, value in self.place)

    def list_values(self, finite: bool = False) -> list[list[np.ndarray]]:
        """List the values of each cell, by condition; if paired, only of units with a value in
        every cell. finite: without infinite values, so that they can be averaged.
        """
        listed = []
        for values in self.strata.values():
            known = np.isfinite(values) if finite else ~np.isnan(values)
            if self.paired:
                known[:] = known.all(axis=1, keepdims=True)
            listed.append([cell[counts] for cell, counts in zip(values.T, known.T)])
        return listed

    @property
    def counted(self) -> str:
        """Return as text, such as `28 of 30, 30 of 30`, how many units of each cell have a value
        that can be averaged; fewer if runs failed.
        """
        found = zip(*(np.isfinite(stratum).sum(axis=0) for stratum in self.strata.values()))
        total = sum(map(len, self.strata.values()))
        return ", ".join(f"{sum(counts)} of {total}" for counts in found)


class Finding(NamedTuple):
    """The result of a test; NaN for quantities that do not exist.

    toward: 1 if the effect matters and points as claimed, -1 if it matters and points the other
    way, otherwise 0. negligible: whether the interval of the effect lies within the margin. mark:
    `+`, `-`, `0` or `?` if it does not follow from p (`verdicts.choose_mark`). chance_known:
    whether our runs are enough to tell how often experiments of the paper's size agree with the
    claim.
    """

    effect: float = math.nan
    low95: float = math.nan
    high95: float = math.nan
    n: int = 0
    p: float = math.nan
    toward: int = 0
    margin: float = math.nan
    negligible: bool = False
    mark: str = ""
    reason: str = ""
    chance_known: bool = False


class MarkedComparison(NamedTuple):
    """One comparison with what was found. primary: False for a secondary check.

    parts: the comparisons that it takes together, if any; `comparison` is then the decisive one.
    """

    number: int
    check: Any
    primary: bool
    comparison: Contrast
    finding: Finding
    mark: str = "?"
    mark_family: str = ""
    p_family: float = math.nan
    parts: tuple[Contrast, ...] = ()


def mark_events(check: OfRuns, values: np.ndarray) -> np.ndarray:
    """Return for each value (n,) whether the event of a check happened, as 1 and 0; NaN is kept.
    Without an event the values are returned as they are.
    """
    if check.limit is None:
        return values
    word, limit = check.limit
    return np.where(np.isnan(values), np.nan, _EVENTS[word](values, limit))


def compute_margin(check: OfRuns, comparison: Contrast) -> float:
    """Compute the smallest effect that matters, which is given as a number or as a share.

    `{published: share}`: a share of the other group's value (of the value at the lowest x; for
    booleans the share itself), or the printed difference of the same cells if that is smaller and
    points as claimed. NaN for tests without a margin.
    """
    margin = check.margin
    if not isinstance(margin, PublishedMargin):
        return margin
    published_margin = margin.published
    # Relative effects and those of booleans are shares already.
    if not check.relative and not comparison.boolean:
        points = compute_points(comparison, check.point_statistic)
        published_margin *= abs(float(points[check.reference]))
    printed = check.compute_effect(comparison.printed, comparison.cells)
    as_claimed = printed * SIDES.get(check.direction, np.sign(printed)) > 0
    return min(published_margin, float(abs(printed))) if as_claimed else published_margin


# Values of units, statistics of cells, and their bootstrap.


def compute_points(comparison: Contrast, statistic: str) -> np.ndarray:
    """Compute a named statistic of each cell (k,), averaged over the conditions."""
    points = [
        [statistics.compute_statistic(statistic, values) for values in cells]
        for cells in comparison.list_values(finite=True)
    ]
    return np.mean(points, axis=0)


def draw_points(
    comparison: Contrast, statistic: str, name: str, size: int | None = None
) -> np.ndarray:
    """Draw from the units of each cell and return a named statistic of the draws (DRAWS, k),
    averaged over the conditions; NaN for an empty cell.

    name: seeds the draws. Cells of the same name in comparisons at the same place share their
    draws; paired cells are drawn unit by unit. size: units in a draw, with the same share of
    counted units as ours; None to draw as many as there are.
    """
    total = np.zeros((statistics.DRAWS, len(comparison.cells)))
    conditions = zip(comparison.strata.items(), comparison.list_values(finite=True))
    for (stratum_name, stratum), cells in conditions:
        for number, values in enumerate(cells):
            if not len(values):
                total[:, number] = np.nan
                continue
            drawn = (
                len(values) if size is None else max(1, round(size * len(values) / len(stratum)))
            )
            # Paired cells have one generator, so that the same units are drawn in each.
            own = "" if comparison.paired else f"/{comparison.cells[number]}"
            # Seeds are names, so that no draw depends on the order of comparisons.
            rng = generator(f"{name}/{comparison.seed}/{stratum_name}{own}")
            total[:, number] += statistics.resample(statistic, values, drawn, rng)
    return total / len(comparison.strata)


def draw_effects(check: OfRuns, comparison: Contrast, name: str) -> np.ndarray:
    """Return draws (DRAWS,) of the effect of the check's statistic: by bootstrap, or normal
    quantiles for booleans and for many values; NaN if a cell of numbers is empty.

    name: seeds the draws.
    """
    statistic = check.point_statistic
    if comparison.boolean and statistic == "mean" and not check.relative:
        # Resampling says nothing about events that never happened (module docstring).
        adjusted = [
            _compute_adjusted_difference(*cells, comparison.paired)
            for cells in comparison.list_values()
        ]
        centre, variance = np.mean(adjusted, axis=0)
        return statistics.compute_normal_draws(float(centre), math.sqrt(variance / len(adjusted)))
    ours = compute_points(comparison, statistic)
    gradient = check.compute_gradient(ours, comparison.cells)
    # The normal approximation needs many values in every cell.
    conditions = comparison.list_values(finite=True)
    if gradient is None or any(len(v) <= MOST_RESAMPLED for cells in conditions for v in cells):
        return check.compute_effect(draw_points(comparison, statistic, name), comparison.cells)
    variance = 0.0
    for cells in conditions:
        moved = [
            g * statistics.compute_influence(statistic, values)
            for g, values in zip(gradient, cells)
        ]
        # Paired cells vary together, so their influences are added unit by unit.
        parts = [np.sum(moved, axis=0)] if comparison.paired else moved
        variance += sum(part.var(ddof=1) / len(part) for part in parts)
    return statistics.compute_normal_draws(
        float(check.compute_effect(ours, comparison.cells)),
        math.sqrt(variance) / len(comparison.strata),
    )


def _compute_adjusted_difference(
    group: np.ndarray, reference: np.ndarray, paired: bool
) -> tuple[float, float]:
    """Compute the difference of the shares of two boolean groups, and its variance, with two units
    added to each.
    """
    if paired:
        # Agresti and Min: one half for each of the four kinds of pair.
        n = len(group) + 2
        more, fewer = (np.sum(group > reference) + 0.5) / n, (np.sum(group < reference) + 0.5) / n
        return more - fewer, (more + fewer - (more - fewer) ** 2) / n
    # Agresti and Caffo: one success and one failure more in each group.
    shares = [(values.sum() + 1) / (len(values) + 2) for values in (group, reference)]
    return shares[0] - shares[1], sum(
        share * (1 - share) / (len(values) + 2) for share, values in zip(shares, (group, reference))
    )


def measure_effect(check: OfRuns, comparison: Contrast, name: str) -> tuple[Finding, np.ndarray]:
    """Measure the effect of two cells, and return it with its draws. The finding has a mark where
    no test follows: there are too few units, or the sentence is about extremes.
    """
    points = compute_points(comparison, check.point_statistic)
    ours = float(check.compute_effect(points, comparison.cells))
    n = count_units(comparison)
    if reason := explain_too_few(comparison):
        return Finding(ours, n=n, mark="?", reason=reason), np.empty(0)
    finding = Finding(ours, n=n, margin=compute_margin(check, comparison))
    if check.point_statistic in WITHOUT_INTERVAL:
        return _judge_by_draws(check, comparison, name, finding), np.empty(0)
    draws = draw_effects(check, comparison, name)
    low, high = compute_interval_of_draws(draws)
    return finding._replace(low95=low, high95=high), draws


def _judge_by_draws(check: OfRuns, comparison: Contrast, name: str, finding: Finding) -> Finding:
    """Judge a sentence about extremes by how often it holds in experiments of the paper's size,
    drawn from our runs.
    """
    size = comparison.paper_units
    # Extremes depend on the number of runs.
    if size is None:
        return finding._replace(mark="?", reason="the paper's number of runs is unknown")
    draws = draw_points(comparison, check.point_statistic, name, size)
    effects = check.compute_effect(draws, comparison.cells)
    held = np.mean(check.is_as_claimed(effects, finding.margin))
    return finding._replace(
        mark=mark_share(held),
        chance_known=finding.n >= ENOUGH * size,
        reason=f"holds in {100 * held:.3g} % of experiments of {size} runs drawn from ours",
    )


def mark_share(share: float) -> str:
    """Return the mark of a sentence that holds in a share of draws."""
    return "+" if share >= SURE else "-" if share <= 1 - SURE else "?"


def compute_p(draws: np.ndarray) -> float:
    """Compute the two-sided bootstrap p of an effect from its draws."""
    if not np.isfinite(draws).all():
        return math.nan
    return float(min(1.0, 2 * min(np.mean(draws <= 0), np.mean(draws >= 0))))


def compute_interval_of_draws(draws: np.ndarray) -> tuple[float, float]:
    """Compute the central 95 % interval of draws; NaN if any is not finite."""
    if not np.isfinite(draws).all():
        return math.nan, math.nan
    low, high = np.quantile(draws, [TAIL, 1 - TAIL])
    return float(low), float(high)


def is_negligible(low: float, high: float, margin: float, n: int, least: float = 0.0) -> bool:
    """Return whether the interval of an effect, less the claimed one, lies within the margin.
    Identical units must be enough to say so.
    """
    return bool(
        max(abs(low - least), abs(high - least)) <= margin
        and (low < high or n >= LEAST_WITHOUT_EXAMPLE)
    )


def explain_no_difference(low: float, high: float, n: int) -> str:
    """Explain why identical units say nothing; empty if they differ or are enough."""
    return (
        f"no difference in fewer than {LEAST_WITHOUT_EXAMPLE} units"
        if low == high == 0 and n < LEAST_WITHOUT_EXAMPLE
        else ""
    )


def count_units(comparison: Contrast) -> int:
    """Count the units of the smallest cell, over all conditions."""
    sizes = [[*map(len, cells)] for cells in comparison.list_values()]
    return min(map(sum, zip(*sizes)))


def explain_too_few(comparison: Contrast) -> str:
    """Explain why a comparison says nothing; empty if it may say something."""
    for stratum, counted in zip(comparison.strata.values(), comparison.list_values()):
        for cell, values in zip(comparison.cells, stratum.T):
            if np.isnan(values).all():
                return f"no run of {cell} counts"
        if np.isinf(stratum[~np.isnan(stratum)]).all():
            return "no run succeeded"
        if min(map(len, counted)) < LEAST_RUNS:
            return f"fewer than {LEAST_RUNS} units"
    return ""


def explain_missing(number: float) -> str:
    """Explain why there is no such p or effect; empty if there is one."""
    return "" if math.isfinite(number) else "relative to a value that is zero or does not exist"
