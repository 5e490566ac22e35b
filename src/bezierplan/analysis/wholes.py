"""Tables judged as wholes: of a column of printed means, one for each of several methods, the
level, the spread, the order, and how far each mean deviates from their mean, beside experiments of
the paper's size that are drawn from our runs.

Methods that start alike, or plan on the same random maps, have good and bad luck together. So whole
repeats are drawn, each with the runs of all methods (`together`); otherwise each method's runs on
their own. An experiment prints the mean of those of its runs that count, rounded like the paper's.

Columns: study, table, place (the other keys), metric, methods (how many), quantity, printed, ours
(the median of experiments), low95_predicted, high95_predicted, in_range, chance (the two-sided
share of experiments that lie as far out), chance_any_order, outside, together, why.

- level: the mean over methods; spread: the sample standard deviation; order: Spearman's rank
  correlation with our means. chance_any_order: its chance if all orders are equally likely
- deviations: how many means, less the mean of all, lie outside their intervals, and which
  (`outside`). chance: the share of experiments whose sum of squared standardized deviations is as
  large. `deviations of the others`: the same without the mean that lies farthest out
- why: as in the comparison, where the map or the quantity is not the paper's. Then the row says
  what holds on our map or by our definition, and decides nothing
"""

import itertools
from collections.abc import Iterator

import numpy as np
import pandas as pd

from bezierplan.analysis import comparison, statistics, tables
from bezierplan.analysis.markdown import table_text
from bezierplan.analysis.results import Results
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.workspaces.seeds import generator

LEAST = 4
"""Methods that a column needs: of fewer, no order is unlikely."""

MOST = 8
"""Most methods whose orders are counted; the chance is NaN beyond."""

COLUMNS = [
    *("study", "table", "place", "metric", "methods", "quantity", "printed", "ours"),
    *("low95_predicted", "high95_predicted", "in_range", "chance", "chance_any_order"),
    *("outside", "together", "why"),
]

REASONS = (comparison.UNDEFINED, comparison.NO_MAP, comparison.ONE_DRAW)

LEGEND = (
    "Each column of printed means as a whole, and in brackets where 95 % of experiments of the "
    "paper's size lie that are drawn from our runs, with the runs of one repeat together where "
    "methods start alike; out: not among these. Order: the rank correlation with our means. "
    "Deviations: how many means, less the mean of all, lie outside their intervals, and the chance "
    "of as large ones together; then without the one that is farthest out."
)

_EXACT = 1e-9
"""Numbers this near are equal."""


def of_table(
    results: Results, spec: Pivot, comparisons: pd.DataFrame, name: str, paired: bool
) -> pd.DataFrame:
    """The wholes of all columns of means of a table.

    comparisons: as from `comparison.compare`. name: `study/table`, which seeds the draws. paired:
    whether runs with equal repeat numbers start alike.
    """
    keys = comparisons.columns[: comparisons.columns.get_loc("metric")].to_list()
    means = comparisons[comparisons["primary"] & (comparisons["statistic"] == "mean")]
    means = means.dropna(subset=["in_range", "value_ours"]).astype(dict.fromkeys(keys, object))
    rows = []
    if "method" in keys and len(means) >= LEAST:
        cell, places = [*keys, "metric", "statistic"], [key for key in keys if key != "method"]
        ours = tables.cells(results, spec, keys)[[*cell, "decimals", "draws", "by_run"]]
        for (*values, metric), group in means.merge(ours).groupby([*places, "metric"], sort=False):
            if len(group) >= LEAST:
                place = ", ".join(f"{key}={value}" for key, value in zip(places, values))
                same = dict(zip(COLUMNS, [*name.split("/"), place, metric, len(group)]))
                same["together"] = paired or bool((group["draws"] > 1).all())
                same["why"] = next((why for why in REASONS if why in set(group["why"])), "")
                found = experiments(group, same["together"], f"{name}/{place}/{metric}/wholes")
                rows += [same | row for row in _of(group, *found)]
    return pd.DataFrame(rows, columns=COLUMNS)


def experiments(group: pd.DataFrame, together: bool, seed: str) -> tuple[np.ndarray, float]:
    """The means that experiments of the paper's size print, (experiments, methods), and the tail to
    leave out at each end. group: a row for each method, with `by_run` (`tables.cells`).
    """
    parts = group["by_run"].to_list()
    if together:
        parts = [pd.concat(parts, axis=1, join="inner")]
    size = min(int(group["n_published"].fillna(1).min()), statistics.MOST_PREDICTED)
    rng, means = generator(seed), []
    for values in (part.to_numpy().reshape(len(part), -1) for part in parts):
        counts = ~np.isnan(values)
        sums = np.hstack([np.where(counts, values, 0.0), counts])
        total, share = np.split(statistics.predicted("mean", sums, size, rng), 2, axis=1)
        with np.errstate(invalid="ignore"):  # of an experiment none of whose runs counts
            means.append(total / share)
    drawn = np.round(np.hstack(means), group["decimals"].iloc[0])
    tail = statistics.expanded_tail(min(map(len, parts)))
    return drawn[~np.isnan(drawn).any(axis=1)], tail


