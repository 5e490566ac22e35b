"""Whether two groups differ by no more than the margin.

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
from bezierplan.analysis.claims.check import GROUPS, THAN, Comparing, Groups, with_itself
from bezierplan.analysis.claims.effects import Contrast, Finding, Terms
from bezierplan.analysis.statistics import WITHOUT_INTERVAL
from bezierplan.schema.model import Number

if TYPE_CHECKING:
    import pandas as pd


class Options(Comparing):
    groups: Groups = Field(description=GROUPS)
    than: Groups = Field(description=THAN)
    statistic: Literal["mean", "median", "min", "max"] = Field(
        description="the statistic that is compared: mean, median, min or max"
    )
    target: Number = Field(0, description="the claimed difference, a number; left out: 0")

    @model_validator(mode="after")
    def _check_groups(self) -> Options:
        with_itself(itertools.product(self.groups, self.than), "than")
        return self


def cells(check: Options, rows: pd.DataFrame) -> Iterator[tuple[Terms, list]]:
    """Each group paired with each of the others."""
    for group, other in itertools.product(check.groups, check.than):
        yield Terms(group, "as", other), [group, other]


def claimed(check: Options, values: np.ndarray, margin: float) -> np.ndarray:
    """Whether the effect, less the target, lies within the margin."""
    return np.abs(values - check.target) <= margin


EFFECT = effects.BETWEEN_GROUPS._replace(holds=claimed)


def find(check: Options, comparison: Contrast, name: str) -> Finding:
    """Two one-sided tests of whether two cells' difference, less the target, lies within the
    margin; p of being outside where it is.
    """
    ours = effects.of_ours(check, comparison)
    n, reason = effects.units(comparison), effects.too_few(comparison)
    if reason:
        return Finding(effect=ours, n=n, mark="?", reason=reason)
    if effects.point_statistic(check) in WITHOUT_INTERVAL:
        return effects.by_draws(check, comparison, name)
    margin = effects.margin_of(check, comparison)
    draws = effects.drawn_effects(check, comparison, name)
    low, high = effects.interval(draws)
    toward = 1 if bool(claimed(check, ours, margin)) else -1
    beyond = draws - check.target
    if math.isnan(low):
        p = math.nan
    elif toward > 0:
        p = float(max(np.mean(beyond <= -margin), np.mean(beyond >= margin)))
    else:
        inside = beyond <= margin if ours > check.target else beyond >= -margin
        p = min(1.0, 2 * float(np.mean(inside)))
    reason = effects.why_none(ours)
    return Finding(ours, "difference", ours, low, high, n, p, toward, margin, reason=reason)
