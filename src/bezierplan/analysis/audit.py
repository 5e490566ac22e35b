"""A paper's own numbers checked against each other and against exact bounds: contradictions that need no runs.

Columns: study, item (table or text), place (which cell), rule (in words), printed, limit, consistent (whether the number obeys the rule).
"""

import math

import pandas as pd

from bezierplan.analysis.results import published_table

COLUMNS = ["study", "item", "place", "rule", "printed", "limit", "consistent"]

# Metrics that are path lengths or never less, and their statistics that need not be the value of any single path.
_AT_LEAST_A_LENGTH = ("length", "objective")
_SPREADS = ("std", "iqr", "range")
_PRINTED = ("metric", "statistic", "n", "unit", "value")


def below_bound(tables: dict[str, pd.DataFrame], bounds: dict[str, pd.DataFrame], primary: dict[str, dict]) -> list[dict]:
    """Check every published length against the exact shortest length of its problem.

    tables: published numbers, by table, as from `read_published`. bounds: of the same tables' experiments, one row per problem, indexed by
    name. primary: of a table, column -> the value of the primary reading. The allowance is half a unit of the last printed digit.

    A number's problem is the one that its row names, as problem or as workspace; without either, that of the primary reading, or the only
    one of the experiment. Numbers that cover several problems are left out.
    """
    rows = []
    for name, table in tables.items():
        keys = [column for column in table if column not in (*_PRINTED, "printed")]
        for _, row in table[table["metric"].isin(_AT_LEAST_A_LENGTH) & ~table["statistic"].isin(_SPREADS)].iterrows():
            bound = bounds[name]["bound"].get(_problem(primary.get(name, {}) | row.to_dict(), bounds[name]), math.nan)
            if math.isnan(bound):
                continue
            rows.append(
                {
                    "item": name,
                    "place": ", ".join([*(f"{key}={row[key]}" for key in keys), f"metric={row['metric']}, statistic={row['statistic']}"]),
                    "rule": "a path is no shorter than the shortest path",
                    "printed": row["value"],
                    "limit": bound,
                    "consistent": row["value"] + _half_a_digit(row["printed"]) >= bound,
                }
            )
    return rows


def _problem(place: dict, bounds: pd.DataFrame) -> str | None:
    """The problem of a published number, from the columns that describe it; None if it is ambiguous."""
    named = place.get("problem", place.get("workspace"))
    return named if named in bounds.index else bounds.index[0] if named is None and len(bounds) == 1 else None


def _half_a_digit(printed: str) -> float:
    """Half a unit of the last printed digit of a number."""
    return 0.5 * 10.0 ** -len(printed.partition(".")[2])


def read_published(file: str) -> pd.DataFrame:
    """Published numbers with an extra column `printed`, their text, which keeps trailing zeros."""
    table = published_table(file)
    if "value" in table:
        table["printed"] = pd.read_csv(file, dtype=str)["value"]
    return table


def table(study: str, rows: list[dict]) -> pd.DataFrame:
    """The rows of an audit as a table with `COLUMNS`."""
    return pd.DataFrame([{"study": study, **row} for row in rows], columns=COLUMNS)
