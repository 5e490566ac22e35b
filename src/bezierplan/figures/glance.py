"""What is plain to the eye in a figure, in words: for those who do not see it, and as the
alternative text of a picture.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bezierplan.analysis import naming

if TYPE_CHECKING:
    import pandas as pd


def extremes(
    name: str, frame: pd.DataFrame, by: str, column: str, labels: dict[str, str], unit: str = ""
) -> str:
    """Which of several has the lowest and which the highest value, as a clause; nothing unless two
    have one. Values that are printed alike are the same.

    name: what the values are, such as `median`. frame: a row for each, with its name in the column
    `by` and its value in another one; those that are not finite are left out.
    """
    finite = frame[np.isfinite(frame[column])]
    if len(finite) < 2:
        return ""
    values = finite[column].map(_rounded)
    if values.min() == values.max():
        return f"{name} {_printed(values.min(), unit)} of all"
    ends = [
        " and ".join(naming.printed(value, by, labels) for value in finite[by][values == end])
        + f" ({_printed(end, unit)})"
        for end in (values.min(), values.max())
    ]
    return f"lowest {name}: {ends[0]}, highest: {ends[1]}"


def _rounded(value: float) -> float:
    return float(f"{value:.4g}") if abs(value) < 1e4 else round(value)


def _printed(value: float, unit: str) -> str:
    """A number to four digits, without powers of ten where it is large, with its unit."""
    number = f"{value:.4g}" if abs(value) < 1e4 else f"{value:,.0f}"
    return naming.amount(number, unit.strip("-")).strip()


def mostly(
    name: str, frame: pd.DataFrame, x: str, hue: str, labels: dict[str, str], unit: str = ""
) -> str:
    """Which value of a column alone has the lowest and which the highest `value` at most places, as
    a clause; as `extremes` at a single place, and nothing unless a place has two.
    """
    compared = frame.pivot(index=x, columns=hue, values="value").dropna(thresh=2)
    if len(compared) < 2:
        return extremes(name, frame[frame[x].isin(compared.index)], hue, "value", labels, unit)
    clauses, values = [], compared.map(_rounded, na_action="ignore")
    for end, best in (("lowest", values.min(axis=1)), ("highest", values.max(axis=1))):
        there = values.eq(best, axis=0)
        counts = there[there.sum(axis=1) == 1].sum()
        if counts.max():
            # The first of several in the order of the columns, whatever the order of the rows.
            winner = naming.printed(counts.idxmax(), hue, labels)
            clauses.append(f"{end} {name} in {counts.max()} of {len(compared)}: {winner}")
    return ", ".join(clauses)
