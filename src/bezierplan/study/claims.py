"""What `claims.yaml` and `assumptions.yaml` say: sentences of a paper as checks, and what a paper leaves open.

Each kind of check has its own keys; `CHECKS` names the kinds. What a kind does stands in `analysis.claim_tests`.
"""

from typing import Annotated, Any, Literal

from annotated_types import MinLen
from pydantic import Field, model_validator

from bezierplan.study.model import (
    Column,
    Experiment,
    Flag,
    Function,
    Line,
    Metric,
    Model,
    Name,
    Names,
    Number,
    Positive,
    Setting,
    Values,
    Where,
    is_number,
    listed,
    mapping_or,
    matching,
    one_of,
    one_or_list,
    value,
    wrong,
)

Group = Annotated[str | float, value(lambda given: isinstance(given, str) or is_number(given), "a value of the column `across`, or rest")]
Groups = listed(Group)
Columns = listed(Column)
ClaimId = Annotated[str, matching(r"^C[1-9][0-9]*$", "C and a number, such as C1")]


class PublishedMargin(Model):
    """A share of the other group's value, or the printed difference of the same cells if it is smaller."""

    published: Positive = Field(description="the share of the other group's value, a number above 0")


Margin = Annotated[Any, mapping_or(PublishedMargin, Positive)]


class Pick(Model):
    """One feasible run of each condition and method."""

    lowest: Metric = Field(description="the name of a metric")


class Event(Model):
    """What a share is the share of."""

    below: Number = Field(None, description="a number")
    above: Number = Field(None, description="a number")
    at_most: Number = Field(None, description="a number")
    at_least: Number = Field(None, description="a number")
    equals: Number = Field(None, description="a number")

    @model_validator(mode="after")
    def _check_one(self) -> "Event":
        if len(self.model_fields_set) != 1:
            raise wrong(f"{len(self.model_fields_set)} keys; expected one of below, above, at_most, at_least, equals")
        return self


# Descriptions of keys that several kinds of check have.
SECONDARY = "true: shown, does not decide; left out otherwise"
EXPERIMENT = "the name of an experiment, or a list of at least two"
PAIRED = "whether equal units are compared with each other, true or false; left out: as the experiment is drawn"
SCALE = "absolute (left out: this), or relative to the value of the other group"
MARGIN = (
    "the smallest effect that matters: a number above 0, or {published: share}, that share of the other group's value, or the printed "
    "difference of the same cells if it is smaller"
)
WORK = "the metric of counted work that decides in the place of seconds, which differ from machine to machine and are reported"
POOL = "a list of columns whose values are averaged with equal weight"
GROUPS = "a list of values of the column `across`, or rest: the artefact's groups that are not named"
THAN = "likewise: what the groups are compared with, each with each"
SIDE = "lower or higher: how the groups, or the first tier, compare with the others"
STATISTIC = "of what: rank (left out: this), mean, median, iqr, range, min or max"
FAILURES = (
    "what a run without a feasible path counts: drop (left out: this), last (worse than any success; also runs that do not satisfy a "
    "condition on an outcome) or count (the event is false)"
)


class Check(Model):
    """A check of any kind: what others ask of it, whether it has the keys or not."""

    @property
    def primary(self) -> bool:
        """Does it count for the verdict?"""
        return not getattr(self, "secondary", None)

    @property
    def experiments(self) -> list[str]:
        """Experiments whose runs are judged."""
        return one_or_list(getattr(self, "experiment", None) or [])

    @property
    def cells(self) -> str | None:
        """The column whose values are compared, if any."""
        return getattr(self, "across", None)

    @property
    def groups_named(self) -> list:
        """All groups that the check names."""
        tiers = [getattr(self, key, None) or [] for key in ("groups", "than")]
        tiers += [*(getattr(self, "pairs", None) or []), *(getattr(self, "order", None) or [])]
        return [group for tier in tiers for group in tier]


class OfRuns(Check):
    """Checks of runs."""

    experiment: listed(Experiment, least=2, single=True) = Field(description=EXPERIMENT)
    metric: Metric = Field(description="the name of a metric")
    where: Where = Field({}, description="column of the runs table → value or list of values: the runs that are judged", min_length=1)
    every: Columns = Field([], description="a list of columns; one comparison for each combination of their values")
    replicate: Column = Field("repeat", description="the column that numbers independent replicates; left out: repeat")


class Comparing(OfRuns):
    """Checks that compare groups."""

    across: Column = Field("method", description="the column whose values are the groups; left out: method")
    scale: Literal["absolute", "relative"] = Field("absolute", description=SCALE)
    margin: Margin = Field(description=MARGIN)


