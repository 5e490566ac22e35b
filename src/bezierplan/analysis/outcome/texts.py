"""The answer to a paper, as a person writes it in a study's `verdict.yaml`: a title, a short text,
and the facts under it. A fact is an address in a table of the outcome, the number of rows that it
must find there, and one comparison that must hold in them.
"""

import operator
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, NamedTuple

import pandas as pd
from pydantic import Field, model_validator

from bezierplan.analysis import naming
from bezierplan.analysis.claims.by_reading import DEFAULT, SIDES
from bezierplan.analysis.results import select
from bezierplan.schema import checked
from bezierplan.schema.model import Model, build_error, parse

WORDS = {"title": 8, "text": 60}
"""The most words of each."""
COMPARISONS = {"equals": operator.eq, "above": operator.gt, "below": operator.lt}
TABLES = (
    *("numbers", "claims", "claim_checks", "claims_by_reading", "methods", "audit", "settings"),
)

# A number that a person typed; those of tables, figures and maps are names.
_TYPED = re.compile(r"(?<![\w.-])(?!(?<=Table )|(?<=Figure )|(?<=environment ))\d[\d.,]*")
_VALUE = re.compile(r"\{(\w+)(?:\.(low|high|holds|rows))?\}")


class Fact(Model):
    """A comparison that must hold in some rows of a table of the outcome, all of the study."""

    of: Literal[TABLES]
    where: dict[str, Any] = Field({}, description="column: value, or values; left out: all rows")
    each: list[str] = Field([], description="columns that name a row: none may be there twice")
    rows: int = Field(1, description="how many rows there must be; left out: 1")
    take: str = Field(description="the column that is compared")
    equals: Any = Field(None, description="a value, or the name of a column")
    above: Any = Field(None, description="a number, or the name of a column")
    below: Any = Field(None, description="a number, or the name of a column")
    holds: int = Field(None, description="in how many rows it must hold; left out: in all")
    pools: int = Field(
        1,
        description="how many drawn fields a row is the mean of; left out: 1, a row pools nothing",
    )
    percent: bool = Field(False, description="true to show a share in per cent")
    digits: int = Field(2, description="significant digits that are shown; left out: 2")
    turned_by: list[str] = Field(
        [], description="joint readings under which the claim is decided the other way"
    )

    @model_validator(mode="after")
    def _check_comparison(self) -> "Fact":
        """Refuse a fact without exactly one comparison."""
        if sum(getattr(self, name) is not None for name in COMPARISONS) != 1:
            raise build_error(f"expected one of {', '.join(COMPARISONS)}")
        return self


class Text(Model):
    """The answer to a paper: a title, a short text, and the facts under it."""

    title: str = Field(description="at most eight words that answer")
    text: str = Field(
        description="at most 60 words; in braces the value of a fact, or its low, high, holds, rows"
    )
    facts: dict[str, Fact] = Field(description="by name")


class FilledText(NamedTuple):
    """A title and a text whose numbers are filled in, and the faults of its facts."""

    title: str
    text: str
    faults: list[str]


def read(file: str | Path) -> Text:
    """Read the answer of a study from its `verdict.yaml`. Raises Fault."""
    return parse(Text, checked.read(Path(file)), str(file))


def fill(text: Text, tables: Mapping[str, pd.DataFrame]) -> FilledText:
    """Fill the values of facts into a text, and check the facts.

    tables: the rows of the study, by the names in `TABLES`. Raises Fault for an unknown column.
    """
    faults, values = [], {}
    for name, fact in text.facts.items():
        of_fact, values[name] = _find(fact, tables)
        faults += [f"{name}: {fault}" for fault in of_fact]
    for name, most in WORDS.items():
        written = getattr(text, name)
        if (count := len(re.findall(r"[\w{][^\s]*", written))) > most:
            faults.append(f"{name}: {count} words; expected at most {most}")
        typed = _TYPED.findall(_VALUE.sub("", written))
        faults += [f"{name}: {number} is typed; expected a fact in braces" for number in typed]

    def fill_value(braces: re.Match) -> str:
        """Return the text of a fact that stands in braces."""
        known = values.get(braces[1], {})
        if (part := braces[2] or "value") not in known:
            faults.append(f"text: {braces[0]}: expected a fact that has it")
        return known.get(part, braces[0])

    shown = " ".join(_VALUE.sub(fill_value, text.text).split())
    return FilledText(text.title, shown, faults)


