"""Columns of the runs tables, each declared once, as a line of columns.csv next to this file:
table, name, type, meaning and unit.

From these lines follow the types in files and the check when one is read (`table_files`), the names
that are taken, the columns that a study may select by (`study.design`), and the tables in
results/README.md (`python docs/tables_of_keys.py`).

A row holds the columns that are known before its run (`Planned`, with the place of its problem
after `problem` and its settings after `planner`), the outcome of the run (`Outcome`, for a drive
also `DriveOutcome`), and the planner's own columns. Bounds (`Bound`, `DriveBound`) and times
(`Times`, `DriveTimes`) are joined when it is read; times are apart because they cannot be
reproduced.
"""

import csv
import typing
from pathlib import Path
from typing import Annotated, Any, NamedTuple, NewType

from bezierplan.planners import PLACE

Row = dict[str, Any]
"""A row of a table: column -> value."""

RunName = NewType("RunName", str)

VALUES = {
    "name": RunName,
    "word": str,
    "whole number": int,
    "number": float,
    "flag": bool,
    "numbers": list[float],
}
"""Type of a column's values, as columns.csv names it -> Python's type."""


class Column(NamedTuple):
    """A column's meaning in a phrase, its unit (empty for a pure number), its meaning for a drive
    where that differs, and what a reader of the file should know beside.
    """

    meaning: str
    unit: str = ""
    drive: str = ""
    detail: str = ""


def read_tables(module: str) -> list[type]:
    """Read the file columns.csv next to a module; return a named tuple for each of its tables."""
    fields: dict[str, list[tuple[str, Any]]] = {}
    with Path(module).with_suffix(".csv").open(encoding="utf-8", newline="") as file:
        next(file)  # the head
        for table, name, values, *about in csv.reader(file):
            kind, column = VALUES[values], Column(*about)
            fields.setdefault(table, []).append((name, Annotated[kind, column]))
    return [NamedTuple(table, of) for table, of in fields.items()]


Planned, Outcome, DriveOutcome, Bound, DriveBound, Times, DriveTimes = read_tables(__file__)


class Table(NamedTuple):
    """The tables that declare the columns of a kind of file, and the one for its further columns if
    its runs are drives.
    """

    every: tuple[type, ...]
    drives: type


TABLES = {
    "runs": Table((Planned, Outcome), DriveOutcome),
    "bounds": Table((Bound,), DriveBound),
    "times": Table((Times,), DriveTimes),
}
"""Kind of file -> its columns."""

TYPES = {RunName: "name", str: "word", int: "number", float: "number", bool: "flag"}
"""Python's type -> its word in the faults of studies. A name differs in each run, a word is text, a
flag is true or false; other types are lists.
"""


def read_columns(*tables: type) -> dict[str, tuple[type, Column]]:
    """Return the type of the values and the meaning of each column of some tables, by name."""
    return {
        name: typing.get_args(annotation)
        for table in tables
        for name, annotation in table.__annotations__.items()
    }


def _read_types(*tables: type) -> dict[str, str]:
    """Return the word for the type of each column of some tables, by name."""
    return {name: TYPES.get(kind, "list") for name, (kind, _) in read_columns(*tables).items()}


PLANNED = _read_types(Planned)
"""Columns of every runs table that are known before a run, beside settings -> type (`TYPES`)."""

RESULTS = _read_types(Outcome)
"""Columns of every runs table that a run finds out -> type. Settings stand before `objective`, and
a planner's extra columns at the end.
"""

DRIVE_RESULTS = _read_types(DriveOutcome)
"""Columns of a runs table that only drives have -> type."""

ANSWER = ["path_points", "history"]
"""Columns, lists of numbers, by which two runs have equal answers."""

JOINED = {name: kind for name, kind in _read_types(Bound, Times).items() if name not in PLANNED}
"""Columns that are joined to a runs table when it is read -> type: bounds and times."""

DRIVE_JOINED = _read_types(DriveBound, DriveTimes)
"""Columns that are joined to a table of drives -> type: their bounds, and the times of plans."""

WORDS = ("value", "statistic", "metric", "n", "unit", "table")
"""Columns of tables of results, beside those of the runs table that identify a row."""

TAKEN = frozenset((*PLANNED, *RESULTS, *DRIVE_RESULTS, *PLACE, *JOINED, *DRIVE_JOINED))
"""Names that neither a planner's extra column nor a setting can have."""