class Lower(Comparing):
    """Groups are lower, or higher, than others."""

    test: Literal["lower"] = Field(description="lower")
    secondary: Literal[True] = Field(None, description=SECONDARY)
    pool: Columns = Field([], description=POOL)
    paired: Flag = Field(None, description=PAIRED)
    groups: Groups = Field(None, description=GROUPS)
    than: Groups = Field(None, description=THAN)
    pairs: listed(listed(Group, least=2)) = Field(None, description="a list of [group, other group], in place of groups and than")
    direction: Literal["lower", "higher"] = Field(description=SIDE)
    statistic: Literal["rank", "mean", "median", "iqr", "range", "min", "max"] = Field("rank", description=STATISTIC)
    least: Positive = Field(None, description="the claimed least effect, a number above 0; left out: any effect")
    work: Metric = Field(None, description=WORK)
    failures: Literal["drop", "last", "count"] = Field("drop", description=FAILURES)

    @model_validator(mode="after")
    def _check_groups(self) -> "Lower":
        if self.model_fields_set & {"groups", "than", "pairs"} not in ({"groups", "than"}, {"pairs"}):
            raise wrong("groups: expected either groups and than, or pairs")
        if any(len(pair) != 2 for pair in self.pairs or []):
            raise wrong("pairs: expected a list of [group, other group]")
        return self


class Ordered(Comparing):
    """Tiers of groups, each lower, or higher, than the next."""

    test: Literal["ordered"] = Field(description="ordered")
    secondary: Literal[True] = Field(None, description=SECONDARY)
    paired: Flag = Field(None, description=PAIRED)
    order: listed(listed(Group), least=2) = Field(description="tiers, the best first: a list of lists of groups")
    direction: Literal["lower", "higher"] = Field(description=SIDE)
    statistic: Literal["rank", "mean", "median", "iqr", "range", "min", "max"] = Field("rank", description=STATISTIC)


class Trend(OfRuns):
    """The metric rises, or falls, along a column of numbers."""

    test: Literal["trend"] = Field(description="trend")
    paired: Flag = Field(None, description=PAIRED)
    x: Column = Field(description="a column of numbers along which the metric changes")
    direction: Literal["up", "down"] = Field(description="up or down")
    statistic: Literal["std"] = Field(None, description="std: the spread of each condition; left out: the values themselves")
    scale: Literal["absolute", "relative"] = Field("absolute", description=SCALE)
    margin: Margin = Field(description=MARGIN)
    work: Metric = Field(None, description=WORK)

    @property
    def cells(self) -> str:
        """The column along which the metric changes."""
        return self.x


class Share(OfRuns):
    """The share of runs in which something is so."""

    test: Literal["share"] = Field(description="share")
    secondary: Literal[True] = Field(None, description=SECONDARY)
    pool: Columns = Field([], description=POOL)
    event: Event = Field(
        None, description="one of {below: number}, above, at_most, at_least, equals; left out for a metric that is true or false"
    )
    threshold: Annotated[
        Any, value(lambda given: given in ("all", "none", "some") if isinstance(given, str) else is_number(given) and 0 <= given <= 1, "")
    ] = Field(description="a share from 0 to 1, or all, none, some")
    direction: Literal["at_least", "at_most"] = Field(None, description="at_least or at_most, where the threshold is a number")
    failures: Literal["drop", "last", "count"] = Field("drop", description=FAILURES)
    pick: Pick = Field(None, description="{lowest: metric}: one feasible run of each condition and method")

    @model_validator(mode="after")
    def _check_side(self) -> "Share":
        if isinstance(self.threshold, str) != (self.direction is None):
            needed = "has no direction" if self.direction else "needs a direction, at_least or at_most"
            raise wrong(f"threshold: {self.threshold}: {needed}")
        return self


class EqualWithin(Comparing):
    """Two groups differ by no more than the margin."""

    test: Literal["equal_within"] = Field(description="equal_within")
    secondary: Literal[True] = Field(None, description=SECONDARY)
    pool: Columns = Field([], description=POOL)
    groups: Groups = Field(description=GROUPS)
    than: Groups = Field(description=THAN)
    statistic: Literal["mean", "median", "min", "max"] = Field(description="of what: mean, median, min or max")
    target: Number = Field(0, description="the claimed difference, a number; left out: 0")


class Difference(Comparing):
    """Groups differ at all."""

    test: Literal["difference"] = Field(description="difference")
    secondary: Literal[True] = Field(None, description=SECONDARY)
    paired: Flag = Field(None, description=PAIRED)
    groups: listed(Group, least=2) = Field(description="a list of at least two values of the column `across`")


Selected = dict[str, Values]


