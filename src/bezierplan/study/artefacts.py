"""Models of `artefacts.yaml`: tables and figures, and how names are printed."""

import re
from collections.abc import Iterable
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    ConfigDict,
    Field,
    PlainValidator,
    TypeAdapter,
    ValidationError,
    model_validator,
)

from bezierplan.figures import style
from bezierplan.figures.panels import EACH, MOST_PANELS, Panel, kinds
from bezierplan.schema.checked import closest
from bezierplan.schema.model import (
    ARGUMENTS,
    Arguments,
    Column,
    Count,
    Decimals,
    Experiment,
    Flag,
    Function,
    Label,
    Line,
    Metric,
    Model,
    Name,
    Names,
    Quantity,
    Setting,
    Statistic,
    Where,
    at_most,
    first_fault,
    listed,
    mapping_or,
    matching,
    one_of,
    one_or_list,
    wrong,
)
from bezierplan.study.experiments import Settings

PublishedFile = Annotated[
    str,
    matching(r"[A-Za-z0-9_-]+\.csv", "a name of letters, digits, _ and -, that ends in .csv"),
    Names("published"),
]
# A column of the runs table, `value` or `statistic`.
Columns = listed(Annotated[Name, Names("level")], least=0)


class Table(Model):
    """Keys common to all kinds of table. smoke: the kind that it represents in the small subset."""

    smoke: ClassVar[str] = ""

    title: Line = Field(description="one line")


class TableValue(Model):
    """An entry of a table's `values`."""

    metric: Metric = Field(
        description="the name of a metric (`src/bezierplan/analysis/metrics.py`)"
    )
    statistic: listed(Statistic, single=True) = Field(
        description="the name of a statistic (`src/bezierplan/analysis/statistics.py`) or a list "
        "of names; `unstated` where the "
        "paper does not say, "
        "and ours is then the median"
    )
    where: Where = Field(
        {}, description="column of the runs table → value or list of values: the runs that count"
    )
    least: Quantity = Field(
        None,
        description="a column of numbers of the runs table that no value of these runs can lie "
        "below, if the metric has no such bound",
    )
    defined: Flag = Field(
        True,
        description="whether the paper says what it counts here; if not, its numbers are shown "
        "beside ours, but are all inconclusive, and "
        "`snakemake interpretations` leaves them out; left out: true",
    )
    label: Label = Field(description="how the value is printed, at most 80 characters, 30 a word")
    decimals: Decimals = Field(
        description="how many decimals are printed, a whole number from 0 to 15"
    )

    @property
    def statistics(self) -> list[str]:
        return one_or_list(self.statistic)


MOST_VALUES = 100
"""Entries of a table's `values`, and of its `monotone`."""


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
    where: Where = Field(
        {},
        description="column of the published file → value or list of values: those that are tried",
    )
    edges: Count = Field(
        description="most edges of a polyline through cell centres, a whole number of at least 1"
    )
    counts: Flag = Field(
        True,
        description="whether a number that is such a length counts as identified; left out: true",
    )
    because: Line = Field(description="why the numbers may be such lengths, in words")


class Pivot(Table):
    """A table of runs, compared with published numbers."""

    kind: Literal["pivot"] = Field(description="pivot")
    experiment: Experiment = Field(description="the name of an experiment")
    where: Where = Field(
        {},
        description="column of the runs table → value or list of values, "
        "which also gives the order",
    )
    index: Columns = Field(
        description="a list of columns of the runs table, `value` or `statistic`: what the rows are"
    )
    columns: Columns = Field([], description="likewise: what the columns are")
    values: Annotated[list[TableValue], at_most(MOST_VALUES)] = Field(
        description="a list of {metric, statistic, label, decimals}, and perhaps `where`",
        min_length=1,
    )
    published: PublishedFile = Field(
        None,
        description="a file in the study's folder `published` to compare with: letters, digits, _ "
        "and -, then .csv",
    )
    reads: dict[Name, Metric] = Field(
        {},
        description="metric in the published file → the metric that the number is compared with, "
        "where the paper leaves open which it is",
    )
    within: Column = Field(
        None,
        description="the column of which all runs behind a published number share one value, such "
        "as layout: predictions are then for "
        "experiments within one of ours; left out: none",
    )
    monotone: Annotated[list[Monotone], at_most(MOST_VALUES)] = Field(
        [],
        description="orders that the published numbers must keep, which the audit checks: "
        "{metric, statistic, along, direction, because}",
    )
    fitted: Flag = Field(
        False,
        description="true if the workspaces were reconstructed so that the published lengths are "
        "possible: the audit does not compare them "
        "with its bounds; left out: false",
    )
    identify: list[Identify] = Field(
        [],
        description="published lengths on grids that may be, to the last digit, those of free "
        "polylines through cell centres from start to "
        "target, which the audit enumerates: {metric, where, edges, because}, and perhaps `counts`",
    )
    primary: Where = Field(
        {},
        description="column → the value whose rows count as the paper's interpretation in the "
        "summary; left out: all rows",
    )

    @model_validator(mode="after")
    def _check_places(self) -> "Pivot":
        if not self.index:
            raise wrong("index: []: expected at least one column")
        for key in self.columns:
            if key in self.index:
                raise wrong(f"columns: {key}: in index already; expected it in one of the two")
        labels = [entry.label for entry in self.values]
        for number, label in enumerate(labels):
            if label in labels[:number]:
                raise wrong(
                    f"values: {number}: label: {label}: another entry has this label; expected "
                    "one that tells them apart"
                )
        if self.reads and self.published is None:
            raise wrong(
                "reads: the table has no published numbers, whose metrics it names; leave it out"
            )
        return self


