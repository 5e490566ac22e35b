"""The models of checks: what all kinds share, and what those share that judge runs.

A check is an instance of the `Options` of its kind (`kinds`).
"""

import math
from collections.abc import Iterable
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from bezierplan.analysis.metric import METRICS
from bezierplan.schema.model import (
    Column,
    ExperimentName,
    Line,
    Metric,
    Model,
    Positive,
    Where,
    build_error,
    build_list_type,
    build_mapping_type,
    build_value_type,
    convert_to_list,
    is_line,
    is_number,
)

SIDES = {"lower": -1, "higher": 1, "down": -1, "up": 1, "at_most": -1, "at_least": 1}
"""A claimed direction -> the sign of the effects that lie there."""

Group = build_value_type(
    lambda given: is_line(given) or is_number(given),
    "a value of the column `across`, or rest",
)
Columns = build_list_type(Column)


class PublishedMargin(Model):
    """A share of the other group's value, or the printed difference of the same cells if it is
    smaller.
    """

    published: Positive = Field(
        description="the share of the other group's value, a number above 0"
    )


# Types of keys shared by several kinds of check, with their descriptions.
Experiments = Annotated[
    build_list_type(ExperimentName, least=2, single=True),
    Field(description="the name of an experiment, or a list of at least two"),
]
Work = Annotated[
    Metric,
    Field(
        description="the metric of counted work that is judged instead of seconds, which differ "
        "from machine to machine and are only reported"
    ),
]
Groups = Annotated[
    build_list_type(Group),
    Field(
        description="a list of values of the column `across`; [rest] names the artefact's groups "
        "that are not named"
    ),
]
Than = Annotated[
    build_list_type(Group),
    Field(
        description="a list of what the groups are compared with, each with each, such as [rest]"
    ),
]
Failures = Annotated[
    Literal["drop", "last", "count"],
    Field(
        description="what a run without a feasible path counts: drop (left out: this), last (worse "
        "than any success; also runs that do not satisfy a condition on an outcome) or count (the "
        "event is false)"
    ),
]
POOL = "a list of columns whose values are averaged with equal weight"

# Keys that hold groups: lists of them, and lists of such lists.
GROUP_KEYS = ("groups", "than", "pairs", "order")

# The values of keys that only some kinds have, in all other kinds.
_NEUTRAL = dict.fromkeys(
    [*GROUP_KEYS, "statistic", "direction", "together", "paired", "event", "pick", "work"]
) | {
    "metric": "",
    "effect_unit": "",
    "scale": "absolute",
    "failures": "drop",
    "target": 0,
    "least": 0,
    "margin": math.nan,
    "experiment": [],
    "pool": [],
}


class ClaimCheck(Model):
    """A check of any kind. A key that only other kinds have is neutral.

    against: whether the kind compares one group with another. cells_key: the key that names the
    column whose values are compared, if any.
    """

    against: ClassVar[bool] = False
    cells_key: ClassVar[str | None] = None

    test: Line = Field(description="the name of a file in `src/bezierplan/analysis/claims/kinds`")
    secondary: Literal[True] = Field(
        None, description="true: shown, but not counted for the verdict; left out otherwise"
    )

    def __getattr__(self, key: str) -> Any:
        """Return the neutral value of a key that only other kinds have."""
        # Python asks here only for what the model lacks, so the keys of its own kind come first.
        return _NEUTRAL[key] if key in _NEUTRAL else super().__getattr__(key)

    @property
    def primary(self) -> bool:
        """Return whether it counts for the verdict."""
        return not self.secondary

    @property
    def timed(self) -> bool:
        """Return whether its metric is in seconds."""
        return METRICS[self.metric or ""].unit == "s"

    @property
    def relative(self) -> bool:
        """Return whether effects are relative to the value of the other group."""
        return self.scale == "relative"

    @property
    def experiments(self) -> list[str]:
        """Return the experiments whose runs are judged."""
        return convert_to_list(self.experiment or [])

    @property
    def cells(self) -> str | None:
        """Return the column whose values are compared, if any."""
        return getattr(self, self.cells_key) if self.cells_key else None

    @property
    def groups_named(self) -> list:
        """Return all groups that the check names."""
        return [
            group
            for key in GROUP_KEYS
            for each in getattr(self, key) or []
            for group in convert_to_list(each)
        ]


