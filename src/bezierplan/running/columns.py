"""Columns of the runs tables, each declared once, as a line of columns.csv next to this file: its
table, what its values are, its unit and its meaning. What a file of runs holds (`rows.table`), what
is expected of it when it is read (`rows.find_fault`), which names are taken, what a study may
select by (`study.design`), and the tables in results/README.md (`python docs/tables_of_keys.py`)
follow.

A row is what is known before its run (`Planned`, with the place of its problem after `problem` and
its settings after `planner`), what the run found out (`Outcome`), for a drive more of that
(`DriveOutcome`), and the planner's own columns. Bounds (`Bound`, `DriveBound`) and times (`Times`,
`DriveTimes`), which are not reproducible, are joined when it is read.
"""

import csv
import typing
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, NamedTuple, NewType

from bezierplan.planners import PLACE

RunName = NewType("RunName", str)

VALUES = {
    "name": RunName,
    "word": str,
    "whole number": int,
    "number": float,
    "flag": bool,
    "numbers": list[float],
}
"""What a column's values are, as columns.csv says it -> their type."""


class Column(NamedTuple):
    """What a column means, in a phrase; its unit, empty for a pure number; what it means of a
    drive, where that is something else; and what a reader of the file should know beside.
    """

    meaning: str
    unit: str = ""
    drive: str = ""
    detail: str = ""


def read_tables(module: str) -> list[type]:
    """Named tuples, one for each table of the file columns.csv next to a module's file."""
    fields: dict[str, list[tuple[str, Any]]] = {}
    with Path(module).with_suffix(".csv").open(encoding="utf-8", newline="") as file:
        for table, name, values, *about in islice(csv.reader(file), 1, None):
            kind, column = VALUES[values], Column(*about)
            fields.setdefault(table, []).append((name, Annotated[kind, column]))
    return [NamedTuple(table, of) for table, of in fields.items()]


Planned, Outcome, DriveOutcome, Bound, DriveBound, Times, DriveTimes = read_tables(__file__)


class Table(NamedTuple):
    """What declares the columns of a kind of file, and what declares those that it has beside them
    if its runs are drives.
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
"""Type of a value -> its word in studies' faults: a name is one for each run, a word is text, a
flag true or false; others are lists.
"""


def read_columns(*tables: type) -> dict[str, tuple[type, Column]]:
    """Columns with the types of their values and what they mean."""
    return {
        name: typing.get_args(annotation)
        for table in tables
        for name, annotation in table.__annotations__.items()
    }


def _read_types(*tables: type) -> dict[str, str]:
    return {name: TYPES.get(kind, "list") for name, (kind, _) in read_columns(*tables).items()}


PLANNED = _read_types(Planned)
"""Columns of every runs table known before a run, beside settings, with their types (`TYPES`)."""

RESULTS = _read_types(Outcome)
"""Likewise: those that a run finds out; the settings and a planner's extra columns stand between
`planner` and `objective`, and at the end.
"""

DRIVE_RESULTS = _read_types(DriveOutcome)
"""Columns of a runs table that only drives have."""

ANSWER = ["path_points", "history"]
"""Columns of a run by which its answer equals that of another one: lists of numbers."""

JOINED = {name: kind for name, kind in _read_types(Bound, Times).items() if name not in PLANNED}
"""Columns joined to a runs table when it is read: those of `problems.compute_bounds`, and the
times.
"""

DRIVE_JOINED = _read_types(DriveBound, DriveTimes)
"""Columns that are joined to the table of drives: likewise, and the times of plans."""

WORDS = ("value", "statistic", "metric", "n", "unit", "table")
"""Columns of tables of results, beside those of the runs table that tell their rows apart."""

TAKEN = frozenset((*PLANNED, *RESULTS, *DRIVE_RESULTS, *PLACE, *JOINED, *DRIVE_JOINED))
"""Names that no planner's extra column can have; the job's settings and what it varies are others.
A setting cannot have them either.
"""