class Transcribed(Table):
    """A published file, unchanged."""

    kind: Literal["transcribed"] = Field(description="transcribed")
    published: PublishedFile = Field(
        description="a file in the study's folder `published`: letters, digits, _ and -, then .csv"
    )


class FunctionTable(Table):
    """The result of a function in the study's module."""

    kind: Literal["function"] = Field(description="function")
    function: Function = Field(
        description="the name of a function of `src/bezierplan/analysis/papers/<study>.py`, "
        "called with all published tables by file name"
    )
    arguments: Arguments = Field({}, description=ARGUMENTS)


class Comparison(Table):
    """The published numbers of other tables next to ours, with prediction intervals for experiments
    of the paper's size.
    """

    kind: Literal["comparison"] = Field(description="comparison")
    of: listed(Annotated[Name, Names("compared")]) = Field(
        description="a list of tables with published numbers"
    )
    metrics: listed(Metric) = Field(description="a list of metrics")
    where: Where = Field({}, description="column of the comparison → value or list of values")


TABLES = {
    model.model_fields["kind"].annotation.__args__[0]: model for model in Table.__subclasses__()
}
"""Kind -> its model."""


class Each(Model):
    """The part of a panel that makes it several."""

    each: list[dict[str, Any]] = Field(min_length=2, description=EACH)


_PANEL = TypeAdapter(Annotated[Panel, one_of("kind", kinds())])


def _expanded(entry: Any) -> dict[str, Panel]:
    """The panels that an entry in a list of panels stands for, by the keys in it that lead to
    them.
    """
    if not isinstance(entry, dict) or "each" not in entry:
        return {"": _PANEL.validate_python(entry)}
    panels = {}
    for number, part in enumerate(Each(each=entry["each"]).each):
        location = f"each: {number}"
        try:
            joined = _joined(part, entry, location)
            panels[location] = _PANEL.validate_python(
                {key: value for key, value in joined.items() if key != "each"}
            )
        except ValidationError as error:
            path = first_fault(error)
            key = path[0].split(":")[0]
            raise wrong(
                ": ".join(path if key in entry and key not in part else [location, *path])
            ) from None
    return panels


def _joined(part: dict[str, Any], shared: dict[str, Any], location: str) -> dict[str, Any]:
    """The keys of both; mappings that stand in both are joined likewise."""
    joined = part | shared
    for key in part.keys() & shared.keys():
        if not (isinstance(part[key], dict) and isinstance(shared[key], dict)):
            raise wrong(
                f"{location}: {key}: is given beside each as well; "
                "expected it in one of the two places"
            )
        joined[key] = _joined(part[key], shared[key], f"{location}: {key}")
    return joined


_ENTRIES = TypeAdapter(
    Annotated[list[Annotated[Any, PlainValidator(_expanded)]], Field(min_length=1)]
)
_LIST = TypeAdapter(Annotated[list[Any], at_most(MOST_PANELS)], config=ConfigDict(strict=True))


def _panels(given: Any) -> list[Panel]:
    """The panels of a figure, each with its place in the list that is given."""
    panels = []
    for number, entry in enumerate(_ENTRIES.validate_python(_LIST.validate_python(given))):
        for location, panel in entry.items():
            panel._place = f"{number}: {location}" if location else str(number)
            panels.append(panel)
    if len(panels) > MOST_PANELS:
        raise wrong(f"{len(panels)} panels; expected at most {MOST_PANELS}, one a letter")
    return panels


class Figure(Model):
    """Panels on one sheet."""

    title: Line = Field(description="one line")
    columns: Literal[1, 2, 3, 4, 5] = Field(description="panels side by side, 1 to 5")
    panels: Annotated[list[Panel], PlainValidator(_panels)] = Field(description="a list of panels")


def _look(given: Any) -> str:
    """The name of a look."""
    if not isinstance(given, str) or given not in style.LOOKS:
        raise wrong(f"{given}: unknown{closest(str(given), style.LOOKS)}")
    return given


class ArtefactsFile(Model):
    """The file."""

    labels: dict[Line, Label] = Field(
        {}, description="name → how it is printed, at most 80 characters, 30 a word"
    )
    looks: dict[Name, Annotated[str, PlainValidator(_look)]] = Field(
        {},
        description="name of a method → how it looks in every figure: "
        + ", ".join(style.LOOKS)
        + "; left out: as its planner does in all "
        "studies, or unlike most other methods",
    )
    tables: dict[Name, Annotated[Table, one_of("kind", TABLES)]] = Field(
        {}, description="name → a table"
    )
    figures: dict[Name, Figure] = Field({}, description="name → title, columns and panels")


class ConfigFile(Model):
    """The file `config/config.yaml`, or what `--config` gives."""

    studies: listed(Line) = Field(
        description="a list of studies, each the name of a folder in `config/studies` or a path"
    )
    settings: dict[Name, dict[Name, Annotated[Any, mapping_or(Settings, Setting)]]] = Field(
        {},
        description="study → settings that take the place of those of the same name in its "
        "`experiments.yaml`",
    )


def in_printed_order(names: Iterable[str]) -> list[str]:
    """Names of tables and figures with the numbered ones first, tables before figures, each by its
    number; the others as they were.

    >>> in_printed_order(["work", "figure11", "figure2", "table6", "table4"])
    ['table4', 'table6', 'figure2', 'figure11', 'work']
    """
    numbered = {
        name: found for name in names if (found := re.fullmatch(r"(table|figure)(\d+)", name))
    }
    first = sorted(
        numbered, key=lambda name: (numbered[name][1] != "table", int(numbered[name][2]))
    )
    return [*first, *(name for name in names if name not in numbered)]
