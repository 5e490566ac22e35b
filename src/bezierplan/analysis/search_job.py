"""What the search for an interpretation is made from: names and plain values."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from bezierplan.analysis.table_kinds import Pivot
from bezierplan.running.chunk import Chunk
from bezierplan.running.descriptions import Descriptions

WITHOUT = "all"
"""The value of a choice for a key of tables under which they do not have it."""


class Choice(NamedTuple):
    """A detail that a paper leaves open and that governs its published numbers."""

    id: str
    detail: str
    values: list[Any]
    """The default first, as None, because methods may differ in it."""
    setting: str | None = None
    """The setting of some methods that it governs."""
    methods: Sequence[str] = ()
    along: Mapping[str, dict[str, Any]] = {}
    """Method -> further settings that go with it."""
    problems: Sequence[str] = ()
    """Those on which alone it governs the setting; none for all."""
    workspace: Mapping[str, str] = {}
    """Workspace -> its key that it governs."""
    table: str | None = None
    """The key of the tables that it governs; the value `WITHOUT` leaves it out."""
    column: str | None = None
    """The column of the tables whose value is the paper's world."""
    overrules: Mapping[str, list[str]] = {}
    """Value -> ids of the choices of settings that this world makes itself."""
    metric: str | None = None
    """The metric with which a printed word is compared."""
    printed: bool = False
    """Whether the default is what the paper prints, so that its alternatives depart from it."""


class Part(NamedTuple):
    """Methods whose numbers are judged together, and the ids of the choices that these depend
    on.
    """

    methods: list[str]
    choices: list[str]


class TableRuns(NamedTuple):
    """A table of published numbers, and the runs of each of its methods."""

    experiment: str
    spec: Pivot
    jobs: dict[str, Chunk]


class Stage(NamedTuple):
    """What interpretations are judged by in one stage of the search."""

    study: str
    tables: dict[str, TableRuns]
    choices: list[Choice]
    worlds: dict[str, Descriptions]
    """By experiment, the problems of the runs."""
    maps: str
    """Digest of the content of map files."""


class Search(NamedTuple):
    """All that the search depends on beside the files of maps and published numbers."""

    study: str
    most: int
    """How many interpretations of each part are tried."""
    most_finalists: int
    parts: list[Part]
    along: dict[str, str]
    """Of some tables, the column along which the paper says that its numbers rise or fall."""
    stages: dict[str, Stage]
    """By the names of `study.choices.STAGES`."""

    @property
    def choices(self) -> list[Choice]:
        """All choices, which are the same in each stage."""
        return next(iter(self.stages.values())).choices
