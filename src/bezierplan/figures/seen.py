"""What a figure shows, in words: for those who do not see it, and as the alternative text of a
picture.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd


def extremes(name: str, values: Mapping[str, float]) -> str:
    """Which of several has the lowest and which the highest value, as a clause; nothing unless two
    are known.

    name: what the values are, such as `median`. values: by the printed names of what is compared;
    those that are not finite are left out.
    """
    known = {key: value for key, value in values.items() if np.isfinite(value)}
    if len(known) < 2:
        return ""
    low, high = min(known.values()), max(known.values())
    if low == high:
        return f"{name} {_printed(low)} of all"
    lowest, highest = (
        " and ".join(key for key, value in known.items() if value == end) for end in (low, high)
    )
    ends = _printed(low), _printed(high)
    return f"lowest {name}: {lowest} ({ends[0]}), highest: {highest} ({ends[1]})"


def _printed(value: float) -> str:
    """A number to four digits, without powers of ten where it is large."""
    return f"{value:.4g}" if abs(value) < 1e4 else f"{value:,.0f}"


def mostly(name: str, table: pd.DataFrame) -> str:
    """Which column has the lowest and which the highest value in most rows, as a clause; as
    `extremes` for a single row, and nothing unless a row has two known values.

    table: a row per place of the comparison, a column per printed name of what is compared.
    """
    compared = table[table.notna().sum(axis=1) > 1]
    if compared.empty:
        return ""
    if len(compared) == 1:
        return extremes(name, compared.iloc[0].to_dict())
    ends = {"lowest": compared.idxmin(axis=1), "highest": compared.idxmax(axis=1)}
    clauses = []
    for end, columns in ends.items():
        # The first of several in the order of the columns, whatever the order of the rows.
        counts = columns.value_counts().reindex(table.columns, fill_value=0)
        clauses.append(f"{end} {name} in {counts.max()} of {len(compared)}: {counts.idxmax()}")
    return ", ".join(clauses)