def _of(group: pd.DataFrame, means: np.ndarray, tail: float) -> Iterator[dict]:
    """The rows of one column, judging by the means of experiments."""
    printed, ours = (
        group[column].to_numpy(dtype=float) for column in ("value_published", "value_ours")
    )
    every = np.vstack([printed, means])
    yield _placed("level", every.mean(axis=1), tail)
    yield _placed("spread", every.std(axis=1, ddof=1), tail)
    order = _placed("order", rank_correlations(every, ours), tail)
    yield order | {"chance_any_order": chance_any_order(printed, ours)}
    methods = group["method"].to_numpy()
    for quantity in ("deviations", "deviations of the others"):
        outside, chance, farthest = deviations(every, tail)
        row = {"quantity": quantity, "methods": len(methods), "printed": outside.sum()}
        yield row | {
            "in_range": chance >= 2 * tail,
            "chance": chance,
            "outside": ", ".join(methods[outside]),
        }
        every, methods = (np.delete(each, farthest, axis=-1) for each in (every, methods))


def _placed(quantity: str, values: np.ndarray, tail: float) -> dict:
    """The first of values (n,) among the others; ties count in its favour."""
    printed, drawn = values[0], values[1:][~np.isnan(values[1:])]
    low, median, high = np.quantile(drawn, [tail, 0.5, 1 - tail])
    beyond = min(_share(drawn <= printed + _EXACT), _share(drawn >= printed - _EXACT))
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
    ranks, own = (
        pd.DataFrame(np.atleast_2d(each)).rank(axis=1).to_numpy() - (len(column) + 1) / 2
        for each in (rows, column)
    )
    with np.errstate(invalid="ignore"):
        return (ranks @ own[0]) / np.sqrt((ranks**2).sum(axis=1) * (own[0] @ own[0]))


def chance_any_order(first: np.ndarray, second: np.ndarray) -> float:
    """The share of all orders of a column (k,) whose rank correlation with another is as far from
    0.
    """
    if len(first) > MOST:
        return np.nan
    every = np.abs(rank_correlations(np.array(list(itertools.permutations(first))), second))
    return float(np.mean(every >= every[0] - _EXACT))


def deviations(means: np.ndarray, tail: float) -> tuple[np.ndarray, float, int]:
    """Which of the first row of means (n, k), less the mean of all, lie outside the central
    interval of those of the other rows, experiments; the chance of as large a sum of squared
    standardized deviations; and which one is the largest.
    """
    first, *others = means - means.mean(axis=1, keepdims=True)
    low, high = np.quantile(others, [tail, 1 - tail], axis=0)
    outside = (first < low - _EXACT) | (first > high + _EXACT)
    scale = np.maximum(np.std(others, axis=0), _EXACT)
    squares = ((np.array([first, *others]) - np.mean(others, axis=0)) / scale) ** 2
    sums = squares.sum(axis=1)
    return outside, _share(sums[1:] >= sums[0]), int(np.argmax(squares[0]))


def _share(as_far: np.ndarray) -> float:
    """The share of experiments that are as far out, the printed one counted as one of them."""
    return (as_far.sum() + 1) / (len(as_far) + 1)


def in_words(whole: pd.DataFrame) -> pd.DataFrame:
    """Wholes for a reader: a row for each column of a table."""
    whole = whole.astype({"place": object, "why": object}).fillna({"place": "", "why": ""})
    columns = whole[["study", "table", "metric", "place"]].to_numpy()
    texts = whole.assign(
        column=[", ".join(filter(None, words)) for words in columns],
        text=[_text(row) for row in whole.to_dict("records")],
    )
    wide = texts.pivot_table("text", "column", "quantity", "first", sort=False)
    return wide.assign(note=texts.groupby("column")["why"].first()).rename_axis(columns=None)


def _text(row: dict) -> str:
    """A quantity beside that of experiments."""
    if "deviations" in row["quantity"]:
        return f"{row['printed']:g} of {row['methods']}, p {row['chance']:.2g}"
    low, high = (f"{row[end]:.3g}" for end in ("low95_predicted", "high95_predicted"))
    return f"{row['printed']:.3g} ({low} to {high})" + ("" if row["in_range"] else ", out")


def section(whole: pd.DataFrame) -> list[str]:
    """The part of the summary about wholes; empty without any."""
    if whole.empty:
        return []
    return ["## Columns of tables as wholes", LEGEND, table_text(in_words(whole))]
