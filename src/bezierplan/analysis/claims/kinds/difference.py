"""Whether groups differ at all.

The effect is the range of the means, tested by Friedman's test (paired; Kendall's W), otherwise by
the Kruskal-Wallis test (epsilon squared). Of two groups, `lower` says more.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from pydantic import Field

from bezierplan.analysis.claims import effects
from bezierplan.analysis.claims.check import PAIRED, Comparing, Group
from bezierplan.analysis.claims.effects import Comparison, Finding
from bezierplan.schema.model import Flag, listed

if TYPE_CHECKING:
    import pandas as pd


class Options(Comparing):
    paired: Flag = Field(None, description=PAIRED)
    groups: listed(Group, least=3) = Field(
        description="a list of at least three values of the column `across`"
    )


def cells(check: Options, rows: pd.DataFrame) -> Iterator[tuple[str, list]]:
    """All groups as the cells of one comparison."""
    yield ", ".join(map(str, check.groups)), check.groups


def _range(check: Options, points: np.ndarray, cells: tuple) -> np.ndarray:
    """The range of the groups, relative to their mean if so asked."""
    return np.ptp(points, axis=-1) / (points.mean(axis=-1) if check.relative else 1)


EFFECT = effects.Effect(
    _range, lambda check, ours, cells: None, lambda check, values, margin: np.abs(values) >= margin
)


def find(check: Options, comparison: Comparison, name: str) -> Finding:
    """Test whether the cells differ at all."""
    from scipy import stats

    ours = effects.of_ours(check, comparison)
    n, reason = effects.units(comparison), effects.too_few(comparison)
    if reason:
        return Finding(effect=ours, n=n, mark="?", reason=reason)
    (stratum,) = comparison.strata.values()
    groups = effects.counted(stratum, comparison.paired)
    total = sum(map(len, groups))
    low, high = effects.interval(effects.drawn_effects(check, comparison, name))
    margin = effects.margin_of(check, comparison)
    if comparison.paired:
        same = all(np.ptp(values) == 0 for values in zip(*groups))
        tested = None if same else stats.friedmanchisquare(*groups)
        size_name, largest = "Kendall's W", n * (len(groups) - 1)
    else:
        tested = None if np.ptp(np.concatenate(groups)) == 0 else stats.kruskal(*groups)
        size_name, largest = "epsilon squared", total - 1
    size, p = (float(tested.statistic / largest), float(tested.pvalue)) if tested else (0.0, 1.0)
    return Finding(
        *(ours, size_name, size, low, high, n, p),
        toward=int(ours >= margin),
        margin=margin,
        negligible=effects.is_negligible(low, high, margin, n),
        reason=effects.no_difference(low, high, n),
    )
