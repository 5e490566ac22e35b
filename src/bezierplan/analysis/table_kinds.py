"""The kinds of table, each a model of its keys.

A study's tables are checked against them at every start of the workflow, so this file imports
nothing but what models need.
"""

from typing import Literal

from pydantic import Field, model_validator

from bezierplan.schema.model import (
    ARGUMENTS,
    Arguments,
    Column,
    Count,
    Decimals,
    ExperimentName,
    Function,
    Line,
    Metric,
    Model,
    Name,
    Quantity,
    Statistic,
    Where,
    build_error,
    build_list_type,
    build_name_type,
    build_text_type,
    convert_to_list,
)

PublishedFile = build_name_type(
    "published",
    build_text_type(
        r"[A-Za-z0-9_-]+\.csv", "a name of letters, digits, _ and -, that ends in .csv"
    ),
)
WORDS = ("value", "statistic")
"""Words that distinguish numbers of a table beside columns of the runs table: the entry of
`values`, and the statistic of it.
"""
# A column of the runs table, or one of these words.
Columns = build_list_type(build_name_type("level"), least=0)


class TableEntry(Model):
    """The keys that all kinds of table share."""

    title: Line = Field(description="one line")
    note: Line = Field(None, description="a footnote, one line; left out: none")


class TableValue(Model):
    """An entry of a table's `values`."""

    metric: Metric = Field(
        description="the name of a metric (`src/bezierplan/analysis/metrics.py`)"
    )
    statistic: build_list_type(Statistic, single=True) = Field(
        description="the name of a statistic (`src/bezierplan/analysis/statistics.py`) or a list "
        "of names; `unstated` where the paper does not say, and ours is then the median"
    )
    where: Where = Field(
        {}, description="column of the runs table → value or list of values: the runs that count"
    )
    least: Quantity = Field(
        None,
        description="a column of numbers of the runs table that no value of these runs can lie "
        "below, if the metric has no such bound",
    )
    defined: bool = Field(
        True,
        description="whether the paper says what it counts here; if not, its numbers are shown "
        "next to ours, but prove nothing; left out: true",
    )
    label: Line = Field(description="how the value is printed")
    decimals: Decimals = Field(
        description="how many decimals are printed, a whole number from 0 to 15"
    )

    @property
    def statistics(self) -> list[str]:
        """Return the statistics as a list, also if one is given."""
        return convert_to_list(self.statistic)


class Monotone(Model):
    """An entry of a table's `monotone`."""

    metric: Metric = Field(description="the name of a metric")
    statistic: Statistic = Field(description="the name of a statistic")
    along: Column = Field(
        description="a column of the published file, along which the numbers must rise or fall"
    )
    direction: Literal["up", "down"] = Field(description="up or down; equal numbers are accepted")
    because: Line = Field(description="why they must, in words")


class Identify(Model):
    """An entry of a table's `identify`: an enumeration of paths whose lengths the published numbers
    may be.
    """

    metric: Metric = Field(description="the metric of the published numbers that are tried")
    statistic: Statistic = Field(None, description="their statistic; left out: all")
    where: Where = Field(
        {},
        description="column of the published file → value or list of values: those that are tried",
    )
    edges: Count = Field(
        7,
        description="most edges of a polyline through cell centres, a whole number of at least 1; "
        "left out: 7",
    )
    diagonal: float = Field(
        None,
        gt=1,
        lt=2,
        description="the length of a diagonal move, such as 1.414, if the paths are of straight "
        "and diagonal moves instead; lengths are compared to its decimals",
    )
    because: Line = Field(description="why the numbers may be such lengths, in words")


class Pivot(TableEntry):
    """A table of runs, compared with published numbers."""

    kind: Literal["pivot"] = Field(description="pivot")
    experiment: ExperimentName = Field(description="the name of an experiment")
    where: Where = Field(
        {},
        description="column of the runs table → value or list of values, "
        "which also gives the order",
    )
    index: Columns = Field(
        description="a list of columns of the runs table, `value` or `statistic`: what the rows are"
    )
    columns: Columns = Field([], description="a list as in `index`: what the columns are")
    values: list[TableValue] = Field(
        description="a list of {metric, statistic, label, decimals}, and optionally `where`",
        min_length=1,
    )
    labels: dict[Line, Line] = Field(
        {}, description="name → how this table prints it, where that differs from the study's label"
    )
    published: PublishedFile = Field(
        None,
        description="a file in the study's folder `published` to compare with: letters, digits, _ "
        "and -, then .csv; the table then has the paper's form: the paper's methods alone, under "
        "the default reading (`primary`), and the printed numbers in the same rows and columns",
    )
    reads: dict[Name, Metric] = Field(
        {},
        description="metric in the published file → the metric that the number is compared with, "
        "where the paper leaves open which it is",
    )
    within: Column = Field(
        None,
        description="the column of which all runs behind a published number share one value, such "
        "as layout: predictions are then for experiments within one of ours; left out: none",
    )
    monotone: list[Monotone] = Field(
        [],
        description="orders that the published numbers must keep, which the audit checks: "
        "{metric, statistic, along, direction, because}",
    )
    identify: list[Identify] = Field(
        [],
        description="published lengths on grids that may be those of free polylines through cell "
        "centres from start to target, to the last digit, or of straight and diagonal moves, to "
        "the decimals of `diagonal`, which the audit enumerates: {metric, because}, and perhaps "
        "`statistic`, `where`, `edges` and `diagonal`",
    )
    primary: Where = Field(
        {},
        description="column → its value under the default reading, the only one that a "
        "table with published numbers shows; left out: all",
    )

    @model_validator(mode="after")
    def _check_places(self) -> "Pivot":
        """Refuse a table whose places are not distinct, or that reads numbers which it does not
        have.
        """
        if not self.index:
            raise build_error("index: []: expected at least one column")
        for key in self.columns:
            if key in self.index:
                raise build_error(
                    f"columns: {key}: in index already; expected it in one of the two"
                )
        labels = [entry.label for entry in self.values]
        for number, label in enumerate(labels):
            if label in labels[:number]:
                raise build_error(
                    f"values: {number}: label: {label}: another entry has this label; expected "
                    "one that tells them apart"
                )
        if self.reads and self.published is None:
            raise build_error(
                "reads: the table has no published numbers, whose metrics it names; leave it out"
            )
        return self

    @property
    def key_columns(self) -> list[str]:
        """Return the columns of the runs table that distinguish its rows and columns."""
        return [name for name in [*self.index, *self.columns] if name not in WORDS]

    @property
    def across(self) -> list[str]:
        """Return the columns of the runs table that distinguish its columns."""
        return [name for name in self.columns if name not in WORDS]


class Transcript(TableEntry):
    """A table that shows a published file unchanged."""

    kind: Literal["transcribed"] = Field(description="transcribed")
    published: PublishedFile = Field(
        description="a file in the study's folder `published`: letters, digits, _ and -, then .csv"
    )


class FunctionTable(TableEntry):
    """A table that a function of the study's module computes."""

    kind: Literal["function"] = Field(description="function")
    function: Function = Field(
        description="the name of a function of the study's `functions.py`, "
        "called with all published tables by file name"
    )
    arguments: Arguments = Field({}, description=ARGUMENTS)


# In the order in which config/README.md lists the kinds.
TABLES = {
    model.model_fields["kind"].annotation.__args__[0]: model
    for model in TableEntry.__subclasses__()
}
"""Kind -> its model."""
