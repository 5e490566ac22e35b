"""One file per kind of test.

Every file has `Options`, the keys that a check of this kind may have. A kind that judges runs (its
`Options` are `OfRuns`) also has

- `EFFECT`: how an effect follows from the point values of the cells: an `effects.Effect`
- `cells(check, rows)`: the cells of each comparison, with its name in words, among the runs of one
  place
- `find(check, comparison, name)`: the `effects.Finding` of a comparison; all random draws are
  seeded by the name

and any other kind `findings(check, claim, material)`: condition, name and finding of each
comparison; it raises `Untestable` if there is nothing to judge. A check is an instance of its
kind's `Options`. All p are two-sided and all intervals 95 %, by bootstrap over units within each
condition; above `statistics.MOST_RESAMPLED` units by its normal approximation.

Options are read at every start of the workflow, so these files import scipy and pandas inside the
functions that need them.
"""

import importlib
import itertools
import math
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, PrivateAttr, model_validator

from bezierplan.schema.model import (
    LONGEST_LINE,
    Column,
    Experiment,
    Line,
    Metric,
    Model,
    Positive,
    Where,
    is_line,
    is_number,
    listed,
    mapping_or,
    one_or_list,
    value,
    wrong,
)

Group = Annotated[
    str | float,
    value(
        lambda given: is_line(given, LONGEST_LINE) or is_number(given),
        "a value of the column `across`, or rest",
    ),
]
Groups = listed(Group)
Columns = listed(Column)


class PublishedMargin(Model):
    """A share of the other group's value, or the printed difference of the same cells if it is
    smaller.
    """

    published: Positive = Field(
        description="the share of the other group's value, a number above 0"
    )


Margin = Annotated[Any, mapping_or(PublishedMargin, Positive)]

# Descriptions of keys shared by several kinds of check.
SECONDARY = "true: shown, but not counted for the verdict; left out otherwise"
EXPERIMENT = "the name of an experiment, or a list of at least two"
PAIRED = (
    "whether equal units are compared with each other, true or false; left out: as the "
    "experiment is drawn"
)
SCALE = "absolute (left out: this), or relative to the value of the other group"
MARGIN = (
    "the smallest effect that matters: a number above 0, or {published: share}, that share of the "
    "other group's value (the share itself for a metric that is true or false), or the printed "
    "difference of the same cells if it is smaller"
)
WORK = (
    "the metric of counted work that is judged instead of seconds, which differ from machine "
    "to machine and are only reported"
)
TOGETHER = (
    "true: a sentence such as `the best of all`, whose comparisons at one place (one combination "
    "of `every`) make one mark: + if all "
    "are +, - if any is -; they are shown as secondary ones; left out otherwise"
)
POOL = "a list of columns whose values are averaged with equal weight"
GROUPS = (
    "a list of values of the column `across`, or rest: the artefact's groups that are not named"
)
THAN = "likewise: what the groups are compared with, each with each"
SIDE = "lower or higher: how the groups, or the first tier, compare with the others"
STATISTIC = (
    "the statistic that is compared: rank (left out: this), mean, median, iqr, range, min or max"
)
FAILURES = (
    "what a run without a feasible path counts: drop (left out: this), last (worse than any "
    "success; also runs that do not satisfy a "
    "condition on an outcome) or count (the event is false)"
)

# Keys that hold groups: lists of them, and lists of such lists.
GROUP_KEYS = ("groups", "than", "pairs", "order")


class Check(Model):
    """A check of any kind, with defaults for keys that other modules ask for.

    of_printed: whether the kind judges the printed numbers themselves. against: whether it compares
    one group with another. cells_key: the key that names the column whose values are compared, if
    any.
    """

    of_printed: ClassVar[bool] = False
    against: ClassVar[bool] = False
    cells_key: ClassVar[str | None] = None

    test: Line = Field(description="the name of a file in `src/bezierplan/analysis/claims/kinds`")

    _reported: bool = PrivateAttr(False)

    def _asked(self, key: str) -> Any:
        """The value of a key that only some kinds have: as written, or its default; None for a kind
        without it.
        """
        return getattr(self, key) if key in type(self).model_fields else None

    @property
    def primary(self) -> bool:
        """Whether it counts for the verdict."""
        return not (self._reported or self._asked("secondary"))

    def reported(self) -> Self:
        """The same check as one that is only shown."""
        check = self.but()
        check._reported = True
        return check

    @property
    def measured(self) -> str:
        """The metric that it is about; empty if there is none."""
        return self._asked("metric") or ""

    @property
    def effect_in(self) -> str:
        """The unit of its effect, if the check states it; empty where it follows from the
        metric.
        """
        return self._asked("effect_unit") or ""

    @property
    def statistic_written(self) -> str:
        """The statistic, if one is written."""
        return self._asked("statistic") if "statistic" in self.model_fields_set else ""

    @property
    def statistic_shown(self) -> str:
        """The statistic that is compared; empty for a kind without a choice."""
        return self._asked("statistic") or "rank" if "statistic" in type(self).model_fields else ""

    @property
    def relative(self) -> bool:
        """Whether effects are relative to the value of the other group."""
        return self._asked("scale") == "relative"

    @property
    def claimed_difference(self) -> float:
        """The difference that the sentence claims."""
        return self._asked("target") or 0

    @property
    def experiments(self) -> list[str]:
        """Experiments whose runs are judged."""
        return one_or_list(self._asked("experiment") or [])

    @property
    def cells(self) -> str | None:
        """The column whose values are compared, if any."""
        return getattr(self, self.cells_key) if self.cells_key else None

    @property
    def groups_named(self) -> list:
        """All groups that the check names."""
        lists = [one_or_list(each) for key in GROUP_KEYS for each in self._asked(key) or []]
        return list(itertools.chain.from_iterable(lists))


