"""Kinds of panel, one file each, here or in a folder `panels` of `papers`.

Every file has `Options`, the keys that a panel of this kind may have, of which a panel is an
instance, and

- `data(source, options)`: makes the table of the panel from runs, a workspace or a function's
  table, whichever `source` of the options finds
- `draw(axes, frame, scene, options)`: draws the rows of its panel in that table, and returns a
  `Note`, the panel in words

`draw` labels its artists for the legend, and computes no statistics. A kind whose panels are not
flat has `PROJECTION`, matplotlib's name for it.

Options are read at every start of the workflow, so these files import libraries for drawing and
tables inside the functions that need them.
"""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from types import ModuleType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple

from pydantic import Field, PrivateAttr, model_validator

from bezierplan.machine.modules import find_kinds, load_module
from bezierplan.schema.model import (
    ARGUMENTS,
    Arguments,
    ExperimentName,
    Function,
    Line,
    Metric,
    Model,
    PrintedTable,
    Quantity,
    Repeat,
    Where,
    WorkspaceName,
    build_error,
    build_list_type,
    convert_to_list,
)

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.analysis.results import Results
    from bezierplan.workspaces import files
    from bezierplan.workspaces.problem import Problem

MOST_PANELS = 26
"""Panels of a figure, each of which has a letter."""


class Note(NamedTuple):
    """A panel in words.

    heading: a few words below its title. caption: clauses for the figure's notes, joined by
    semicolons, such as the run that it shows and the runs that it counts. glance: things that are
    plain to the eye, for those who do not see the picture.
    """

    heading: str = ""
    caption: str = ""
    glance: str = ""


EACH = (
    "a list of at least two mappings, for panels that differ in a few keys: each becomes a panel, "
    "with its own keys and those beside `each`; `where` may be given in both"
)


class Sources(NamedTuple):
    """The sources of a figure's panels.

    results: by experiment. workspaces, problems: by name, if they are drawn without runs.
    functions: by name, from the study's module. published: all published tables by file name.
    alternatives: each alternative (assumption, detail, value) with the comparisons of claims under
    it.
    """

    results: Mapping[str, Results] = {}
    workspaces: Mapping[str, Any] = {}
    functions: Mapping[str, Callable[..., pd.DataFrame]] = {}
    published: Mapping[str, pd.DataFrame] = {}
    problems: Mapping[str, Problem] = {}
    alternatives: Sequence[tuple[dict[str, str], pd.DataFrame]] = ()


class Panel(Model, ABC):
    """Keys common to all kinds of panel, and the needs of a kind beside its panels.

    rerun: tells if runs are repeated to draw values that no table keeps. one: columns in which the
    runs shown have one value. drives: tells if these are drives.
    """

    rerun: ClassVar[bool] = False
    one: ClassVar[tuple[str, ...]] = ()
    drives: ClassVar[bool] = False

    kind: Line = Field(description="the name of a file in `src/bezierplan/figures/panels`")
    title: Line = Field(
        None, description="one line above the panel, at most 80 characters, 30 a word"
    )
    each: list[dict[str, Any]] = Field(None, min_length=2, description=EACH)

    _place: str = PrivateAttr("")

    @abstractmethod
    def source(self, sources: Sources) -> Any:
        """Return the source of its drawing, as `data` of its kind takes it."""

    @property
    def place(self) -> str:
        """Return the keys that lead to the panel in the file."""
        return self._place


class RunsPanel(Panel):
    """A panel that shows runs."""

    experiment: ExperimentName = Field(description="the name of an experiment")
    where: Where = Field(
        {},
        description="column of the runs table → value or list of values: the runs that are shown",
    )
    context: bool = Field(
        False,
        description="whether to draw also what the paper does not show, true or false: the "
        "exact shortest path or its length, the best known one of the same kind, where pieces of a "
        "curve join, the spread of all runs",
    )

    def source(self, sources: Sources) -> Any:
        """Return the results of the experiment with the runs that are shown."""
        from bezierplan.analysis.results import select

        results = sources.results[self.experiment]
        return results._replace(runs=select(results.runs, self.where))

    def find_workspace(self, frame: pd.DataFrame, scene: Any) -> files.Workspace:
        """Return the workspace of the runs in the table of a panel."""
        return scene.problems[self.experiment][frame["problem"].iloc[0]].workspace


