"""The share of runs in which an event happens.

Exact binomial test with the Clopper-Pearson interval; for six or more pooled conditions, Student's
t over their shares. For `all`, `none` and `some`, one (counter)example decides; `as printed` is
refuted where an experiment of the paper's size is unlikely to have the event in all its runs. The
effect is the share.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis.claims import effects
from bezierplan.analysis.claims.check import POOL, Columns, Failures, OfRuns
from bezierplan.analysis.claims.effects import Contrast, Finding, Terms
from bezierplan.analysis.metrics import METRICS
from bezierplan.analysis.statistics import LEAST_RUNS
from bezierplan.schema.model import Metric, Model, Number, build_error, build_value_type, is_number

if TYPE_CHECKING:
    import pandas as pd


class LowestRun(Model):
    """The choice of one feasible run for each condition and method."""

    lowest: Metric = Field(description="the name of a metric")


class Options(OfRuns):
    pool: Columns = Field([], description=POOL)
    event: dict[Literal["below", "above", "at_most", "at_least"], Number] = Field(
        None,
        min_length=1,
        max_length=1,
        description="one of {below: number}, above, at_most, at_least; left out for a metric that "
        "is true or false",
    )
    threshold: build_value_type(
        lambda given: (
            given in ("all", "none", "some", "as printed")
            if isinstance(given, str)
            else is_number(given) and 0 <= given <= 1
        ),
        "",
    ) = Field(
        description="a share from 0 to 1, or all, none, some, or as printed: in all runs of an "
        "experiment as large as the paper's"
    )
    direction: Literal["at_least", "at_most"] = Field(
        None, description="at_least or at_most, where the threshold is a number"
    )
    failures: Failures = "drop"
    pick: LowestRun = Field(
        None, description="{lowest: metric}: one feasible run of each condition and method"
    )

    @model_validator(mode="after")
    def _check_keys(self) -> Options:
        """Refuse a direction beside a threshold in words, a number without one, and a metric that
        is neither true nor false if there is no event.
        """
        if isinstance(self.threshold, str) != (self.direction is None):
            needed = (
                "has no direction" if self.direction else "needs a direction, at_least or at_most"
            )
            raise build_error(f"threshold: {self.threshold}: {needed}")
        metric = METRICS.get(self.metric)
        if metric and self.event is None and (metric.unit != "-" or metric.step is None):
            raise build_error(
                f"event: missing key; {self.metric} is no truth: expected one of below, above, "
                "at_most, at_least"
            )
        return self

    def list_cells(self, rows: pd.DataFrame) -> Iterator[tuple[Terms, list]]:
        """Yield one cell, that of all runs."""
        event = " ".join(map(str, self.limit or ()))
        yield Terms(event, " ".join(filter(None, ["in", self.direction])), self.threshold), [""]

    def compute_effect(self, points: np.ndarray, cells: tuple) -> np.ndarray:
        """Return the share itself."""
        return points[..., 0]

    def is_as_claimed(self, effects: np.ndarray, margin: float) -> np.ndarray:
        """Return whether the share is on the claimed side of the threshold."""
        match self.threshold:
            case "all" | "as printed":
                return effects == 1
            case "none":
                return effects == 0
            case "some":
                return effects > 0
        return self.side * (effects - self.threshold) >= 0

    def find(self, comparison: Contrast, name: str) -> Finding:
        """Test the share of units in which the event happens. Raises ValueError for values other
        than true and false.
        """
        from scipy import stats

        happened = np.concatenate([cell for (cell,) in comparison.list_values()])
        n, k = len(happened), int(happened.sum())
        if not n:
            return Finding(mark="?", reason="no run counts")
        if not np.isin(happened, (0.0, 1.0)).all():
            raise ValueError(
                f"{name}: {self.metric} has values other than true and false; its check needs an "
                "event"
            )
        finding = Finding(k / n, n=n)
        # The sentence is about these runs alone, so it holds or does not: nothing is tested.
        if self.pick:
            return finding._replace(
                mark="+" if self.is_as_claimed(finding.effect, math.nan) else "-"
            )
        exact = stats.binomtest(k, n).proportion_ci(method="exact")
        finding = finding._replace(low95=float(exact.low), high95=float(exact.high))
        if isinstance(self.threshold, str):
            return _judge_by_example(self, finding, comparison.paper_units)
        if n < LEAST_RUNS:
            return finding._replace(mark="?", reason=f"fewer than {LEAST_RUNS} units")
        threshold, side = self.threshold, self.side
        if len(comparison.strata) >= LEAST_RUNS:
            return _test_over_conditions(finding, comparison, threshold, side)
        # Twice the smaller tail, the test that corresponds to the Clopper-Pearson interval.
        p = min(
            1.0,
            2 * float(min(stats.binom.cdf(k, n, threshold), stats.binom.sf(k - 1, n, threshold))),
        )
        return finding._replace(p=p, toward=int(side * np.sign(k / n - threshold)))


def _judge_by_example(check: Options, finding: Finding, paper_units: int | None) -> Finding:
    """Judge a share by examples and return the finding.

    For `some`, one example decides and many misses are needed to refute it; for `all` and `none` it
    is the other way round. `as printed` is judged by chance where the paper's number of units is
    known.
    """
    if check.threshold == "as printed" and paper_units:
        low, chance, high = (
            share**paper_units for share in (finding.low95, finding.effect, finding.high95)
        )
        # Refuted if all of the paper's runs are unlikely to have the event even at the upper end.
        mark = "+" if low > effects.ALPHA else "-" if high < effects.ALPHA else "?"
        reason = f"the chance of {paper_units} of {paper_units} is {chance:.2g}"
        return finding._replace(mark=mark, reason=reason)
    holds = bool(check.is_as_claimed(finding.effect, math.nan))
    if holds == (check.threshold == "some") or finding.n >= effects.LEAST_WITHOUT_EXAMPLE:
        return finding._replace(mark="+" if holds else "-")
    return finding._replace(mark="?", reason=f"fewer than {effects.LEAST_WITHOUT_EXAMPLE} runs")


def _test_over_conditions(
    finding: Finding, comparison: Contrast, threshold: float, side: int
) -> Finding:
    """Test the shares of random conditions, such as layouts, by Student's t. Conditions are the
    units, because runs of one are alike.
    """
    from scipy import stats

    known = [each for each in comparison.strata.values() if not np.isnan(each).all()]
    shares = np.array([np.nanmean(stratum) for stratum in known])
    mean = float(shares.mean())
    toward = int(np.sign(side * (mean - threshold)))
    finding = finding._replace(effect=mean, n=len(shares), toward=toward)
    # Student's t is undefined without spread.
    if not np.ptp(shares):
        return finding._replace(low95=mean, high95=mean, p=0.0 if toward else 1.0)
    test = stats.ttest_1samp(shares, threshold)
    low, high = (float(np.clip(end, 0, 1)) for end in test.confidence_interval(0.95))
    return finding._replace(low95=low, high95=high, p=float(test.pvalue))
