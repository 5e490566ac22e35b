"""Result tables laid out as in the papers, each described by its keys in the configuration
(`table_kinds.Pivot`).

Rows and columns are values of columns of the runs table, entries of `values`, and statistics: what
is needed to distinguish numbers but not named as index or column becomes a level of the columns.
"""

import itertools
import math
from collections.abc import Iterable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis import metrics, naming, statistics
from bezierplan.analysis.audit import possible
from bezierplan.analysis.results import Results, is_repeated, select
from bezierplan.analysis.table_kinds import Pivot

SIGNIFICANT = 2
"""Digits that a number has at least where a paper's table holds ours."""


def order_keys(table: pd.DataFrame, spec: Pivot, problems: Iterable[str]) -> pd.DataFrame:
    """Make the key columns ordered categories, so that sorting follows the configuration.

    Values are ordered as listed in `where`, problems as in their experiment, all others sorted
    after them; missing values are last.
    """
    orders = {
        "problem": list(problems),
        **{key: wanted for key, wanted in spec.where.items() if isinstance(wanted, list)},
    }
    ordered = {}
    for key in table.columns.intersection([*spec.key_columns, *orders]):
        present = naming.list_in_order(table[key], orders)
        ordered[key] = pd.Categorical(table[key], categories=present, ordered=True)
    return table.assign(**ordered)


class Cell(NamedTuple):
    """An entry of `values` over runs with equal keys.

    draws: of random maps; 0 on others. share_feasible, bound, gap: of all these runs, the bound
    (median) and gap (median of the feasible ones) of the metric's kind of length. least: the least
    value that one run can have (`least` of an entry is stronger than that of its metric). size: how
    many runs satisfy the entry's `where`, with or without a value; each once. numbers: sorted (n,):
    the metric of those that have one. problems: names of the problems of those that satisfy it.
    groups: the numbers as one array for each value of the column `within`, None without that key.
    """

    draws: int
    share_feasible: float
    bound: float
    gap: float
    least: float
    size: int
    numbers: np.ndarray
    problems: frozenset[str]
    groups: tuple[np.ndarray, ...] | None


class _Measures(NamedTuple):
    """The numbers of each run (n,) for an entry of `values`: whether the entry asks for the run,
    and counts it; its metric, bound and gap, and the least value that it can have.
    """

    selects: np.ndarray
    counts: np.ndarray
    values: np.ndarray
    bound: np.ndarray
    gap: np.ndarray
    least: np.ndarray


def compute_cells(results: Results, spec: Pivot, keys: list[str]) -> pd.DataFrame:
    """Compute the numbers behind a table: one row for each entry of `values`, group of runs with
    equal keys, and statistic.

    Its columns are the keys, value (the number of the entry), metric, statistic, decimals, most
    (the largest value that one run can have), and the fields of a `Cell`.
    """
    # Sorted by name, so that no sum depends on the order in which chunks were read.
    runs = select(results.runs, spec.where).sort_values(["id", "repeat"], ignore_index=True)
    # Runs that drew nothing stand in every repeat, and count once.
    once = ~is_repeated(runs)

    @cache
    def measure(metric: str) -> np.ndarray:
        """Measure all runs by a metric, once."""
        return metrics.compute_values(runs, metric, results.problems).to_numpy()

    rows, by_keys = [], runs[keys].groupby(keys, dropna=False)
    for number, entry in enumerate(spec.values):
        metric, own = metrics.METRICS[entry.metric], select(runs, entry.where)
        selects, counts = runs.index.isin(own.index), once
        if metric.among_rows:
            # It compares those that the entry's `where` leaves, and among others even a repeated
            # run has a rank of its own.
            compared = metrics.compute_values(own, entry.metric, results.problems)
            values, counts = compared.reindex(runs.index).to_numpy(), True
        else:
            values = measure(entry.metric)
        least = entry.least or metric.least
        columns = runs[[metric.bound]].assign(least=runs.get(least, least))
        bound, least = columns.to_numpy(dtype=float).T
        of_runs = _Measures(selects, selects & counts, values, bound, measure(metric.gap), least)
        for key, group in by_keys:
            cell = _compute_cell(runs, group.index.to_numpy(), of_runs, spec.within)
            rows += [
                [*key, number, entry.metric, name, entry.decimals, metric.most, *cell]
                for name in entry.statistics
            ]
    columns = [*keys, "value", "metric", "statistic", "decimals", "most", *Cell._fields]
    # Decimals of type object stay integers next to published numbers without runs.
    return pd.DataFrame(rows, columns=columns).astype({"decimals": object})


