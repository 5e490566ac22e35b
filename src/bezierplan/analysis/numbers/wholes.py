"""Tables judged as wholes: of a column of printed means, one for each of several methods, the
level, the spread, the order, and how far each mean deviates from their mean, beside experiments of
the paper's size that are drawn from our runs.

Methods that start alike, or plan on the same random maps, have good and bad luck together. So whole
repeats are drawn, each with the runs of all methods (`together`); otherwise each method's runs on
their own. An experiment prints the mean of those of its runs that count, rounded like the paper's.

Columns: study, table, place (the other keys, as JSON), metric, methods (how many), quantity,
printed, ours (the median of experiments), low95_predicted, high95_predicted, in_range, chance (the
two-sided share of experiments that lie as far out), chance_any_order, outside, together, why.

- level: the mean over methods; spread: the sample standard deviation; order: Spearman's rank
  correlation with our means. chance_any_order: the same among orders drawn by chance
- deviations: how many means, less the mean of all, lie outside their intervals, and which
  (`outside`). chance: the share of experiments whose sum of squared standardized deviations is as
  large. `deviations of the others`: the same without the mean that lies farthest out
- why: as in the comparison, where the map or the quantity is not the paper's. Then the row says
  what holds on our map or by our definition, and decides nothing
"""

import json
from collections.abc import Iterator

import numpy as np
import pandas as pd

from bezierplan.analysis import statistics
from bezierplan.analysis.audit.rows import place
from bezierplan.analysis.numbers import comparison, tables
from bezierplan.analysis.results import Results, keys_of
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.workspaces.seeds import generator

LEAST = 4
"""Methods that a column needs: of fewer, no order is unlikely."""

COLUMNS = [
    "study",
    "table",
    "place",
    "metric",
    "methods",
    "quantity",
    "printed",
    "ours",
    "low95_predicted",
    "high95_predicted",
    "in_range",
    "chance",
    "chance_any_order",
    "outside",
    "together",
    "why",
]

REASONS = {comparison.UNDEFINED, comparison.NO_MAP, comparison.ONE_DRAW, comparison.FITTED}

_EXACT = 1e-9
"""Numbers this near are equal."""


def of_table(
    results: Results, spec: Pivot, numbers: pd.DataFrame, name: str, paired: bool
) -> pd.DataFrame:
    """The wholes of all columns of means of a table.

    numbers: as from `comparison.compare`. name: `study/table`, which seeds the draws. paired:
    whether runs with equal repeat numbers start alike.
    """
    keys = keys_of(numbers)
    means = numbers[numbers["primary"] & (numbers["statistic"] == "mean")]
    means = means.dropna(subset=["in_range", "value_ours"]).astype(dict.fromkeys(keys, object))
    rows = []
    if "method" in keys and len(means):
        cell = [*keys, "metric", "statistic"]
        ours = tables.cells(results, spec, keys)[[*cell, "decimals", "draws", "by_run"]]
        column = [key for key in cell if key not in ("method", "statistic")]
        for (*values, metric), group in means.merge(ours).groupby(column, sort=False):
            if len(group) >= LEAST:
                where = dict(zip(column, values))
                told = [*name.split("/"), json.dumps(where), metric, len(group)]
                same = dict(zip(COLUMNS, told))
                same["together"] = paired or bool((group["draws"] > 1).all())
                same["why"] = max(REASONS.intersection(group["why"]), default="")
                rng = generator(f"{name}/{place(where, where)}/{metric}/wholes")
                rows += [same | row for row in _of(group, same["together"], rng)]
    return pd.DataFrame(rows, columns=COLUMNS)


