"""The README's outcome, which is of scale extended, next to what a page of scale full shows: that
of docs/outcome, in a clone that has it.
"""

from typing import NamedTuple

import pandas as pd

from bezierplan.analysis import headline
from bezierplan.figures.page import OUTCOME, content
from bezierplan.figures.page.gather import cell, read


class Outcome(NamedTuple):
    """Tables of all studies: as from `summary.numbers`, `claims.judge` and
    `baseline_comparison.measured`.
    """

    numbers: pd.DataFrame
    claims: pd.DataFrame
    measured: pd.DataFrame

    def of(self, studies: list[str]) -> "Outcome":
        """That of some studies."""
        return Outcome(*(table[table["study"].isin(studies)] for table in self))


def kept() -> Outcome:
    """The outcome of all studies that it has."""
    return Outcome(*map(read, OUTCOME))


def sentences(readme: Outcome, titles: dict[str, str]) -> list[str]:
    """The headline of those of some studies that the outcome has. titles: by study."""
    known = {key: titles[key] for key in titles if key in set(readme.numbers["study"])}
    return headline.headline(*readme.of(list(known)), known).sentences


def beside(studies: dict[str, content.Study], readme: Outcome) -> dict[str, content.Study]:
    """Studies whose published numbers and claims have what the outcome says of them."""
    return {
        key: study.model_copy(
            update={
                "tables": [
                    _table(table, readme.numbers[readme.numbers["study"] == key])
                    for table in study.tables
                ],
                "claims": [
                    _claim(claim, readme.claims[readme.claims["study"] == key])
                    for claim in study.claims
                ],
            }
        )
        for key, study in studies.items()
    }


def _table(table: content.Table, numbers: pd.DataFrame) -> content.Table:
    rows = numbers[numbers["table"] == table.name].to_dict("records")
    return table.model_copy(update={"numbers": [_number(each, rows) for each in table.numbers]})


def _number(number: content.Number, rows: list[dict]) -> content.Number:
    wanted = number.keys | {"metric": number.metric, "statistic": number.statistic}
    row = next((row for row in rows if all(_equal(row.get(k), v) for k, v in wanted.items())), None)
    if row is None:
        return number
    scaled = cell(row["value_ours_scaled"])
    many = content.Extended(
        verdict=cell(row["verdict"]) or "",
        ours=cell(row["value_ours"]) if scaled is None else scaled,
        n=cell(row["n_ours"]),
    )
    return number.model_copy(update={"extended": many})


def _equal(stored: object, shown: content.Cell) -> bool:
    """Whether two keys are one, of which each table may have read the number in its own way."""
    value = cell(stored)
    return value == shown or (value is not None and shown is not None and str(value) == str(shown))


def _claim(claim: content.Claim, claims: pd.DataFrame) -> content.Claim:
    own = claims[(claims["id"] == claim.id) & claims["primary"].astype(bool)]
    if own.empty:
        return claim
    row = own.iloc[0]
    many = content.Extended(
        verdict=row["verdict"], holds=cell(row["holds"]) or "", n=cell(row["n"])
    )
    return claim.model_copy(update={"extended": many})