def _compute_cell(
    runs: pd.DataFrame, places: np.ndarray, measures: _Measures, within: str | None
) -> Cell:
    """Compute the cell of an entry from the runs at some places."""
    of_entry, counted = (places[mask[places]] for mask in (measures.selects, measures.counts))
    # A run without a value counts nowhere.
    chosen = counted[~np.isnan(measures.values[counted])]
    numbers, groups = measures.values[chosen], None
    if within:
        units = runs[within].to_numpy()[chosen]
        # Tuples, because pandas would expand lists of arrays.
        groups = tuple(np.sort(numbers[units == unit]) for unit in np.unique(units))
    return Cell(
        draws=runs["layout"].iloc[places].nunique() if "layout" in runs else 0,
        share_feasible=runs["feasible"].to_numpy()[places].mean(),
        bound=_compute_median(measures.bound[places]),
        gap=_compute_median(measures.gap[places]),
        # Not `min`, which is nan as soon as one run has no least value.
        least=np.fmin.reduce(measures.least[places]),
        size=len(counted),
        numbers=np.sort(numbers),
        problems=frozenset(runs["problem"].iloc[of_entry]),
        groups=groups,
    )


def _compute_median(values: np.ndarray) -> float:
    """Compute the median of values (n,) but for NaN; NaN if no others remain."""
    return statistics.compute_statistic("median", values[~np.isnan(values)])


def place_cells(groups: pd.DataFrame, spec: Pivot, problems: Iterable[str]) -> pd.DataFrame:
    """Add to cells (`compute_cells`) their places in the table, from 0: table_row, table_column."""
    order = dict.fromkeys(name for entry in spec.values for name in entry.statistics)
    ordered = order_keys(groups, spec, problems)
    ordered["statistic"] = pd.Categorical(groups["statistic"], categories=list(order), ordered=True)
    # Numbers of the combinations that occur, in the order of the categories.
    rows, columns = (
        ordered.groupby(levels, dropna=False, observed=True).ngroup()
        for levels in _list_levels(spec)
    )
    return groups.assign(table_row=rows, table_column=columns)


def lay_out(
    places: pd.DataFrame, texts: Sequence, rows: pd.Index, columns: pd.Index
) -> pd.DataFrame:
    """Lay out texts as a table with these heads, each at its place (`place_cells`)."""
    table = np.full((len(rows), len(columns)), "", dtype=object)
    table[tuple(places[["table_row", "table_column"]].to_numpy(dtype=int).T)] = texts
    return pd.DataFrame(table, rows, columns)


