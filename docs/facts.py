"""The facts under the answer to a paper (`analysis.outcome.texts`), looked up in the tables of
docs/outcome: their values fill the text, and each fault is told.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from bezierplan.analysis import naming
from bezierplan.analysis.claims.by_reading import DEFAULT, SIDES
from bezierplan.analysis.outcome import texts
from bezierplan.analysis.results import select
from bezierplan.schema import checked

WORDS = {"title": 8, "text": 60}
"""The most words of each."""

# A number that a person typed; those of tables, figures, references and maps are names.
_TYPED = re.compile(
    r"(?<![\w.-])(?!(?<=Table )|(?<=Figure )|(?<=Ref. \[)|(?<=environment ))\d[\d.,]*"
)
_VALUE = re.compile(r"\{(\w+)(?:\.(low|high|holds|rows))?\}")


class FilledText(NamedTuple):
    """A title and a text whose numbers are filled in, and the faults of its facts."""

    title: str
    text: str
    faults: list[str]


def fill(text: texts.Text, tables: Mapping[str, pd.DataFrame]) -> FilledText:
    """Fill the values of facts into a text, and check the facts.

    tables: the rows of the study, by the names in `texts.TABLES`. Raises Fault for an unknown
    column.
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


def _find(fact: texts.Fact, tables: Mapping[str, pd.DataFrame]) -> tuple[list[str], dict[str, str]]:
    """Find the rows of a fact; return its faults, and the values that a text can show of it."""
    table = tables[fact.of]
    checked.check_all([*fact.where, *fact.each, fact.take], table, "verdict.yaml: column")
    rows = select(table, fact.where)
    values, faults = rows[fact.take], []
    word = next(name for name in texts.COMPARISONS if getattr(fact, name) is not None)
    side = getattr(fact, word)
    # A word is a column if the table has it.
    side = rows[side] if isinstance(side, str) and side in rows else side
    true = texts.COMPARISONS[word](values, side)
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


def _compare_readings(fact: texts.Fact, rows: pd.DataFrame, by_reading: pd.DataFrame) -> list[str]:
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


def _show(fact: texts.Fact, values: pd.Series, true: pd.Series) -> dict[str, str]:
    """Format the values of a fact for a text: by name, such as `low` or `rows`."""
    shown = {"holds": str(true.sum()), "rows": str(len(values))}
    if len(values) and pd.api.types.is_numeric_dtype(values):
        numbers = values.astype(float) * (100 if fact.percent else 1)
        for name, end in (("low", numbers.min()), ("high", numbers.max())):
            shown[name] = naming.format_number(end, fact.digits)
    if len(values) == 1:
        shown["value"] = shown.get("low", str(values.iloc[0]))
    return shown


def read_outcome_tables(folder: Path, study: str) -> dict[str, pd.DataFrame]:
    """Read the rows of a study from the tables of the outcome: of numbers, claims and their checks
    those that count.
    """
    tables = {}
    for name in texts.TABLES:
        files = (folder / f"{name}.csv", folder / f"{study}_{name}.csv")
        table = pd.read_csv(next(file for file in files if file.is_file()), low_memory=False)
        table = table[table["study"] == study]
        tables[name] = table[table["primary"].astype(bool)] if "primary" in table else table
    return tables