def refuse_same_group(pairs: Iterable[tuple[Any, Any]], key: str) -> None:
    """Raise the error of a check that compares a group with itself."""
    for group, other in pairs:
        if group == other:
            raise build_error(f"{key}: {group}: is compared with itself; expected another group")


class OfRuns(ClaimCheck):
    """The keys that all checks of runs share.

    reference: the cell to whose value an effect is relative.
    """

    reference: ClassVar[int] = 0

    experiment: Experiments
    metric: Metric = Field(description="the name of a metric")
    where: Where = Field(
        {},
        description="column of the runs table → value or list of values: the runs that are judged",
        min_length=1,
    )
    every: Columns = Field(
        [], description="a list of columns; one comparison for each combination of their values"
    )
    replicate: Column = Field(
        "repeat",
        description="the column that numbers independent replicates, whose runs are averaged "
        "before anything is asked of them; left out: repeat",
    )

    @model_validator(mode="after")
    def _check_columns(self) -> "OfRuns":
        """Check that each column has one part: compared, told apart, averaged, or the number of
        replicates.
        """
        named = {
            key: convert_to_list(getattr(self, key))
            for key in ("every", "pool", self.cells_key, "replicate")
            if key
        }
        owners: dict[str, str] = {}
        for key, columns in named.items():
            for column in columns:
                if column in owners:
                    raise build_error(
                        f"{key}: {column}: is in {owners[column]} already; "
                        "expected it in one of the two"
                    )
                owners[column] = key
        return self

    _printed_metric: str = PrivateAttr("")

    @property
    def printed_metric(self) -> str:
        """Return the metric of the printed numbers: seconds, where counted work is judged in their
        place.
        """
        return self._printed_metric or self.metric

    def use_work(self) -> Self:
        """Return the check of counted work in place of seconds."""
        check = self.but(metric=self.work)
        check._printed_metric = self.metric
        return check

    @property
    def limit(self) -> tuple[str, float] | None:
        """Return the event whose share is taken, such as `below` and a number, if it is not the
        metric itself.
        """
        return next(iter(self.event.items())) if self.event else None

    @property
    def side(self) -> int:
        """Return the sign of the effects on the claimed side."""
        return SIDES[self.direction]

    @property
    def point_statistic(self) -> str:
        """Return the statistic that represents a cell by one number."""
        return "mean" if self.statistic in (None, "rank") else self.statistic

    def is_as_claimed(self, effects: np.ndarray, margin: float) -> np.ndarray:
        """Tell which effects (...) point as claimed and exceed the claimed least effect, if any."""
        return self.side * effects > self.least


class WithMargin(OfRuns):
    """The keys of checks whose effect may be too small to matter."""

    scale: Literal["absolute", "relative"] = Field(
        "absolute",
        description="absolute (left out: this), or relative to the value of the other group",
    )
    margin: build_mapping_type(PublishedMargin, Positive) = Field(
        description="the smallest effect that matters: a number above 0, or {published: share}, "
        "that share of the other group's value (the share itself for a metric that is true or "
        "false), or the printed difference of the same cells if it is smaller"
    )


class Comparing(WithMargin):
    """The keys that all checks share that compare groups."""

    against = True
    cells_key = "across"
    reference = 1

    across: Column = Field(
        "method", description="the column whose values are the groups; left out: method"
    )
    pool: Columns = Field([], description=POOL)

    # Relative to zero, an effect is not finite: `effects.explain_missing` says so later.
    @np.errstate(divide="ignore", invalid="ignore")
    def compute_effect(self, points: np.ndarray, cells: tuple) -> np.ndarray:
        """Compute a group's value less the other's; if relative, as a share of the other's."""
        group, other = points[..., 0], points[..., 1]
        return group / other - 1 if self.relative else group - other

    def compute_gradient(self, ours: np.ndarray, cells: tuple) -> np.ndarray | None:
        """Compute how the effect changes with both values (2,); None if relative to zero."""
        if not self.relative:
            return np.array([1.0, -1.0])
        return np.array([1.0, -ours[0] / ours[1]]) / ours[1] if ours[1] else None
