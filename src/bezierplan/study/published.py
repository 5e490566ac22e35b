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
from bezierplan.study.files import inside

COLUMNS = ("metric", "statistic", "n", "unit", "value")
"""Columns that every file has; those left of them tell its rows apart."""
TIDY = frozenset({"metric", "statistic", "value"})
"""Columns by which claims find numbers in files of any other form."""

MOST_ROWS, MOST_COLUMNS = 5000, 100
"""Rows and columns of a file: each row is compared with the others, and drawn from 10,000 times."""
MOST_RUNS = 1_000_000
"""Runs behind a published number."""
MOST_DIGITS, LARGEST = 30, 1e12
"""Characters and size of a published number."""

_NUMBER = re.compile(r"[-+]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]{1,2})?")


class Rows(NamedTuple):
    """A file: its header, and its rows with the number of the line where each ends."""

    header: list[str]
    rows: list[tuple[int, dict[str, str]]]


def check_files(study: Study) -> None:
    """Raise Fault unless each file of a study's folder `published` is a table: a header of
    different names, and rows as long as it.
    """
    for file in study.published_files():
        name = Path(file).name
        inside(study.folder, f"published/{name}", f"{relative(study.folder / 'published')}: {name}")
        read(study.folder / "published" / name)


@cache
def read(file: Path) -> Rows:
    """A csv file. Raises Fault, with file and line."""
    location = relative(file)
    text = text_of(file, location)
    if odd := next((char for char in text if not char.isprintable() and char not in "\r\n"), None):
        raise Fault(
            f"{location}: line {text[: text.index(odd)].count(chr(10)) + 1}: has the character "
            f"{odd!r}; expected csv"
        )
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    lines: list[tuple[int, list[str]]] = []
    try:
        for row in reader:
            lines += [(reader.line_num, row)] if row else []
            if len(lines) > MOST_ROWS + 1:
                raise Fault(
                    f"{location}: line {reader.line_num}: expected at most {MOST_ROWS} rows"
                )
    except csv.Error as error:
        raise Fault(f"{location}: line {reader.line_num}: not csv ({error})") from None
    (_, header), *rows = lines or [(1, [])]
    if not lines:
        raise Fault(
            f"{location}: line 1: the file is empty; "
            "expected a header of columns, and rows below it"
        )
    if len(header) > MOST_COLUMNS:
        raise Fault(f"{location}: line 1: {len(header)} columns; expected at most {MOST_COLUMNS}")
    for number, column in enumerate(header):
        if column in header[:number]:
            raise Fault(f"{location}: line 1: column {column} is listed twice")
        if not column.strip():
            raise Fault(f"{location}: line 1: column {number + 1} has no name")
    if not rows:
        raise Fault(f"{location}: line 1: has no rows below it; expected at least one")
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


def rows_of(study: Study, name: str) -> list[dict[str, str]]:
    """The rows of a file of a study's folder `published`."""
    return [row for _, row in read(study.folder / "published" / name).rows]


def keys(study: Study, table: Pivot) -> list[str]:
    """The columns that tell the rows of a table's comparison apart."""
    given = read(study.folder / "published" / table.published).header if table.published else []
    levels = [
        level for level in (*table.index, *table.columns) if level not in ("value", "statistic")
    ]
    return list(dict.fromkeys([*(column for column in given if column not in COLUMNS), *levels]))