def with_itself(pairs: Iterable[tuple[Any, Any]], key: str) -> None:
    """Raise the error of a check that compares a group with itself."""
    for group, other in pairs:
        if group == other:
            raise wrong(f"{key}: {group}: is compared with itself; expected another group")


class OfRuns(Check):
    """Checks of runs. What only some kinds have is neutral in the others: no groups pooled, no
    least effect, failed runs dropped.
    """

    experiment: listed(Experiment, least=2, single=True) = Field(description=EXPERIMENT)
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
        "repeat", description="the column that numbers independent replicates; left out: repeat"
    )

    @model_validator(mode="after")
    def _check_columns(self) -> "OfRuns":
        """A column is either compared, or told apart, or averaged, or numbers replicates."""
        named = {
            key: one_or_list(getattr(self, key, None) or [])
            for key in ("every", "pool", self.cells_key, "replicate")
            if key
        }
        owners: dict[str, str] = {}
        for key, columns in named.items():
            for column in columns:
                if column in owners:
                    raise wrong(
                        f"{key}: {column}: is in {owners[column]} already; "
                        "expected it in one of the two"
                    )
                owners[column] = key
        return self

    _printed_metric: str = PrivateAttr("")

    @property
    def printed_metric(self) -> str:
        """The metric of the printed numbers: seconds, where counted work is judged in their
        place.
        """
        return self._printed_metric or self.metric

    @property
    def judges_work(self) -> bool:
        """Whether counted work is judged in place of seconds."""
        return bool(self._printed_metric)

    @property
    def counted_work(self) -> str | None:
        """The metric that is judged in place of seconds."""
        return self._asked("work")

    def of_work(self) -> Self:
        """The check of counted work in place of seconds."""
        check = self.but(metric=self.counted_work)
        check._printed_metric = self.metric
        return check

    @property
    def statistic_named(self) -> str | None:
        """The statistic that is compared, or rank; None if the kind decides."""
        return self._asked("statistic")

    @property
    def least_margin(self) -> float | PublishedMargin:
        """The smallest effect that matters; not a number for a kind without one."""
        return math.nan if (margin := self._asked("margin")) is None else margin

    @property
    def least_claimed(self) -> float:
        """The least effect that the sentence claims."""
        return self._asked("least") or 0

    @property
    def side(self) -> str | None:
        """How groups compare by the sentence; None if it does not say."""
        return self._asked("direction")

    @property
    def pooled(self) -> list[str]:
        """Columns whose values are averaged."""
        return self._asked("pool") or []

    @property
    def is_together(self) -> bool:
        """Whether the comparisons at one place make one mark."""
        return bool(self._asked("together"))

    @property
    def pairs_units(self) -> bool | None:
        """Whether equal units are compared with each other; None: as the experiment is drawn."""
        return self._asked("paired")

    @property
    def failed_runs(self) -> str:
        """What a run without a feasible path counts."""
        return self._asked("failures") or "drop"

    @property
    def limit(self) -> tuple[str, float] | None:
        """The event whose share is taken, such as `below` and a number, if it is not the metric
        itself.
        """
        return event.limit if (event := self._asked("event")) else None

    @property
    def picks(self) -> dict[str, str] | None:
        """The one run of each condition and method that is judged, as `results.pick` takes it;
        None: all.
        """
        return pick.plain() if (pick := self._asked("pick")) else None


class Comparing(OfRuns):
    """Checks that compare groups."""

    cells_key: ClassVar[str | None] = "across"

    across: Column = Field(
        "method", description="the column whose values are the groups; left out: method"
    )
    scale: Literal["absolute", "relative"] = Field("absolute", description=SCALE)
    margin: Margin = Field(description=MARGIN)


def kind_of(check: Check) -> ModuleType:
    """The file of a check's kind of test."""
    return importlib.import_module(f"{__name__}.{check.test}")


def check_of(given: dict[str, Any]) -> Check:
    """The check of a job, from its plain values."""
    return kinds()[given["test"]].model_validate(given)


@cache
def kinds() -> dict[str, type[Check]]:
    """Kind of test -> the options of its checks."""
    names = sorted(file.stem for file in Path(__file__).parent.glob("[!_]*.py"))
    return {name: importlib.import_module(f"{__name__}.{name}").Options for name in names}
