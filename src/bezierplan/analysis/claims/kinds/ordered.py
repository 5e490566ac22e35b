"""Tiers of groups, each lower, or higher, than the next: every group is compared with every one of
the next tier, as in `lower`.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, Literal

from pydantic import Field, model_validator

from bezierplan.analysis.claims.effects import BETWEEN_GROUPS, pairs_in_words
from bezierplan.analysis.claims.kinds import (
    PAIRED,
    SECONDARY,
    SIDE,
    STATISTIC,
    TOGETHER,
    Comparing,
    Group,
    lower,
    with_itself,
)
from bezierplan.schema.model import Flag, listed

if TYPE_CHECKING:
    import pandas as pd

EFFECT = BETWEEN_GROUPS
find = lower.find


class Options(Comparing):
    against: ClassVar[bool] = True

    secondary: Literal[True] = Field(None, description=SECONDARY)
    paired: Flag = Field(None, description=PAIRED)
    order: listed(listed(Group), least=2) = Field(
        description="tiers, the best first: a list of lists of groups"
    )
    direction: Literal["lower", "higher"] = Field(description=SIDE)
    statistic: Literal["rank", "mean", "median", "iqr", "range", "min", "max"] = Field(
        "rank", description=STATISTIC
    )
    together: Literal[True] = Field(None, description=TOGETHER)

    @model_validator(mode="after")
    def _check_order(self) -> Options:
        for number, tier in enumerate(self.order):
            for other in self.order[:number]:
                with_itself(itertools.product(tier, other), "order")
        return self


def cells(check: Options, rows: pd.DataFrame) -> Iterator[tuple[str, list]]:
    """Each group paired with each of the next tier."""
    tiers = itertools.pairwise(check.order)
    pairs = itertools.chain.from_iterable(
        itertools.product(better, worse) for better, worse in tiers
    )
    return pairs_in_words(pairs, f"{check.direction} than")