class TablePanel(Panel):
    """A panel that shows a table of a function of the study's module."""

    data: Function = Field(
        description="the name of a function of the study's module that returns a table; with "
        "`workspace` it is called with that, with "
        "`published` with those published tables by file name"
    )
    published: build_list_type(PrintedTable, single=True) = Field(
        [], description="the name of a published table, or a list of names"
    )
    workspace: WorkspaceName = Field(None, description="the name of a workspace")
    arguments: Arguments = Field({}, description=ARGUMENTS)
    where: Where = Field(
        {}, description="column of the table → value or list of values: the rows that are shown"
    )

    def source(self, sources: Sources) -> Any:
        """Return the rows of the function's table that are shown.

        The function gets the workspace and the published tables that the panel names, and its
        arguments.
        """
        from bezierplan.analysis.results import select

        given = [] if self.workspace is None else [sources.workspaces[self.workspace]]
        if names := convert_to_list(self.published):
            given.append({name: sources.published[name] for name in names})
        return select(sources.functions[self.data](*given, **self.arguments), self.where)


class MetricPanel(RunsPanel):
    """A panel that shows the numbers of a metric."""

    metric: Metric = Field(description="the name of a metric")
    printed: PrintedTable = Field(
        None, description="the name of a published table whose numbers are drawn as well"
    )
    scale: Literal["linear", "log", "symlog"] = Field(
        "linear",
        description="of the axis of the metric: linear (left out: this), log, or symlog, which is "
        "linear up to 0.001 and logarithmic beyond",
    )


class Pick(Model):
    """A choice of one run."""

    lowest: Quantity = Field(
        None,
        description="a column of numbers of the runs table: the feasible run with its lowest value",
    )
    median: Quantity = Field(
        None,
        description="a column of numbers of the runs table: the feasible run with its median value",
    )
    repeat: Repeat = Field(None, description="a whole number: the run of that repeat")
    having: Metric = Field(
        None,
        description="in addition to one of these, the name of a metric: "
        "only runs that have more than 0 of it count",
    )
    layout: Quantity = Field(
        None,
        description="in addition to one of these, a column of numbers of the runs table: "
        "only the layout counts in whose runs it varies most",
    )

    @model_validator(mode="after")
    def _check_one(self) -> Pick:
        """Refuse anything but one way to choose a run."""
        ways = self.model_fields_set - {"having", "layout"}
        if len(ways) != 1:
            raise build_error(
                f"{len(ways)} keys; expected {{lowest: column}}, "
                f"{{median: column}} or {{repeat: number}}"
            )
        return self


Picked = Annotated[
    Pick,
    Field(
        description="which run: {lowest: column} or {median: column} of the feasible ones, or "
        "{repeat: number}; with having: metric, only of those that have more than 0 of it, and "
        "with layout: column, only of the layout in which that varies most"
    ),
]


def require_one(panel: Model, *keys: str) -> None:
    """Raise the error of a panel that does not have exactly one of the keys."""
    both = [key for key in keys if key in panel.model_fields_set]
    if len(both) != 1:
        raise build_error(f"{' and '.join(both) or 'neither'}: expected either {' or '.join(keys)}")


def find_only(runs: pd.DataFrame, column: str) -> Any:
    """Return the one value of a column of the runs that a panel shows.

    Raises ValueError if there are others.
    """
    values = list(runs[column].unique())
    if len(values) != 1:
        raise ValueError(
            f"the panel needs runs of exactly one {column}, not of {len(values)} {values}; see its "
            "`where`"
        )
    return values[0]


def load_kind(name: str) -> ModuleType:
    """Load the file of a kind of panel. Raises KeyError if there is none."""
    return load_module(find_kinds("figures/panels", "panels")[name])


def build_panel(keys: dict[str, Any]) -> Panel:
    """Build the panel of a job from its plain values."""
    return list_kinds()[keys["kind"]].model_validate(keys)


@functools.cache
def list_kinds() -> dict[str, type[Panel]]:
    """Return the options of the panels of each kind."""
    return {name: load_kind(name).Options for name in find_kinds("figures/panels", "panels")}
