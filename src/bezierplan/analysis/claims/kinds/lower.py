"""Test whether groups are lower, or higher, than others: each of some than each of others, or every
one of a tier than every one of the next.

| statistic | test |
| --- | --- |
| `rank` | Wilcoxon's signed ranks, Pratt's zeros (paired), Mann-Whitney |
| `rank` of booleans | McNemar's exact test (paired), Fisher's exact test |
| `mean` | Student's t of the differences (paired), Welch's t |
| any other, or several conditions | bootstrap |
| `min`, `max`, `range` | how often the sentence holds in draws of as many runs |

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
    GROUP_KEYS,
    Comparing,
    Failures,
    Group,
    Groups,
    OfRuns,
    Than,
    Work,
    refuse_same_group,
)
from bezierplan.analysis.claims.effects import Contrast, Finding, Terms
from bezierplan.analysis.claims.ranks import compare_ranks
from bezierplan.schema.model import Positive, build_error, build_list_type

if TYPE_CHECKING:
    import pandas as pd


class Options(Comparing):
    paired: bool = Field(
        None,
        description="whether equal units are compared with each other, true or false; left out: as "
        "the experiment is drawn",
    )
    groups: Groups = None
    than: Than = None
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
    work: Work = None
    failures: Failures = "drop"

    @model_validator(mode="after")
    def _check_groups(self) -> Options:
        """Refuse keys of groups that do not belong together, and a group that is compared with
        itself.
        """
        named = self.model_fields_set & set(GROUP_KEYS)
        if named not in ({"groups", "than"}, {"pairs"}, {"order"}):
            raise build_error("groups: expected groups and than, or pairs, or order")
        if any(len(pair) != 2 for pair in self.pairs or []):
            raise build_error("pairs: expected a list of [group, other group]")
        refuse_same_group(self.compared, max(named))
        return self

    @property
    def compared(self) -> list[tuple]:
        """Return the pairs that are compared: a group and the one beside it."""
        tiers = self.order or [self.groups or [], self.than or []]
        beside = itertools.pairwise(tiers)
        return [*(self.pairs or []), *(pair for two in beside for pair in itertools.product(*two))]

    def list_cells(self, rows: pd.DataFrame) -> Iterator[tuple[Terms, list]]:
        """Yield each pair: as written, or each group with each of the others, or of the next
        tier.
        """
        for group, other in self.compared:
            yield Terms(group, f"{self.direction} than", other), [group, other]

    def find(self, comparison: Contrast, name: str) -> Finding:
        """Test whether the first cell is lower (higher) than the second. name: seeds the draws."""
        finding, draws = effects.measure_effect(self, comparison, name)
        ours, n, margin = finding.effect, finding.n, finding.margin
        low, high = finding.low95, finding.high95
        if finding.mark:
            # Below the margin the sentence is open, however often it holds.
            return finding if abs(ours) >= margin else finding._replace(mark="?")
        side, least = self.side, self.least
        toward = np.sign(side * ours - least)
        # A claimed least effect takes the place of the margin.
        if not least and abs(ours) < margin:
            toward = 0
        (group, reference), *others = comparison.list_values()
        infinite = any(np.isinf(each).any() for each in comparison.strata.values())
        named = self.statistic
        # The tests below are for one condition, and for ranks, means or unshifted booleans.
        if others or named not in ("rank", "mean") or (comparison.boolean and least):
            p = effects.compute_p(side * draws - least)
        elif comparison.boolean:
            p = _compute_p_of_booleans(group, reference, comparison.paired)
        elif named == "mean":
            ((group, reference),) = comparison.list_values(finite=True)
            p = _compute_p_of_means(*_shift_other(self, group, reference), comparison.paired)
        else:
            p, ranked = compare_ranks(*_shift_other(self, group, reference), comparison.paired)
            # The means must differ in the direction of the ranks, unless some values have no mean.
            toward = side * ranked if infinite or toward == side * ranked else 0
        # An effect relative to zero has no p. Where failures rank last, ranks need no mean.
        if not (math.isfinite(ours) or infinite):
            p = math.nan
        reason = effects.explain_missing(p) or (
            "" if toward else effects.explain_no_difference(low, high, n)
        )
        negligible = not infinite and effects.is_negligible(low, high, margin, n, side * least)
        finding = finding._replace(
            p=p,
            # Without an effect this is nan, which `int` refuses.
            toward=int(np.nan_to_num(toward)),
            negligible=negligible,
            reason=reason,
        )
        if not ours or not _is_constant(comparison):
            return finding
        # Nothing varies by chance between two constants that differ: the mark stays, without p.
        return finding._replace(
            mark=verdicts.choose_mark(finding, p),
            p=math.nan,
            reason=reason or "both are constant, so there is no p",
        )


def _is_constant(comparison: Contrast) -> bool:
    """Return whether each cell has one and the same number in all its units, in every condition."""
    return not comparison.boolean and all(
        np.isfinite(values).all() and np.ptp(values) == 0
        for cells in comparison.list_values()
        for values in cells
    )


def _compute_p_of_means(group: np.ndarray, reference: np.ndarray, paired: bool) -> float:
    """Compute p of two means by Student's t; by ranks if values without spread leave t
    undefined.
    """
    from scipy import stats

    spread = (group - reference).std() if paired else group.std() + reference.std()
    # Equal values may differ in their last bits, so no spread is not exactly 0.
    if spread <= 1e-12 * max(np.abs(group).max(), np.abs(reference).max(), 1e-300):
        return compare_ranks(group, reference, paired)[0]
    # scipy warns of a sample that is constant, as a count that settings fix: its variance is 0.
    with warnings.catch_warnings(action="ignore", category=RuntimeWarning):
        test = (
            stats.ttest_rel(group, reference)
            if paired
            else stats.ttest_ind(group, reference, equal_var=False)
        )
    return float(test.pvalue)


def _shift_other(
    check: OfRuns, group: np.ndarray, reference: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Shift the other group's values by the claimed least effect, and replace infinite values of
    both by one beyond any difference.
    """
    finite = np.concatenate([values[np.isfinite(values)] for values in (group, reference)])
    # Ranks need the order alone.
    worst = finite.max() + 2 * np.ptp(finite) + 1
    group, reference = (np.where(np.isinf(values), worst, values) for values in (group, reference))
    move = check.side * check.least
    return group, reference * (1 + move) if check.relative else reference + move


def _compute_p_of_booleans(group: np.ndarray, reference: np.ndarray, paired: bool) -> float:
    """Compute p of booleans: McNemar's exact test for pairs, Fisher's for two groups."""
    from scipy import stats

    if paired:
        more, fewer = int(np.sum(group > reference)), int(np.sum(group < reference))
        return float(stats.binomtest(more, more + fewer).pvalue) if more + fewer else 1.0
    counts = [[values.sum(), len(values) - values.sum()] for values in (group, reference)]
    return float(stats.fisher_exact(np.array(counts, dtype=int)).pvalue)
