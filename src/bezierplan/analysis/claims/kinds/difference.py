"""Whether groups differ at all.

The effect is the range of the means. Two groups are tested as in `lower`; more by Friedman's test
(paired; Kendall's W), otherwise by the Kruskal-Wallis test (epsilon squared).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from bezierplan.analysis.claims.effects import (
    BETWEEN_GROUPS,
    Comparison,
    Finding,
    counted,
    drawn_effects,
    effect,
    interval,
    is_negligible,
    least_detectable,
    margin_of,
    no_difference,
    points,
    too_few,
    units,
)
from bezierplan.analysis.claims.kinds import PAIRED, SECONDARY, Comparing, Group, lower
from bezierplan.schema.model import Flag, listed

if TYPE_CHECKING:
    import pandas as pd


class Options(Comparing):
    secondary: Literal[True] = Field(None, description=SECONDARY)
    paired: Flag = Field(None, description=PAIRED)
    groups: listed(Group, least=2) = Field(
        description="a list of at least two values of the column `across`"
    )


def cells(check: Options, rows: pd.DataFrame) -> Iterator[tuple[str, list]]:
    """All groups as the cells of one comparison."""
    yield ", ".join(map(str, check.groups)), check.groups


def _range(check: Options, points: np.ndarray, cells: tuple) -> np.ndarray:
    """The range of more than two groups, relative to their mean if so asked; the difference of
    two.
    """
    if len(cells) == 2:
        return BETWEEN_GROUPS.of(check, points, cells)
    return np.ptp(points, axis=-1) / (points.mean(axis=-1) if check.relative else 1)


def _gradient(check: Options, ours: np.ndarray, cells: tuple) -> np.ndarray | None:
    return BETWEEN_GROUPS.gradient(check, ours, cells) if len(cells) == 2 else None


EFFECT = BETWEEN_GROUPS._replace(
    of=_range, gradient=_gradient, claimed=lambda check, effects, margin: np.abs(effects) >= margin
)


def _of_pair(check: Options) -> lower.Options:
    """Whether the first of two groups is higher than the second, as a check."""
    same = {key: getattr(check, key) for key in Comparing.model_fields if key != "test"}
    return lower.Options.model_construct(
        test="lower", pairs=[check.groups], direction="higher", paired=check.paired, **same
    )


def find(check: Options, comparison: Comparison, name: str) -> Finding:
    """Test whether the cells differ at all."""
    from scipy import stats

    ours = float(effect(check, points(comparison, "mean"), comparison.cells))
    n, reason = units(comparison), too_few(comparison)
    if reason:
        return Finding(effect=ours, n=n, mark="?", reason=reason)
    if len(comparison.cells) == 2:
        found = lower.find(_of_pair(check), comparison, name)
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
        *(
            ours,
            size_name,
            float(tested.statistic / largest) if tested else 0.0,
            low,
            high,
            n,
            float(tested.pvalue) if tested else 1.0,
        ),
        toward=int(ours >= margin),
        margin=margin,
        negligible=is_negligible(low, high, margin, n),
        least_detectable=least_detectable(low, high, n),
        reason=no_difference(low, high, n),
    )
