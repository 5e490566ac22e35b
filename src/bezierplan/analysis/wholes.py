"""Tables judged as wholes: the level of a column of printed numbers, their spread and their order,
each beside ours.

Columns: study, table, place (the other keys), metric, statistic, methods (how many), quantity,
printed, ours, chance. Level: the mean over methods; spread: the sample standard deviation,
which in print holds the chance of few runs as well. Order:
Spearman's rank correlation of the printed numbers with ours, in `printed`, and the chance of one as
far from 0 if all orders are equally likely.
"""

import itertools
import math

import numpy as np
import pandas as pd

from bezierplan.analysis import comparison

LEAST = 4
"""Methods that a column needs: of fewer, no order is unlikely."""

MOST = 8
"""Most methods whose orders are counted; the chance is NaN beyond."""

_KEYS = ["study", "table", "metric", "statistic"]


def of_numbers(numbers: pd.DataFrame) -> pd.DataFrame:
    """The wholes of all columns of means over methods. numbers: as from `summary.numbers`."""
    rows = []
    if "method" in numbers:
        chosen = numbers[
            numbers["primary"].astype(bool)
            & (numbers["statistic"] == "mean")
            & numbers[["in_range", "value_ours", "method"]].notna().all(axis=1)
        ]
        own = [*comparison.COLUMNS, "study", "table", "counted", "method", "profile"]
        places = list(numbers.columns.difference(own, sort=False))
        for keys, group in chosen.groupby([*_KEYS, *places], dropna=False, sort=False):
            if len(group) >= LEAST:
                found = dict(zip([*_KEYS, *places], keys))
                named = {name: found.pop(name) for name in places}
                where = ", ".join(
                    f"{key}={value}" for key, value in named.items() if value == value
                )
                rows += [
                    found | {"place": where, "methods": len(group)} | row for row in _of(group)
                ]
    columns = [*_KEYS[:2], "place", *_KEYS[2:], "methods", "quantity", "printed", "ours", "chance"]
    return pd.DataFrame(rows, columns=columns)


def _of(group: pd.DataFrame) -> list[dict]:
    """Level, spread and order of one column."""
    both = [group[name].to_numpy(dtype=float) for name in ("value_published", "value_ours")]
    order, chance = rank_correlation(*both)
    return [
        {"quantity": "level", "printed": both[0].mean(), "ours": both[1].mean()},
        {"quantity": "spread", "printed": both[0].std(ddof=1), "ours": both[1].std(ddof=1)},
        {"quantity": "order", "printed": order, "chance": chance},
    ]


def rank_correlation(first: np.ndarray, second: np.ndarray) -> tuple[float, float]:
    """Spearman's rank correlation of two columns (n,), and the share of all orders of one of them
    with a correlation as far from 0.
    """
    ranks = [pd.Series(each).rank().to_numpy() - (len(each) + 1) / 2 for each in (first, second)]
    size = math.sqrt(float(np.prod([each @ each for each in ranks])))
    if size == 0:
        return math.nan, math.nan
    found = float(ranks[0] @ ranks[1]) / size
    if len(first) > MOST:
        return found, math.nan
    every = np.array(list(itertools.permutations(ranks[0]))) @ ranks[1] / size
    return found, float(np.mean(np.abs(every) >= abs(found) - 1e-9))
