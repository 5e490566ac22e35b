"""Checks of the files of published numbers: each is a csv table whose columns, names and numbers
fit the table that they are compared with.
"""

import csv
import io
import math
import re
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from bezierplan.analysis import metrics
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.places import shorten_path
from bezierplan.schema.checked import Fault, check_all, check_known, read_text
from bezierplan.schema.model import is_number
from bezierplan.study.definition import Study
from bezierplan.study.design import Design

COLUMNS = ("metric", "statistic", "n", "unit", "value")
"""Columns that every such file has; the columns left of them identify a row."""
TIDY = frozenset({"metric", "statistic", "value"})
"""Columns by which claims find numbers in files of any other form."""


@cache
def read(file: Path) -> dict[int, dict[str, str]]:
    """Return the rows of a csv file by the number of the line where each ends.

    Raises Fault, naming file and line, for anything but a table whose header has different names.
    """
    location = shorten_path(file)
    # Strict: otherwise an open quote takes the rest of the file for one cell, without a word.
    reader = csv.DictReader(io.StringIO(read_text(file, location), newline=""), strict=True)
    lines = {}
    try:
        for row in reader:
            lines[reader.line_num] = row
    except csv.Error as error:
        raise Fault(f"{location}: line {reader.reader.line_num}: not csv ({error})") from None
    if not lines:
        raise Fault(f"{location}: line 1: expected a header of columns, and rows below it")
    header = reader.fieldnames
    # Otherwise the message would call columns missing that stand there between other signs.
    if len(header) == 1 and re.search("[;\t]", header[0]):
        raise Fault(f"{location}: line 1: expected a comma between two columns")
    if len({*header}) < len(header) or not all(header):
        raise Fault(f"{location}: line 1: {', '.join(header)}: expected names, each once")
    for number, row in lines.items():
        # What a row has too much stands under None, and None for what it lacks.
        if None in [*row, *row.values()]:
            raise Fault(f"{location}: line {number}: expected {len(header)} values, one a column")
        if row.keys() >= TIDY and row["value"] and not is_number(_read(row["value"])):
            raise Fault(f"{location}: line {number}: value: {row['value']!r}; expected a number")
    return lines


def check(study: Study, design: Design, table: Pivot) -> None:
    """Raise Fault for a file of published numbers that does not fit its table, or a table that does
    not fit its file. The message names file, line and column, and says what is expected.
    """
    file = study.folder / "published" / table.published
    here, lines = shorten_path(file), read(file)
    header = [*next(iter(lines.values()))]
    for column in COLUMNS:
        if column not in header:
            raise Fault(f"{here}: line 1: column {column} is missing; expected all of {COLUMNS}")
    keys = [column for column in header if column not in COLUMNS]
    for column in keys:
        design.check_column(column, "column", f"{here}: line 1: column")
        if column not in [*table.key_columns, *table.where, *table.primary] and (
            len({row[column] for row in lines.values()}) > 1
        ):
            raise Fault(
                f"index: {column} tells rows of {here} apart; expected it in index or columns"
            )
    known = {column: design.values(column) for column in keys}
    if "repeat" in known:
        # The design has the first repeat only.
        known["repeat"] = range(design.repeats)
    shown = {
        f"{value.metric} {statistic}"
        for each in study.find_published_tables().values()
        if each.published == table.published
        for value in each.values
        for statistic in (*value.statistics, "unstated")
    }
    unit = study.workspace_of(study.experiments[table.experiment].problems[0]).unit
    places = {}
    for number, row in lines.items():
        where = f"{here}: line {number}"
        for column, values in known.items():
            if row[column] not in values and _read(row[column]) not in values:
                check_known(row[column], values, f"{where}: {column}")
        metric = table.reads.get(row["metric"], row["metric"])
        check_known(f"{metric} {row['statistic']}", shown, f"{where}: metric and statistic")
        of_metric = metrics.find_unit(row["metric"], unit)
        share, least = row["statistic"] == "share", metrics.METRICS[metric].least
        # `least` may name a column of the runs table, which printed numbers do not have.
        low = 0.0 if share or isinstance(least, str) else min(least, 0.0)
        for column, fits, wanted in (
            (
                "value",
                row["value"] and low <= float(row["value"]) <= (1.0 if share else math.inf),
                f"a number of at least {low:g}{' and at most 1' * share}, a {row['statistic']} of "
                f"{metric}",
            ),
            ("n", re.fullmatch("([1-9][0-9]*)?", row["n"]), "how many runs the paper made"),
            ("unit", row["unit"] == of_metric, f"{of_metric}, the unit of {row['metric']}"),
        ):
            if not fits:
                raise Fault(f"{where}: {column}: {row[column]!r}; expected {wanted}")
        place = tuple(row[key] for key in (*keys, "metric", "statistic"))
        if places.setdefault(place, number) != number:
            raise Fault(
                f"{where}: the same keys, metric and statistic as line {places[place]}; "
                "expected each once"
            )
    printed = {row["metric"] for row in lines.values()}
    check_all(table.reads, printed, "reads")
    check_all([rule.metric for rule in table.monotone], printed, "monotone")
    check_all([rule.along for rule in table.monotone], {*keys, *table.key_columns}, "monotone")


def _read(text: str) -> Any:
    """Return the number that a cell of the file holds, or the text if it is none."""
    # Python would read 1_000 as a number; in a table it is a name.
    with suppress(ValueError):
        return text if "_" in text else float(text)
    return text
