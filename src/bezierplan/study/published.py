"""Files of published numbers: checks that they are tables, and that their columns, names and
numbers fit the table that they are compared with.
"""

import csv
import io
import re
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from bezierplan.analysis import metrics, statistics
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.schema.checked import Fault, check_known, closest, text_of
from bezierplan.schema.model import is_number
from bezierplan.study.definition import Study, relative
from bezierplan.study.design import Design

COLUMNS = ("metric", "statistic", "n", "unit", "value")
"""Columns that every file has; those left of them tell its rows apart."""
TIDY = frozenset({"metric", "statistic", "value"})
"""Columns by which claims find numbers in files of any other form."""


class Rows(NamedTuple):
    """A file: its header, and its rows with the number of the line where each ends."""

    header: list[str]
    rows: list[tuple[int, dict[str, str]]]


@cache
def read(file: Path) -> Rows:
    """A csv file: a header of different names, and rows as long as it. Raises Fault, with file and
    line.
    """
    location = relative(file)
    reader = csv.reader(io.StringIO(text_of(file, location), newline=""), strict=True)
    try:
        lines = [(reader.line_num, row) for row in reader if row]
    except csv.Error as error:
        raise Fault(f"{location}: line {reader.line_num}: not csv ({error})") from None
    if len(lines) < 2:
        raise Fault(f"{location}: line 1: expected a header of columns, and rows below it")
    (_, header), *rows = lines
    for number, column in enumerate(header):
        if column in header[:number] or not column.strip():
            raise Fault(f"{location}: line 1: column {column}: expected a name, each once")
    for number, row in rows:
        if len(row) != len(header):
            raise Fault(
                f"{location}: line {number}: {len(row)} values; "
                f"expected {len(header)} values, one a column"
            )
    tidy = Rows(header, [(number, dict(zip(header, row))) for number, row in rows])
    if set(header) >= TIDY:
        for number, row in tidy.rows:
            _check_value(row["value"], f"{location}: line {number}", empty=True)
    return tidy


def keys(study: Study, table: Pivot) -> list[str]:
    """The columns that tell the rows of a table's comparison apart."""
    file = study.folder / "published" / table.published if table.published else None
    header = read(file).header if file else []
    named = [column for column in header if column not in COLUMNS]
    return list(dict.fromkeys([*named, *table.key_columns, *table.primary]))


def check(design: Design, table: Pivot, location: str) -> None:
    """Raise Fault, with file, line, column and what would be right, for a file of published numbers
    that does not fit its table; beginning with a location for what does not fit it in the table.
    """
    study, experiment = design.study, table.experiment
    file = study.folder / "published" / table.published
    here, (header, rows) = relative(file), read(file)
    for column in COLUMNS:
        if column not in header:
            raise Fault(f"{here}: line 1: column {column} is missing; expected all of {COLUMNS}")
    by_name = [column for column in header if column not in COLUMNS]
    for column in by_name:
        design.check_column([experiment], column, "column", f"{here}: line 1: column")
    known: dict[str, Any] = {
        "metric": metrics.METRICS,
        "statistic": statistics.STATISTICS,
        "method": study.methods_of(experiment),
    }
    unit = study.workspace_of(study.experiments[experiment].problems[0]).unit
    lines: dict[tuple, int] = {}
    for number, row in rows:
        where = f"{here}: line {number}"
        for column in known.keys() & row.keys():
            check_known(row[column], known[column], f"{where}: {column}")
        for column in by_name:
            values = design.values([experiment], column)
            if not any(_is_same(row[column], value) for value in values):
                raise Fault(f"{where}: {column}: {row[column]}: unknown{closest('', values)}")
        _check_value(row["value"], where)
        if row["n"] and not re.fullmatch("[1-9][0-9]{0,6}", row["n"]):
            raise Fault(f"{where}: n: {row['n']!r}; expected how many runs the paper made")
        own = metrics.unit(row["metric"], unit)
        if row["unit"] != own:
            raise Fault(
                f"{where}: unit: {row['unit']!r}; expected {own}, the unit of {row['metric']}"
            )
        metric = table.reads.get(row["metric"], row["metric"])
        check_known(metric, metrics.METRICS, f"{location}: reads")
        design.check_metric([experiment], metric, f"{where}: metric")
        name = (*(row[key] for key in by_name), row["metric"], row["statistic"])
        if name in lines:
            raise Fault(
                f"{where}: the same keys, metric and statistic as line {lines[name]}; "
                "expected each once"
            )
        lines[name] = number
    printed = {row["metric"] for _, row in rows}
    for key, named in (("reads", table.reads), ("monotone", [m.metric for m in table.monotone])):
        for metric in named:
            check_known(metric, printed, f"{location}: {key}")
    for column in (*table.primary, *(rule.along for rule in table.monotone)):
        check_known(column, keys(study, table), f"{location}: primary or monotone")


def _is_same(text: str, value: Any) -> bool:
    """Whether a text of a file stands for a value."""
    if not is_number(value):
        return text == str(value)
    try:
        return float(text) == value
    except ValueError:
        return False


def _check_value(text: str, location: str, empty: bool = False) -> None:
    """A text is a number as papers print it."""
    printed = re.fullmatch(r"[-+]?[0-9]{0,15}\.?[0-9]{0,15}([eE][-+]?[0-9]{1,2})?", text)
    if not (printed and re.search("[0-9]", text)) and not (empty and not text):
        raise Fault(f"{location}: value: {text!r}; expected a number")
