"""Whether groups are lower, or higher, than others: each of some than each of others, or every
one of a tier than every one of the next.

| statistic | test | effect size |
| --- | --- | --- |
| `rank` | Wilcoxon's signed ranks, Pratt's zeros (paired), Mann-Whitney | A12 as claimed |
| `rank` of booleans | McNemar's exact test (paired), Fisher's exact test | odds ratio |
| `mean` | Student's t of the differences (paired), Welch's t | A12 |
| any other, or several conditions | bootstrap | A12; for spreads the difference |
| `min`, `max`, `range` | how often the sentence holds in draws of as many runs | the difference |

Minima, maxima and ranges depend on the number of runs: their draws have as many as the paper.

The effect is the group's value minus the other's: of means, or of the statistic that the check
names.
"""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis.claims import effects, verdicts
from bezierplan.analysis.claims.check import (
    FAILURES,
    GROUP_KEYS,
    GROUPS,
    THAN,
    WORK,
    Comparing,
    Group,
    Groups,
    OfRuns,
    with_itself,
)
from bezierplan.analysis.claims.effects import Contrast, Finding, Terms
from bezierplan.analysis.claims.ranks import rank_test, wins
from bezierplan.analysis.statistics import WITHOUT_INTERVAL
from bezierplan.schema.model import Flag, Metric, Positive, build_error, build_list_type

if TYPE_CHECKING:
    import pandas as pd

EFFECT = effects.BETWEEN_GROUPS


class Options(Comparing):
    paired: Flag = Field(
        None,
        description="whether equal units are compared with each other, true or false; left out: as "
        "the experiment is drawn",
    )
    groups: Groups = Field(None, description=GROUPS)
    than: Groups = Field(None, description=THAN)
    pairs: build_list_type(build_list_type(Group, least=2)) = Field(
        None, description="a list of [group, other group], in place of groups and than"
    )
    order: build_list_type(build_list_type(Group), least=2) = Field(
        None,
        description="tiers, each on the claimed side of the next: a list of lists of groups, in "
        "place of groups and than",
    )
    direction: Literal["lower", "higher"] = Field(
        description="lower or higher: how the groups, or the first tier, compare with the others"
    )
    statistic: Literal["rank", "mean", "median", "std", "iqr", "range", "min", "max"] = Field(
        "rank",
        description="the statistic that is compared: rank (left out: this), mean, median, std, "
        "iqr, range, min or max",
    )
    least: Positive = Field(
        0, description="the claimed least effect, a number above 0; left out: any effect"
    )
    together: Literal[True] = Field(
        None,
        description="true: a sentence such as `the best of all`, whose comparisons at one place "
        "(one combination of `every`) make one mark: + if all are +, - if any is -; they are shown "
        "as secondary ones; left out otherwise",
    )
    work: Metric = Field(None, description=WORK)
    failures: Literal["drop", "last", "count"] = Field("drop", description=FAILURES)

    @model_validator(mode="after")
    def _check_groups(self) -> Options:
        named = self.model_fields_set & set(GROUP_KEYS)
        if named not in ({"groups", "than"}, {"pairs"}, {"order"}):
            raise build_error("groups: expected groups and than, or pairs, or order")
        if any(len(pair) != 2 for pair in self.pairs or []):
            raise build_error("pairs: expected a list of [group, other group]")
        with_itself(self.compared, max(named))
        return self

    @property
    def compared(self) -> list[tuple]:
        """A group and the one that it is compared with, of each comparison."""
        tiers = self.order or [self.groups or [], self.than or []]
        of_tiers = [itertools.product(*both) for both in itertools.pairwise(tiers)]
        return [*(self.pairs or []), *itertools.chain.from_iterable(of_tiers)]


def cells(check: Options, rows: pd.DataFrame) -> Iterator[tuple[Terms, list]]:
    """Each pair, or each group paired with each of the others, or of the next tier."""
    for group, other in check.compared:
        yield Terms(group, f"{check.direction} than", other), [group, other]