def build_pivot(
    results: Results, spec: Pivot, labels: dict[str, str], published: pd.DataFrame | None
) -> pd.DataFrame:
    """Build a table as printed: text, rounded to each entry's decimals, empty where no run counts.

    labels: how names are printed. published: as from `comparison.read_published`; None for a table
    without printed numbers. Column levels are joined into one name, such as `objective value:
    smooth`; index levels stay columns of the csv file. A column of a table with printed numbers has
    their decimals, or as many as its smallest number needs for `SIGNIFICANT` digits; in any other
    table, where some runs have no value, a column beside the values says how many have one
    (`_add_counts`).
    """
    table = place_cells(compute_cells(results, spec, spec.key_columns), spec, results.problems)
    values = [
        statistics.compute_statistic(*each) for each in zip(table["statistic"], table["numbers"])
    ]
    decimals = table["decimals"]
    if published is not None:
        digits = published["as_printed"].map(possible.find_last_place)
        # The most frequent number of decimals of a metric; of equally frequent ones the larger.
        usual = digits.groupby(published["metric"]).agg(lambda each: each.mode().max())
        decimals = table["metric"].map(usual).fillna(decimals).astype(int)
        counted = table["statistic"] == "count"
        needed = map(_choose_decimals, values, decimals, counted)
        decimals = pd.Series([*needed], table.index).groupby(table["table_column"]).transform("max")
    texts = ["" if np.isnan(each) else f"{each:.{n}f}" for each, n in zip(values, decimals)]
    titles = [entry.label for entry in spec.values]
    rows, heads = (
        table.drop_duplicates(place)
        .sort_values(place)[levels]
        .apply(_label_level, labels=labels, titles=titles)
        for place, levels in zip(("table_row", "table_column"), _list_levels(spec))
    )
    rows = rows.rename(columns=labels)
    # An index of several levels stays several columns in the file.
    index = pd.MultiIndex.from_frame(rows) if rows.shape[1] > 1 else pd.Index(rows.iloc[:, 0])
    columns = pd.Index([": ".join(levels) for levels in heads.itertuples(index=False)])
    wide = lay_out(table, texts, index, columns)
    # A table of the paper's form has the paper's columns alone.
    if published is not None:
        return wide
    counted = [f"{len(own)} of {size}" for own, size in zip(table["numbers"], table["size"])]
    stems = heads.drop(columns="statistic", errors="ignore").itertuples(index=False)
    return _add_counts(
        wide, lay_out(table, counted, index, columns), [": ".join(levels) for levels in stems]
    )


def _add_counts(wide: pd.DataFrame, counts: pd.DataFrame, stems: list[str]) -> pd.DataFrame:
    """Add a column such as `20 of 30` beside the values of which some runs have none, for example
    because they failed.

    counts: how many runs have a value, and of how many, at the places of the table. stems: the name
    of each column without its statistic. Neighbouring columns with equal counts share one column.
    """
    columns: list[pd.DataFrame | pd.Series] = []
    for texts, alike in itertools.groupby(
        range(len(stems)), lambda place: counts.iloc[:, place].to_list()
    ):
        places = [*alike]
        columns.append(wide.iloc[:, places])
        if any(len({*text.split(" of ")}) > 1 for text in texts):
            ends = dict.fromkeys([stems[places[0]], stems[places[-1]]])
            name = ": ".join(filter(None, ["runs counted", " to ".join(filter(None, ends))]))
            shown = ["" if text == "0 of 0" else text for text in texts]
            columns.append(pd.Series(shown, wide.index, object, name))
    return pd.concat(columns, axis=1) if columns else wide


def _list_levels(spec: Pivot) -> tuple[list[str], list[str]]:
    """List the levels of the index and of the columns, including necessary words that were left
    out.
    """
    index, columns = spec.index, [*spec.columns]
    if "statistic" not in index + columns and any(
        len(entry.statistics) > 1 for entry in spec.values
    ):
        columns.append("statistic")
    # A table without columns gets one, named by its only value.
    if "value" not in index + columns and (len(spec.values) > 1 or not columns):
        columns.insert(0, "value")
    return index, columns


def _label_level(level: pd.Series, labels: dict[str, str], titles: list[str]) -> pd.Series:
    """Label a level of rows or columns as printed."""
    names = (
        [titles[value] for value in level]
        if level.name == "value"
        else [labels.get(str(value), str(value)) for value in level]
    )
    return pd.Series(names, index=level.index, dtype=object)


def _choose_decimals(number: float, decimals: int, counted: bool) -> int:
    """Return the given decimals, or more if a number, unless it is counted, needs them for its
    significant digits.
    """
    if counted or not number or not np.isfinite(number):
        return decimals
    return max(decimals, SIGNIFICANT - 1 - math.floor(math.log10(abs(number))))