def check(design: Design, table: Pivot, told: str) -> None:
    """Raise Fault, with file, line, column and what would be right, for a file of published numbers
    that does not fit its table.

    told: where the table's description stands, for its keys that do not fit the file.
    """
    study, experiment = design.study, table.experiment
    file = study.folder / "published" / table.published
    location = relative(file)
    header, rows = read(file)
    for column in COLUMNS:
        if column not in header:
            raise Fault(
                f"{location}: line 1: column {column} is missing; expected key columns, "
                f"{', '.join(COLUMNS)}"
            )
    by_name = [column for column in header if column not in COLUMNS]
    for column in by_name:
        design.check_column([experiment], column, "column", f"{location}: line 1: column")
    for rule in table.monotone:
        if rule.along not in by_name:
            raise Fault(
                f"{location}: line 1: column {rule.along} is missing; the table's key monotone "
                "has numbers in order along it"
            )
    known = {
        "metric": metrics.METRICS,
        "statistic": statistics.STATISTICS,
        "method": study.methods_of(experiment),
        "problem": study.problems_of(experiment, "full"),
    }
    unit = study.workspace_of(study.experiments[experiment].problems[0]).unit
    chosen = design.rows(experiment)
    lines: dict[tuple, int] = {}
    for number, row in rows:
        where = f"{location}: line {number}"
        for column in (name for name in known if name in row):
            check_known(row[column], known[column], f"{where}: {column}")
        for column in by_name:
            _check_key(design, experiment, column, row[column], chosen, where)
        _check_numbers(row, where)
        design.check_metric(
            [experiment], table.reads.get(row["metric"], row["metric"]), f"{where}: metric"
        )
        own = metrics.unit(row["metric"], unit)
        if row["unit"] != own:
            raise Fault(
                f"{where}: unit: {row['unit']!r}; expected {own}, the unit of {row['metric']}"
            )
        shown = {
            name
            for entry in table.values
            if entry.metric == row["metric"]
            for name in entry.statistics
        }
        if shown and row["statistic"] != "unstated" and row["statistic"] not in shown:
            raise Fault(
                f"{where}: statistic: {row['statistic']}: the table has none of "
                f"{row['metric']}{closest(row['statistic'], shown)}"
            )
        name = (*(row[key] for key in by_name), row["metric"], row["statistic"])
        if name in lines:
            raise Fault(
                f"{where}: the same keys, metric and statistic as line {lines[name]}; "
                "expected each once"
            )
        lines[name] = number
    printed = {(row["metric"], row["statistic"]) for _, row in rows}
    for metric in table.reads:
        if metric not in {name for name, _ in printed}:
            raise Fault(
                f"{told}: reads: {metric}: "
                f"unknown{closest(metric, {name for name, _ in printed})}, metrics in {location}"
            )
    for number, rule in enumerate(table.monotone):
        if (rule.metric, rule.statistic) not in printed:
            raise Fault(
                f"{told}: monotone: {number}: {location} has no {rule.statistic} of "
                f"{rule.metric}, which must rise or fall"
            )


def _check_key(
    design: Design,
    experiment: str,
    column: str,
    text: str,
    rows: list[dict[str, Any]],
    location: str,
) -> None:
    """A text names a value of a key column."""
    if column == "repeat":
        values: list[Any] = list(range(design.study.experiments[experiment].repeats["full"]))
    else:
        values = design.values([experiment], column, rows)
    if not any(_is_same(text, value) for value in values):
        raise Fault(f"{location}: {column}: {text!r}: unknown{closest(text, values)}")


def _is_same(text: str, value: Any) -> bool:
    """Whether a text of a file stands for a value."""
    if is_number(value):
        return bool(_NUMBER.fullmatch(text)) and float(text) == value
    return text == str(value)


def _check_numbers(row: dict[str, str], location: str) -> None:
    _check_value(row["value"], location)
    n = row["n"]
    if n and not (
        n.isascii() and n.isdecimal() and len(n) <= MOST_DIGITS and 1 <= int(n) <= MOST_RUNS
    ):
        wanted = f"a whole number from 1 to {MOST_RUNS}, or nothing"
        raise Fault(
            f"{location}: n: {n[:MOST_DIGITS]!r}; expected how many runs the paper made, {wanted}"
        )
    value, metric, statistic = float(row["value"]), metrics.METRICS[row["metric"]], row["statistic"]
    # What no paper can mean. A number that contradicts a map, the paper's own rule or another
    # number is a matter of the audit.
    spread = statistic in ("std", "iqr", "range")
    signed = (
        not spread
        and not isinstance(metric.least, str)
        and metric.least < 0
        and statistic not in ("count", "share")
    )
    least = -LARGEST if signed else 0.0
    most = {"share": 1.0, "count": float(n or MOST_RUNS)}.get(statistic, LARGEST)
    if not least <= value <= most:
        limits = f"a number of at least {least:g}" + (
            f", at most {most:g}" if most < LARGEST else ""
        )
        raise Fault(
            f"{location}: value: {row['value']}: expected {limits}, as the {statistic} of "
            f"{row['metric']} is"
        )
    if statistic == "count" and not value.is_integer():
        raise Fault(
            f"{location}: value: {row['value']}: expected a whole number, as the count of "
            f"{row['metric']} is"
        )


def _check_value(text: str, location: str, empty: bool = False) -> None:
    """A text is a number as papers print it. An exponent of three digits is no measurement, and
    exact arithmetic with it never ends.
    """
    if empty and not text:
        return
    if len(text) > MOST_DIGITS or not _NUMBER.fullmatch(text) or abs(float(text)) > LARGEST:
        wanted = (
            f"a number in ASCII digits, of at most {MOST_DIGITS} characters, at most "
            f"{LARGEST:g} in absolute value"
        )
        raise Fault(f"{location}: value: {text[:MOST_DIGITS]!r}; expected {wanted}")