def find(check: OfRuns, comparison: Contrast, name: str) -> Finding:
    """Test whether the first cell is lower (higher) than the second."""
    ours = effects.of_ours(check, comparison)
    n, reason = effects.units(comparison), effects.too_few(comparison)
    if reason:
        return Finding(effect=ours, n=n, mark="?", reason=reason)
    if effects.point_statistic(check) in WITHOUT_INTERVAL:
        finding = effects.by_draws(check, comparison, name)
        return finding if abs(ours) >= finding.margin else finding._replace(mark="?")
    side, least = effects.SIDES[check.direction], check.least
    margin = effects.margin_of(check, comparison)
    draws = effects.drawn_effects(check, comparison, name)
    low, high = effects.interval(draws)
    toward = np.sign(side * ours - least)
    if not least and abs(ours) < margin:
        toward = 0
    (stratum, *others) = comparison.strata.values()
    group, reference = effects.counted(stratum, comparison.paired)
    named = check.statistic
    if others or named not in (None, "rank", "mean") or (comparison.boolean and least):
        p = effects.two_sided(side * draws - least)
    elif comparison.boolean:
        p = _boolean_test(group, reference, comparison.paired)
    elif named == "mean":
        p = _t_test(
            *_shifted(check, *effects.finite(stratum, comparison.paired)), comparison.paired
        )
    else:
        p, ranked = rank_test(*_shifted(check, group, reference), comparison.paired)
        # The means must differ in the direction of the ranks, unless some values have no mean.
        toward = side * ranked if np.isinf(stratum).any() or toward == side * ranked else 0
    infinite = any(np.isinf(each).any() for each in comparison.strata.values())
    if not (math.isfinite(ours) or infinite):
        p = math.nan
    size_name, size = _effect_size(check, comparison, side, ours)
    finding = Finding(ours, size_name, size, low, high, n, p, int(np.nan_to_num(toward)), margin)
    reason = effects.why_none(p) or ("" if toward else effects.no_difference(low, high, n))
    negligible = not infinite and effects.is_negligible(low, high, margin, n, side * least)
    finding = finding._replace(negligible=negligible, reason=reason)
    return _without_p(finding) if ours and _are_constant(comparison) else finding


def _are_constant(comparison: Contrast) -> bool:
    """Whether each cell has one and the same number in all its units, in every condition."""
    cells = [
        values
        for stratum in comparison.strata.values()
        for values in effects.counted(stratum, comparison.paired)
    ]
    return not comparison.boolean and all(
        np.isfinite(values).all() and np.ptp(values) == 0 for values in cells
    )


def _without_p(finding: Finding) -> Finding:
    """The finding on two constants that differ, with the mark that its p gives, and no p: nothing
    varies by chance.
    """
    reason = finding.reason or "both are constant, so there is no p"
    return finding._replace(mark=verdicts.mark(finding, finding.p), p=math.nan, reason=reason)


def _t_test(group: np.ndarray, reference: np.ndarray, paired: bool) -> float:
    """p of two means; of the ranks if values without spread leave t undefined."""
    from scipy import stats

    spread = (group - reference).std() if paired else group.std() + reference.std()
    if spread <= 1e-12 * max(np.abs(group).max(), np.abs(reference).max(), 1e-300):
        return rank_test(group, reference, paired)[0]
    # scipy warns of a sample that is constant, as a count that settings fix: its variance is 0.
    with warnings.catch_warnings(action="ignore", category=RuntimeWarning):
        test = (
            stats.ttest_rel(group, reference)
            if paired
            else stats.ttest_ind(group, reference, equal_var=False)
        )
    return float(test.pvalue)


def _shifted(
    check: OfRuns, group: np.ndarray, reference: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Values of both groups, the other's shifted by the claimed least effect; infinite ones
    replaced by a value beyond any difference.
    """
    finite = np.concatenate([values[np.isfinite(values)] for values in (group, reference)])
    worst = finite.max() + 2 * np.ptp(finite) + 1
    group, reference = (np.where(np.isinf(values), worst, values) for values in (group, reference))
    move = effects.SIDES[check.direction] * check.least
    return group, reference * (1 + move) if check.relative else reference + move


def _boolean_test(group: np.ndarray, reference: np.ndarray, paired: bool) -> float:
    """McNemar's exact p for pairs of booleans, Fisher's for two groups."""
    from scipy import stats

    if paired:
        more, fewer = int(np.sum(group > reference)), int(np.sum(group < reference))
        return float(stats.binomtest(more, more + fewer).pvalue) if more + fewer else 1.0
    return float(stats.fisher_exact(_contingency(group, reference)).pvalue)


def _contingency(group: np.ndarray, other: np.ndarray) -> list[list[int]]:
    return [[int(values.sum()), int(len(values) - values.sum())] for values in (group, other)]


def _effect_size(check: OfRuns, comparison: Contrast, side: int, ours: float) -> tuple[str, float]:
    """Name and value: odds ratio of booleans; A12, the share of pairs won in the claimed direction;
    or the difference itself.
    """
    pairs = [effects.counted(stratum, comparison.paired) for stratum in comparison.strata.values()]
    if comparison.boolean and len(pairs) == 1:
        ((group, other),) = pairs
        if comparison.paired:
            odds = np.array([np.sum(group > other), np.sum(group < other)], dtype=float)
        else:
            (a, b), (c, d) = _contingency(group, other)
            odds = np.array([a * d, b * c], dtype=float)
        with np.errstate(divide="ignore", invalid="ignore"):
            return "odds ratio", float(odds[0] / odds[1])
    if effects.point_statistic(check) not in ("mean", "median"):
        return "difference", ours
    if comparison.paired:
        won = [np.mean((group > other) + 0.5 * (group == other)) for group, other in pairs]
    else:
        won = [wins(group, other) for group, other in pairs]
    return "A12", float(np.mean(won)) if side > 0 else 1 - float(np.mean(won))
