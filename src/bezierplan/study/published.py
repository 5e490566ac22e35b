"""Files of published numbers: checks that their columns, names and numbers fit the table that they are compared with."""

import csv
import io

from bezierplan.analysis import metrics, statistics
from bezierplan.schema.checked import Fault, closest, text_of
from bezierplan.study.artefacts import Pivot
from bezierplan.study.definition import relative
from bezierplan.study.design import Design

COLUMNS = ("metric", "statistic", "n", "unit", "value")
"""Columns that every file has; those left of them tell its rows apart."""


def check(design: Design, table: Pivot) -> None:
    """Raise Fault, with file, line, column and what would be right, for a file of published numbers that does not fit its table."""
    study, experiment = design.study, table.experiment
    file = study.folder / "published" / table.published
    place = relative(file)
    reader = csv.DictReader(io.StringIO(text_of(file, place), newline=""), restkey="")
    header = reader.fieldnames or []
    for column in COLUMNS:
        if column not in header:
            raise Fault(f"{place}: line 1: column {column} is missing; expected key columns, {', '.join(COLUMNS)}")
    for number, column in enumerate(header):
        if column in header[:number]:
            raise Fault(f"{place}: line 1: column {column} is listed twice")
        if column not in COLUMNS and column not in design.columns(experiment):
            raise Fault(f"{place}: line 1: column: {column}: unknown{closest(column, design.columns(experiment))}")
    keys = [column for column in header if column not in COLUMNS]
    known = {
        "metric": metrics.METRICS,
        "statistic": statistics.STATISTICS,
        "method": study.methods_of(experiment),
        "problem": study.problems_of(experiment, "full"),
    }
    for rule in table.monotone:
        if rule.along not in keys:
            raise Fault(f"{place}: line 1: column {rule.along} is missing; the table's key monotone has numbers in order along it")
    lines: dict[tuple, int] = {}
    try:
        rows = [(reader.line_num, row) for row in reader]
    except csv.Error as error:
        raise Fault(f"{place}: line {reader.line_num}: not csv ({error})") from None
    for number, row in rows:
        where = f"{place}: line {number}"
        if "" in row or None in row.values():
            raise Fault(f"{where}: expected {len(header)} values, one a column")
        for column in (name for name in known if name in row):
            if row[column] not in known[column]:
                raise Fault(f"{where}: {column}: {row[column]}: unknown{closest(row[column], known[column])}")
        _check_numbers(row, where)
        unit = metrics.unit(row["metric"], study.workspace_of(study.experiments[experiment].problems[0]).unit)
        if row["unit"] != unit:
            raise Fault(f"{where}: unit: {row['unit']!r}; expected {unit}, the unit of {row['metric']}")
        shown = {name for entry in table.values if entry.metric == row["metric"] for name in entry.statistics}
        if shown and row["statistic"] != "unstated" and row["statistic"] not in shown:
            raise Fault(f"{where}: statistic: {row['statistic']}: the table has none of {row['metric']}{closest(row['statistic'], shown)}")
        name = (*(row[key] for key in keys), row["metric"], row["statistic"])
        if name in lines:
            raise Fault(f"{where}: the same keys, metric and statistic as line {lines[name]}; expected each once")
        lines[name] = number


def _check_numbers(row: dict[str, str], place: str) -> None:
    if not _is_number(row["value"]):
        raise Fault(f"{place}: value: {row['value']!r}; expected a number")
    if row["n"] and not (row["n"].isascii() and row["n"].isdecimal() and int(row["n"]) >= 1):
        raise Fault(f"{place}: n: {row['n']!r}; expected how many runs the paper made, a whole number of at least 1, or nothing")


def _is_number(text: str) -> bool:
    # An exponent of three digits is no measurement, and would take exact arithmetic for ever.
    if len(text.lower().partition("e")[2].strip("+-0")) > 2:
        return False
    try:
        return abs(float(text)) < float("inf") and text.isascii()
    except ValueError:
        return False