def _find(fact: Fact, tables: Mapping[str, pd.DataFrame]) -> tuple[list[str], dict[str, str]]:
    """Find the rows of a fact; return its faults, and the values that a text can show of it."""
    table = tables[fact.of]
    checked.check_all([*fact.where, *fact.each, fact.take], table, "verdict.yaml: column")
    rows = select(table, fact.where)
    values, faults = rows[fact.take], []
    word = next(name for name in COMPARISONS if getattr(fact, name) is not None)
    side = getattr(fact, word)
    # A word is a column if the table has it.
    side = rows[side] if isinstance(side, str) and side in rows else side
    true = COMPARISONS[word](values, side)
    if len(rows) != fact.rows:
        faults.append(f"finds {len(rows)} rows; expected {fact.rows}")
    if fact.each and rows.duplicated(fact.each).any():
        faults.append(f"several rows have the same {', '.join(fact.each)}")
    wanted = fact.rows if fact.holds is None else fact.holds
    if true.sum() != wanted:
        faults.append(f"holds in {true.sum()} of {len(rows)} rows; expected {wanted}")
    if "conditions" in rows and (pooled := rows["conditions"].fillna(1) != fact.pools).any():
        faults.append(f"a row pools {rows['conditions'][pooled].iloc[0]:.0f} conditions")
    faults += _compare_readings(fact, rows, tables["claims_by_reading"])
    return faults, _show(fact, values, true)


def _compare_readings(fact: Fact, rows: pd.DataFrame, by_reading: pd.DataFrame) -> list[str]:
    """Compare the readings that a fact names with those that turn its claim, and return
    the faults.
    """
    if fact.of not in ("claims", "claim_checks") or rows.empty:
        return []
    own = select(by_reading, {"id": rows["id"].iloc[0]})
    verdict = "verdict"
    # A fact about one check depends on the verdict on that check.
    if fact.of == "claim_checks":
        own, verdict = own[own["check"] == rows["check"].iloc[0]], "verdict_on_check"
    # A reading that leaves the claim undecided has no side.
    sides = own.drop_duplicates("reading").set_index("reading")[verdict].map(SIDES).dropna()
    turned = sides[sides != sides[DEFAULT]] if DEFAULT in sides else sides[:0]
    if {*turned.index} == {*fact.turned_by}:
        return []
    return [f"turned by the readings {', '.join(turned.index) or 'none'}"]


def _show(fact: Fact, values: pd.Series, true: pd.Series) -> dict[str, str]:
    """Format the values of a fact for a text: by name, such as `low` or `rows`."""
    shown = {"holds": str(true.sum()), "rows": str(len(values))}
    if len(values) == 1:
        shown["value"] = str(values.iloc[0])
    if len(values) and pd.api.types.is_numeric_dtype(values):
        numbers = values.astype(float) * (100 if fact.percent else 1)
        ends = {"low": numbers.min(), "high": numbers.max()}
        shown |= {name: naming.format_number(end, fact.digits) for name, end in ends.items()}
        shown |= {"value": shown["low"]} if len(values) == 1 else {}
    return shown


def read_outcome_tables(folder: Path, study: str) -> dict[str, pd.DataFrame]:
    """Read the rows of a study from the tables of the outcome: of numbers, claims and their checks
    those that count.
    """
    tables = {}
    for name in TABLES:
        files = (folder / f"{name}.csv", folder / f"{study}_{name}.csv")
        table = pd.read_csv(next(file for file in files if file.is_file()), low_memory=False)
        table = table[table["study"] == study]
        tables[name] = table[table["primary"].astype(bool)] if "primary" in table else table
    return tables