def experiments(
    group: pd.DataFrame, together: bool, rng: np.random.Generator
) -> tuple[np.ndarray, float]:
    """The means that experiments of the paper's size print, (experiments, methods), and the tail to
    leave out at each end. group: a row for each method, with `by_run` (`tables.cells`).
    """
    parts = group["by_run"].to_list()
    if together:
        parts = [pd.concat(parts, axis=1, join="inner")]
    size = min(int(group["n_published"].fillna(1).min()), statistics.MOST_PREDICTED)
    means = []
    for values in (part.to_numpy().reshape(len(part), -1) for part in parts):
        sums = np.hstack([np.nan_to_num(values), ~np.isnan(values)])
        total, share = np.split(statistics.predicted("mean", sums, size, rng), 2, axis=1)
        with np.errstate(invalid="ignore"):  # of an experiment none of whose runs counts
            means.append(total / share)
    table = np.round(np.hstack(means), group["decimals"].iloc[0])
    tail = statistics.expanded_tail(min(map(len, parts)))
    return table[~np.isnan(table).any(axis=1)], tail


def _of(group: pd.DataFrame, together: bool, rng: np.random.Generator) -> Iterator[dict]:
    """The rows of one column."""
    means, tail = experiments(group, together, rng)
    every = np.vstack([group["value_published"], means])
    yield _placed("level", every.mean(axis=1), tail)
    yield _placed("spread", every.std(axis=1, ddof=1), tail)
    orders = rng.permuted(np.tile(every[0], (statistics.DRAWS, 1)), axis=1)
    correlations = rank_correlations(np.vstack([every, orders]), group["value_ours"])
    order, by_chance = np.split(correlations, [len(every)])
    any_order = _share(np.abs(by_chance) >= abs(order[0]) - _EXACT)
    yield _placed("order", order, tail) | {"chance_any_order": any_order}
    yield from _deviations(every, group["method"].to_numpy(), tail)


def _deviations(means: np.ndarray, methods: np.ndarray, tail: float) -> Iterator[dict]:
    """The rows of the first of some rows of means (n, k), less the mean of all, among the other
    rows, experiments; then without the mean that lies farthest out.
    """
    for quantity in ("deviations", "deviations of the others"):
        off = means - means.mean(axis=1, keepdims=True)
        low, high = np.quantile(off[1:], [tail, 1 - tail], axis=0)
        outside = (off[0] < low - _EXACT) | (off[0] > high + _EXACT)
        scale = np.maximum(off[1:].std(axis=0), _EXACT)
        squares = ((off - off[1:].mean(axis=0)) / scale) ** 2
        sums = squares.sum(axis=1)
        chance = _share(sums[1:] >= sums[0])
        yield {
            "quantity": quantity,
            "methods": len(methods),
            "printed": outside.sum(),
            "in_range": chance >= 2 * tail,
            "chance": chance,
            "outside": ", ".join(methods[outside]),
        }
        farthest = squares[0].argmax()
        means, methods = (np.delete(each, farthest, axis=-1) for each in (means, methods))


def _placed(quantity: str, values: np.ndarray, tail: float) -> dict:
    """The first of values (n,) among the others; ties count in its favour."""
    printed, others = values[0], values[1:][~np.isnan(values[1:])]
    low, median, high = np.quantile(others, [tail, 0.5, 1 - tail])
    beyond = min(_share(others <= printed + _EXACT), _share(others >= printed - _EXACT))
    return {
        "quantity": quantity,
        "printed": printed,
        "ours": median,
        "low95_predicted": low,
        "high95_predicted": high,
        "in_range": beyond >= tail,
        "chance": min(2 * beyond, 1.0),
    }


def rank_correlations(rows: np.ndarray, column: np.ndarray) -> np.ndarray:
    """Spearman's rank correlation of each of some rows (n, k) with a column (k,): (n,). NaN where
    all numbers are equal.
    """
    ranks = pd.DataFrame(np.vstack([column, rows])).rank(axis=1).to_numpy()
    ranks = ranks - ranks.mean(axis=1, keepdims=True)
    sizes = np.linalg.norm(ranks, axis=1)
    with np.errstate(invalid="ignore"):
        return (ranks @ ranks[0] / (sizes * sizes[0]))[1:]


def _share(as_far: np.ndarray) -> float:
    """The share of experiments that are as far out, the printed one counted as one of them."""
    return (as_far.sum() + 1) / (len(as_far) + 1)
