"""Test whether two groups differ by no more than the margin.

Two one-sided tests: the 90 % interval of the difference, less the target, lies within the margin.
Effect and effect size are the difference of the statistic that the check names.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis.claims import effects
from bezierplan.analysis.claims.check import Comparing, Groups, Than, refuse_same_group
from bezierplan.analysis.claims.effects import Contrast, Finding, Terms
from bezierplan.schema.model import Number

if TYPE_CHECKING:
    import pandas as pd


class Options(Comparing):
    groups: Groups
    than: Than
    statistic: Literal["mean", "median", "min", "max"] = Field(
        description="the statistic that is compared: mean, median, min or max"
    )
    target: Number = Field(0, description="the claimed difference, a number; left out: 0")

    @model_validator(mode="after")
    def _check_groups(self) -> Options:
        """Refuse a group that is compared with itself."""
        refuse_same_group(itertools.product(self.groups, self.than), "than")
        return self

    def list_cells(self, rows: pd.DataFrame) -> Iterator[tuple[Terms, list]]:
        """Yield each group paired with each of the others."""
        for group, other in itertools.product(self.groups, self.than):
            yield Terms(group, "as", other), [group, other]

    def is_as_claimed(self, effects: np.ndarray, margin: float) -> np.ndarray:
        """Return whether the effects, less the target, lie within the margin."""
        return np.abs(effects - self.target) <= margin

    def find(self, comparison: Contrast, name: str) -> Finding:
        """Test by two one-sided tests whether two cells' difference, less the target, lies within
        the margin.

        name: seeds the draws. p is that of lying outside where the effect lies within, and the
        other way round.
        """
        finding, draws = effects.measure_effect(self, comparison, name)
        if finding.mark:
            return finding
        ours, margin = finding.effect, finding.margin
        toward = 1 if self.is_as_claimed(ours, margin) else -1
        beyond = draws - self.target
        if math.isnan(finding.low95):
            p = math.nan
        elif toward > 0:
            p = float(max(np.mean(beyond <= -margin), np.mean(beyond >= margin)))
        else:
            inside = beyond <= margin if ours > self.target else beyond >= -margin
            p = min(1.0, 2 * float(np.mean(inside)))
        return finding._replace(p=p, toward=toward, reason=effects.explain_missing(ours))
