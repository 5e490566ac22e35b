"""Level and order of a column of printed means, one for each of several methods, beside experiments
of the paper's size that are drawn from our runs.

Methods that start alike, or plan on the same random maps, have good and bad luck together. So whole
repeats are drawn, each with the runs of all methods (`together`); otherwise each method's runs on
their own. An experiment prints the mean of those of its runs that count, rounded like the paper's.
"""

import json
from collections.abc import Iterator

import numpy as np
import pandas as pd

from bezierplan.analysis import statistics
from bezierplan.analysis.audit.rows import describe_cell
from bezierplan.analysis.columns import COLUMNS_OF
from bezierplan.analysis.numbers import comparison, tables
from bezierplan.analysis.results import Results, list_key_columns
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.workspaces.seeds import generator

LEAST = 4
"""Methods that a column needs: of fewer, no order is unlikely."""

_EXACT = 1e-9
"""Numbers this near are equal."""


def compare_columns(
    results: Results, spec: Pivot, numbers: pd.DataFrame, name: str, paired: bool
) -> pd.DataFrame:
    """Compare level and order of all columns of means of a table with ours.

    numbers: as from `comparison.compare`. name: `study/table`, which seeds the draws. paired:
    whether runs with equal repeat numbers start alike.
    """
    keys = list_key_columns(numbers)
    means = numbers[numbers["primary"] & (numbers["statistic"] == "mean")]
    means = means.dropna(subset=["low95_predicted", "value_ours"]).astype(
        dict.fromkeys(keys, object)
    )
    rows = []
    if "method" in keys and len(means):
        cell = [*keys, "metric", "statistic"]
        ours = tables.compute_cells(results, spec, keys)[[*cell, "decimals", "draws", "by_run"]]
        column = [key for key in cell if key not in ("method", "statistic")]
        for (*values, metric), group in means.merge(ours).groupby(column, sort=False):
            if len(group) >= LEAST:
                where = dict(zip(column, values))
                told = [*name.split("/"), json.dumps(where), metric, len(group)]
                same = dict(zip(COLUMNS_OF["order_and_level"], told))
                together = paired or bool((group["draws"] > 1).all())
                # The file was once named wholes: its name seeds the draws, so it stays.
                rng = generator(f"{name}/{describe_cell(where, where)}/{metric}/wholes")
                rows += [same | row for row in _compare_column(group, together, rng)]
    return pd.DataFrame(rows, columns=COLUMNS_OF["order_and_level"])


def draw_means(
    group: pd.DataFrame, together: bool, rng: np.random.Generator
) -> tuple[np.ndarray, float]:
    """Draw the means that experiments of the paper's size print, (experiments, methods), and return
    the tail to leave out at each end.

    group: a row for each method, with `by_run` (`tables.compute_cells`).
    """
    parts = group["by_run"].to_list()
    if together:
        # One table, so that a repeat is drawn with the runs of all methods.
        parts = [pd.concat(parts, axis=1, join="inner")]
    # Where the paper does not state its number of runs, single runs are compared, as in each cell.
    size = min(int(group["n_published"].fillna(1).min()), statistics.MOST_PREDICTED)
    means = []
    for values in (part.to_numpy().reshape(len(part), -1) for part in parts):
        # The mean of the runs that count is that of values, 0 where there is none, over the share
        # that has one.
        sums = np.hstack([np.nan_to_num(values), ~np.isnan(values)])
        total, share = np.split(statistics.draw_predictions("mean", sums, size, rng), 2, axis=1)
        with np.errstate(invalid="ignore"):  # of an experiment none of whose runs counts
            means.append(total / share)
    table = np.round(np.hstack(means), group["decimals"].iloc[0])
    tail = statistics.compute_expanded_tail(min(map(len, parts)))
    # An experiment that lacks a mean prints no column.
    return table[~np.isnan(table).any(axis=1)], tail


def _compare_column(
    group: pd.DataFrame, together: bool, rng: np.random.Generator
) -> Iterator[dict]:
    """Yield the rows of one column: its level and its order."""
    means, tail = draw_means(group, together, rng)
    every = np.vstack([group["value_published"], means])
    for quantity, (printed, *others) in (
        ("level", every.mean(axis=1)),
        ("order", compute_rank_correlations(every, group["value_ours"])),
    ):
        low, high = np.nanquantile(others, [tail, 1 - tail])
        yield {
            "quantity": quantity,
            "printed": printed,
            "low95_predicted": low,
            "high95_predicted": high,
            "position": comparison.find_position(printed, low - _EXACT, high + _EXACT),
        }


def compute_rank_correlations(rows: np.ndarray, column: np.ndarray) -> np.ndarray:
    """Compute Spearman's rank correlation of each of some rows (n, k) with a column (k,): (n,). NaN
    where all numbers are equal.
    """
    ranks = pd.DataFrame(np.vstack([column, rows])).rank(axis=1).to_numpy()
    ranks = ranks - ranks.mean(axis=1, keepdims=True)
    sizes = np.linalg.norm(ranks, axis=1)
    with np.errstate(invalid="ignore"):
        return (ranks @ ranks[0] / (sizes * sizes[0]))[1:]