class PublishedArithmetic(Check):
    """The paper's own numbers against each other."""

    test: Literal["published_arithmetic"] = Field(description="published_arithmetic")
    secondary: Literal[True] = Field(None, description=SECONDARY)
    form: Literal["difference", "increase_percent", "equal"] = Field(
        description="difference (second less first), increase_percent (of the second over the first) or equal (first alone)"
    )
    of: list[Selected] = Field(
        description="a list of one or two {table: file, column: value, ...}: published cells", min_length=1, max_length=2
    )
    equals: Annotated[Any, mapping_or(Selected, Number)] = Field(description="a number, or {table: file, column: value, ...}")

    @model_validator(mode="after")
    def _check_tables(self) -> "PublishedArithmetic":
        for selector in (*self.of, *([self.equals] if isinstance(self.equals, dict) else [])):
            if "table" not in selector:
                raise wrong("of: table: missing key; a file of the folder published, or a list of them, without .csv")
        return self


class Asked(Check):
    """What a function of the study's module finds."""

    test: Literal["function"] = Field(description="function")
    name: Function = Field(description="the name of a function of `src/bezierplan/analysis/papers/<study>.py`")
    effect: Line = Field(description="what its effect measures, in words")
    effect_unit: Line = Field(description="the unit of its effect, - for a number without unit")
    experiment: listed(Experiment, least=2, single=True) = Field(None, description=EXPERIMENT)
    metric: Metric = Field(None, description="the name of a metric")
    where: Where = Field({}, description="column of the runs table → value or list of values", min_length=1)


CHECKS = {
    model.model_fields["test"].annotation.__args__[0]: model
    for model in (Lower, Ordered, Trend, Share, EqualWithin, Difference, PublishedArithmetic, Asked)
}
"""Kind of test -> its model."""


class Claim(Model):
    """A sentence of the paper."""

    id: ClaimId = Field(description="C and a number, such as C1")
    place: Line = Field(description="where the paper says it")
    statement: Annotated[Line, value(lambda given: isinstance(given, str) and given.isprintable() and 0 < len(given) <= 160, "")] = Field(
        description="one plain sentence of at most 160 characters, in words of one's own"
    )
    artefact: listed(Annotated[Name, Names("artefact")], least=2, single=True) = Field(
        [],
        description="the table or figure that shows it, or a list of them; the groups that `rest` and the metric rank range over "
        "are theirs",
    )
    finding: Literal[True] = Field(None, description="true: our own finding, no sentence of the paper; left out otherwise")
    note: Line = Field(None, description="one line that stands with the reason of the verdict")
    holds: Literal["all", "any"] = Field("all", description="`all` comparisons of the deciding checks (left out: this), or `any` of them")
    variants: dict[str, listed(Values, least=2)] = Field(
        {},
        description="column → list of values, the first of which decides; in a further row a value stands for the first one",
        min_length=1,
    )
    checks: list[Annotated[Check, one_of("test", CHECKS)]] = Field(
        description="a list of checks, of which at least one decides", min_length=1
    )

    @model_validator(mode="after")
    def _check_decides(self) -> "Claim":
        if not any(check.primary for check in self.checks):
            raise wrong("checks: every check has secondary: true; expected one that decides")
        return self

    @property
    def artefacts(self) -> list[str]:
        """Tables and figures that show it."""
        return one_or_list(self.artefact)


class ClaimsFile(Model):
    """The file."""

    claims: list[Claim] = Field(description="a list of claims", min_length=1)


class Assumption(Model):
    """What a paper leaves open, and what is in force here."""

    id: Annotated[str, matching(r"^[OM][1-9][0-9]*[a-z]?$", "O or M and a number")] = Field(
        description="O or M and a number, such as O1; O1b for a second setting of the same point"
    )
    detail: Line = Field(description="what is left open, one line")
    default: Annotated[Any, mapping_or(Annotated[dict[Name, Setting], MinLen(1)], Setting)] = Field(
        description="the value in force; or method → value, and then the alternatives are for these methods alone"
    )
    alternatives: listed(Setting, least=0) = Field(description="a list of the other values that the setting can take; [] for none")
    reason: Line = Field(description="why the default was chosen, one or two lines")
    source: Literal["published", "inferred", "assumed"] = Field(description="where the default comes from: published, inferred or assumed")
    setting: Name = Field(None, description="the planner's setting that it governs")
    along: dict[Name, dict[Name, Setting]] = Field(
        {}, alias="with", description="method → further settings that go along with every alternative", min_length=1
    )
    claims: listed(ClaimId) = Field(
        [], description="ids of the claims on which `snakemake alternatives` tries each alternative, one at a time (`sensitivity.csv`)"
    )

    @model_validator(mode="after")
    def _check_setting(self) -> "Assumption":
        if self.setting is None and self.model_fields_set & {"along", "claims"}:
            raise wrong("setting: missing key; with and claims need the planner's setting that is governed")
        return self


class AssumptionsFile(Model):
    """The file."""

    assumptions: list[Assumption] = Field(description="a list of assumptions", min_length=1)
