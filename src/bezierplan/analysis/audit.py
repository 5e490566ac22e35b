"""A paper's own numbers against each other and against exact bounds: what cannot be, whatever was run.

Columns: study, item (table or text), place (which cell), rule (in words), printed, limit, consistent (does the number obey the rule?).
"""

import math

import pandas as pd

COLUMNS = ["study", "item", "place", "rule", "printed", "limit", "consistent"]

# Metrics that are lengths of paths or never less.
_AT_LEAST_A_LENGTH = ("length", "objective")
_PRINTED = ("metric", "statistic", "n", "unit", "value")


def below_bound(tables: dict[str, pd.DataFrame], bounds: dict[str, pd.DataFrame]) -> list[dict]:
    """Every published length against the exact shortest length of its problem.

    tables: published numbers, by table, as from `read_published`. bounds: of the same tables' experiments, a row a problem, its name as
    index. The allowance is half a unit of the last printed digit.
    """
    rows = []
    for name, table in tables.items():
        if "problem" not in table:
            continue
        keys = [column for column in table if column not in (*_PRINTED, "printed")]
        for _, row in table[table["metric"].isin(_AT_LEAST_A_LENGTH)].iterrows():
            bound = bounds[name]["bound"].get(row["problem"], math.nan)
            if math.isnan(bound):
                continue
            rows.append(
                {
                    "item": name,
                    "place": ", ".join(f"{key}={row[key]}" for key in keys),
                    "rule": "a path is no shorter than the shortest path",
                    "printed": row["value"],
                    "limit": bound,
                    "consistent": row["value"] + _half_a_digit(row["printed"]) >= bound,
                }
            )
    return rows


def _half_a_digit(printed: str) -> float:
    """Half a unit of the last digit of a number as it is printed."""
    return 0.5 * 10.0 ** -len(printed.partition(".")[2])


def read_published(file: str) -> pd.DataFrame:
    """Published numbers with a further column `printed`, their text, which keeps zeros at the end."""
    table = pd.read_csv(file)
    if "value" in table:
        table["printed"] = pd.read_csv(file, dtype=str)["value"]
    return table


def table(study: str, rows: list[dict]) -> pd.DataFrame:
    """The rows of an audit as a table with `COLUMNS`."""
    return pd.DataFrame([{"study": study, **row} for row in rows], columns=COLUMNS)
