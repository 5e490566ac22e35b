"""What follows for a paper: a few sentences and one small table, from a study's `verdict.yaml`.

Its sentences have values in braces, each taken from a table of results, and conditions without
which they do not follow: a sentence whose conditions fail is left out.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import pandas as pd
from pydantic import Field, model_validator

from bezierplan.analysis.audit.rows import RELATIONS
from bezierplan.analysis.markdown import table_text
from bezierplan.analysis.results import select
from bezierplan.schema import checked
from bezierplan.schema.model import Model, build_error, match_text, parse

TAKES = {
    "min": pd.Series.min,
    "max": pd.Series.max,
    "mean": pd.Series.mean,
    "median": pd.Series.median,
    "sum": pd.Series.sum,
    "count": len,
    "only": pd.Series.item,
}
Files = Mapping[str, tuple[str, Mapping[str, str]]]
"""By study, the file of its sentences, and its labels."""
Source = Literal["numbers", "claims", "audit", "wholes", "baseline", "worth"]


class Value(Model):
    """A value of a sentence: of the rows of a table of results, a column, and what is taken."""

    of: Source
    where: dict[str, Any] = Field({})
    column: str
    take: Literal[tuple(TAKES)] = Field("only")
    part: str = Field(None)
    """A pattern whose group in the column's text is the number; cells without it do not count."""

    def found(self, tables: dict[str, pd.DataFrame]) -> Any:
        """The value in tables of results."""
        column = _rows(tables[self.of], self.where, self.column)[self.column]
        if self.part:
            column = column.str.extract(self.part, expand=False).dropna().astype(float)
        return TAKES[self.take](column)


class Sentence(Model):
    """A sentence: its text, its values by name, and conditions, such as `p < 0.05`."""

    text: str
    values: dict[str, Value] = Field({})
    holds: list[
        Annotated[
            str,
            match_text(
                r"\w+ ([<>]=?|==) .+",
                "a value, a relation, and what it is compared with, such as p < 0.05",
            ),
        ]
    ] = Field([])

    @model_validator(mode="after")
    def _check_names(self) -> "Sentence":
        try:
            self.text.format(**dict.fromkeys(self.values, 1))
            for condition in self.holds:
                self.values[condition.split()[0]]
        except (LookupError, ValueError) as error:
            raise build_error(f"{error}: expected values, of {', '.join(self.values)}") from None
        return self


class VerdictTable(Model):
    """The small table: rows of a table of results, and its columns by heading."""

    of: Source
    where: dict[str, Any] = Field({})
    columns: dict[str, str]


class VerdictFile(Model):
    """What follows for a paper."""

    sentences: list[Sentence]
    table: VerdictTable


class Follows(NamedTuple):
    """A sentence with its values, and the condition that fails, if one does."""

    text: str
    fails: str | None


def read(file: str | Path) -> VerdictFile:
    """The verdict of a study, from its file. Raises Fault."""
    return parse(VerdictFile, checked.read(Path(file)), str(file))


def _rows(table: pd.DataFrame, where: dict[str, Any], *columns: str) -> pd.DataFrame:
    """Some rows of a table of results. Raises Fault for a column that it does not have."""
    checked.check_all([*where, *columns], table, "verdict.yaml: column")
    return select(table, where)


def sentences(verdict: VerdictFile, tables: dict[str, pd.DataFrame]) -> list[Follows]:
    """The sentences of a study with their values. tables: those of the study, by `Source`."""
    return [_sentence(each, tables) for each in verdict.sentences]


def _sentence(sentence: Sentence, tables: dict[str, pd.DataFrame]) -> Follows:
    try:
        values = {name: value.found(tables) for name, value in sentence.values.items()}
    except checked.Fault:
        raise
    except (ValueError, KeyError, AttributeError) as error:
        return Follows(sentence.text, f"a value is missing: {error}")
    if missing := [name for name, value in values.items() if value != value]:
        return Follows(sentence.text, f"a value is missing: {', '.join(missing)}")
    for condition in sentence.holds:
        first, relation, second = condition.split(maxsplit=2)
        sides = [values[first], values.get(second, second)]
        if not isinstance(sides[0], str):
            sides[1] = float(sides[1])
        if not RELATIONS[relation](*sides):
            return Follows(sentence.text, f"{condition}: {sides[0]} and {sides[1]}")
    text = sentence.text.format(**values)
    # The format of Python has no blank before the sign.
    return Follows(re.sub(r"(?<=[0-9])%", " %", text), None)


def markdown(
    verdict: VerdictFile, tables: dict[str, pd.DataFrame], labels: Mapping[str, str]
) -> str:
    """The sentences that follow, and the table with labels in place of names."""
    follow = [each.text for each in sentences(verdict, tables) if each.fails is None]
    headings = {column: heading for heading, column in verdict.table.columns.items()}
    rows = _rows(tables[verdict.table.of], verdict.table.where, *headings)
    shown = rows[list(headings)].replace(dict(labels)).rename(columns=headings)
    for heading in shown.dropna(axis=1, how="all").select_dtypes("number"):
        values = shown[heading]
        # A printed number is looked up in the paper; of the others four digits of the largest.
        as_printed = heading == headings.get("value_published") or (values.dropna() % 1 == 0).all()
        decimals = max(0, 3 - int(np.log10(values.abs().max())))
        form = "{:.10g}" if as_printed else f"{{:.{decimals}f}}"
        shown[heading] = values.map(form.format, na_action="ignore")
    first, *_ = shown
    return " ".join(follow) + "\n\n" + table_text(shown.fillna("").set_index(first)) + "\n"


def own_rows(tables: dict[str, pd.DataFrame], study: str) -> dict[str, pd.DataFrame]:
    """The rows of one study that count."""
    own = {name: table[table["study"] == study] for name, table in tables.items()}
    return own | {
        name: own[name][own[name]["primary"].astype(bool)] for name in ("numbers", "claims")
    }
