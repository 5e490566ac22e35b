"""Test whether the metric rises, or falls, with a numeric column.

The effect is the change from the lowest to the highest x, the effect size the least-squares slope.
Wilcoxon's signed ranks test the slopes of the units against 0; with `statistic: std`, the spread of
each condition, a bootstrap does.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from bezierplan.analysis import statistics
from bezierplan.analysis.claims import effects
from bezierplan.analysis.claims.check import WithMargin, Work
from bezierplan.analysis.claims.effects import Contrast, Finding, Terms
from bezierplan.analysis.claims.ranks import compute_p_of_signed_ranks
from bezierplan.analysis.statistics import LEAST_RUNS
from bezierplan.schema.model import NumberColumn
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    import pandas as pd


# Decimals of a slope as a share of the steepest.
_DIGITS = 12


class Options(WithMargin):
    cells_key = "x"

    x: NumberColumn = Field(description="a column of numbers along which the metric changes")
    direction: Literal["up", "down"] = Field(description="up or down")
    statistic: Literal["std"] = Field(
        None, description="std: the spread of each condition; left out: the values themselves"
    )
    work: Work = None

    def list_cells(self, rows: pd.DataFrame) -> Iterator[tuple[Terms, list]]:
        """Yield one comparison of all values of x, rising."""
        yield Terms(self.x, self.direction), sorted(rows[self.x].dropna().unique())

    # Relative to zero, an effect is not finite: `effects.explain_missing` says so later.
    @np.errstate(divide="ignore", invalid="ignore")
    def compute_effect(self, points: np.ndarray, cells: tuple) -> np.ndarray:
        """Compute the change from the lowest x to the highest; if relative, as a share of the value
        at the lowest.
        """
        change = points @ _compute_weights(cells)
        return change / points[..., 0] if self.relative else change

    def compute_gradient(self, ours: np.ndarray, cells: tuple) -> np.ndarray | None:
        """Compute how the change depends on the value at each x (k,); None if relative to zero."""
        reference = ours[0] if self.relative else 1.0
        return _compute_weights(cells) / reference if reference else None

    def find(self, comparison: Contrast, name: str) -> Finding:
        """Test whether a metric changes with x as claimed. name: seeds the draws."""
        x = np.array(comparison.cells, dtype=float)
        (stratum,) = comparison.strata.values()
        slopes = _compute_slopes(x, stratum)
        n, statistic = len(slopes), self.point_statistic
        if n < LEAST_RUNS:
            reason = f"fewer than {LEAST_RUNS} units with at least 3 values of {self.x}"
            return Finding(n=n, mark="?", reason=reason)
        # A unit counts wherever it has a value, even if not at every x.
        comparison = comparison._replace(paired=False)
        ours = effects.compute_points(comparison, statistic)
        if statistic == "mean":
            reference = ours[0] if self.relative else 1.0
            changes = slopes * np.ptp(x) / (reference or math.nan)
            change = float(changes.mean())
            low, high = statistics.compute_interval("mean", changes, generator(name))
            p = compute_p_of_signed_ranks(slopes)
        else:
            change = float(self.compute_effect(ours, comparison.cells))
            draws = effects.draw_effects(self, comparison, name)
            low, high = effects.compute_interval_of_draws(draws)
            p = effects.compute_p(draws)
        margin = effects.compute_margin(self, comparison)
        toward = int(np.sign(self.side * np.nan_to_num(change)))
        toward = 0 if abs(change) < margin else toward
        negligible = effects.is_negligible(low, high, margin, n)
        finding = Finding(change, low, high, n, p, toward, margin, negligible)
        reason = effects.explain_missing(change) or effects.explain_no_difference(low, high, n)
        return finding._replace(reason=reason)


def _compute_weights(x: Sequence[float]) -> np.ndarray:
    """Compute the weights (k,) of values over x (k) that give least-squares slope times range of x;
    NaN for a single x.
    """
    from_mean = np.array(x, dtype=float) - np.mean(x)
    return from_mean / (from_mean**2).sum() * np.ptp(x)


def _compute_slopes(x: np.ndarray, stratum: np.ndarray) -> np.ndarray:
    """Compute the least-squares slopes over x of units with finite values at 3 or more values of x.

    They are ranked, so those that should be equal, or zero, must not differ by how a processor
    rounds: slopes are rounded to a share of the steepest, and a constant has none.
    """
    slopes = []
    for values in stratum[np.isfinite(stratum).sum(axis=1) >= 3]:
        there = np.isfinite(values)
        rises = values[there] - values[there][0]
        slopes.append((_compute_weights(x[there]) * rises).sum() / np.ptp(x[there]))
    steepest = np.abs(slopes).max(initial=0.0) or 1.0
    return np.round(np.divide(slopes, steepest), _DIGITS) * steepest
