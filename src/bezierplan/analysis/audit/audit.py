"""A paper's own numbers checked against each other and against exact bounds: contradictions that
need no runs.

The rules that hold for any paper follow from how a table is laid out and from what a metric is
(`metrics.Metric`): `check_statistics` checks the statistics of one cell, `check_ranks` mean ranks,
`check_orders` the order of rows.
`analysis.possible` has the closed forms.
"""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from typing import Any

import pandas as pd

from bezierplan.analysis.audit import identified, possible
from bezierplan.analysis.audit.rows import build_audit_row, describe_cell, merge_rows
from bezierplan.analysis.columns import COLUMNS_OF
from bezierplan.analysis.metrics import AT_LEAST_A_LENGTH, METRICS, Metric
from bezierplan.analysis.results import group_rows, list_key_columns, read_printed_numbers
from bezierplan.analysis.table_kinds import Monotone, Pivot
from bezierplan.running import problems
from bezierplan.running.inputs import Files

# Statistics that need not be the value of any single path.
_SPREADS = ("std", "iqr", "range")

# From the lowest to the highest.
_IN_ORDER = ("min", "quartile1", "median", "quartile3", "max")


def check_lengths(
    item: str, table: pd.DataFrame, bounds: pd.DataFrame, primary: dict[str, Any]
) -> Iterator[dict]:
    """Check every published length against the exact shortest length of its problem.

    table: published numbers, as from `read_printed_numbers`. bounds: one row per problem of the
    same table's experiment, indexed by name. primary: column -> the value of the default reading.
    The allowance is half a unit of the last printed digit.

    A number's problem is the one that its row names, as problem or as workspace; without either,
    that of the default reading, or the only one of the experiment. Numbers that cover several
    problems are left out.
    """
    rule = "a path is no shorter than the shortest path"
    lengths = table["metric"].isin(AT_LEAST_A_LENGTH) & ~table["statistic"].isin(_SPREADS)
    for row in table[lengths].to_dict("records"):
        described = primary | row
        problem = described.get("problem", described.get("workspace"))
        if problem is None and len(bounds) == 1:
            problem = bounds.index[0]
        bound = bounds["bound"].get(problem, math.nan)
        if not math.isnan(bound):
            where = describe_cell(row, [*list_key_columns(table), "metric", "statistic"])
            fits = possible.read_printed(row["as_printed"]).high >= bound
            yield build_audit_row(item, where, rule, row["value"], bound, fits)


# Rules that hold for any paper


def check_any_paper(tables: dict[str, pd.DataFrame], specs: dict[str, Pivot]) -> list[dict]:
    """Check the printed numbers of a paper by the rules that hold for any paper, and return all
    rows.

    tables: published numbers, by table, as from `read_printed_numbers`. specs: for each of them the
    table that reproduces it: the columns within whose values its rows are ranked, metrics of which
    only some runs count, the orders that its rows must keep.
    """
    rows = []
    for name, spec in specs.items():
        table, picks = tables[name], [entry.metric for entry in spec.values if entry.where]
        rows += check_statistics(name, table, picks)
        rows += check_ranks(name, table, spec.across)
        for rule in spec.monotone:
            rows += check_orders(name, table, rule)
    return merge_rows(rows)


def check_statistics(item: str, table: pd.DataFrame, picks: list[str]) -> Iterator[dict]:
    """Check the statistics of each metric in each place of a table beside each other.

    picks: metrics for which only some of the runs count.
    """
    keys = list_key_columns(table)
    for rows in group_rows(table, [*keys, "metric"]):
        where, name = describe_cell(rows.iloc[0], [*keys, "metric"]), rows["metric"].iloc[0]
        metric, sizes = METRICS[name], rows["n"].dropna()
        texts = dict(zip(rows["statistic"], rows["as_printed"]))
        n = int(sizes.max()) if len(sizes) else 0
        # Otherwise only some of these runs count, and how many is not printed.
        whole = not metric.feasible_only and name not in picks and sizes.nunique() == 1
        for statistic, rule, limit, fits, told in _check_cell(texts, n, metric, whole):
            place, printed = f"{where}, statistic={statistic}", float(texts[statistic])
            yield build_audit_row(item, place, rule, printed, limit, fits, told)


def _check_cell(texts: dict[str, str], n: int, metric: Metric, whole: bool) -> Iterator[tuple]:
    """Check the statistics of one cell; yield for each rule: statistic, rule, limit, whether the
    number obeys, and the arithmetic.

    texts: statistic -> the number as printed. n: how many values are behind them, 0 if the paper
    does not say; with `whole` false they are only those of some of these runs.
    """
    numbers = {name: possible.read_printed(text) for name, text in texts.items()}
    if "count" in numbers and n:
        count = numbers["count"].value
        fits = count.denominator == 1 and 0 <= count <= n
        rule = f"a count of {n} runs is a whole number up to {n}"
        yield "count", rule, n, fits, f"0 <= {float(count):.10g} <= {n}"
    for low, high in itertools.pairwise(name for name in _IN_ORDER if name in numbers):
        fits = possible.is_in_order(numbers[low], numbers[high])
        yield low, f"{low} <= {high}", numbers[high].value, fits, f"{texts[low]} <= {texts[high]}"
    ends = {"min", "max"} <= set(numbers)
    if ends and "mean" in numbers:
        low, high = possible.compute_mean_limits(numbers["min"], numbers["max"], n)
        fits = low <= numbers["mean"].high and numbers["mean"].low <= high
        rule = "a mean lies between (max + (n - 1) min) / n and (min + (n - 1) max) / n"
        limit = low if numbers["mean"].high < low else high
        told = f"n = {n or '?'}: {float(low):.6g} <= {texts['mean']} <= {float(high):.6g}"
        yield "mean", rule, limit, fits, told
    for name in ("mean", "share") if whole and metric.step else ():
        mean, apart = numbers.get(name), Fraction(metric.step) / n
        if mean and apart > 2 * mean.half:  # otherwise every printed number is possible
            nearest = round(mean.value / apart) * apart
            rule = f"a {name} of {n} multiples of {metric.step:g} is one of {float(apart):.4g}"
            told = f"GRIM: nearest to {texts[name]} is {float(nearest):.6g}"
            yield name, rule, nearest, mean.low <= nearest <= mean.high, told
    if "std" not in numbers:
        return
    std, text = numbers["std"], texts["std"]
    if ends:
        low, _ = possible.compute_std_limits(numbers["min"], numbers["max"], n)
        # Fewer values can have a larger one.
        _, high = possible.compute_std_limits(numbers["min"], numbers["max"], n if whole else 2)
        rule = (
            "a standard deviation lies between (max - min) / sqrt(2 (n - 1)) and (max - min) / "
            "2 x sqrt(n / (n - 1))"
        )
        limit, fits = low if std.high < low else high, low <= std.high and std.low <= high
        yield "std", rule, limit, fits, f"n = {n or '?'}: {low:.6g} <= {text} <= {high:.6g}"
    least = numbers["min"].low if "min" in numbers else possible.convert_end(metric.least)
    most = numbers["max"].high if "max" in numbers else possible.convert_end(metric.most)
    if "mean" in numbers and least is not None and n > 1:
        most = most if whole else None
        limit = possible.compute_largest_std(numbers["mean"], n, least, most)
        above = "" if most is None else f" or above {float(most):.10g}"
        rule = (
            "the largest standard deviation of values with this mean, none below "
            f"{float(least):.10g}{above}"
        )
        yield "std", rule, limit, float(std.low) <= limit, f"n = {n}: {text} <= {limit:.6g}"


def check_ranks(item: str, table: pd.DataFrame, columns: list[str]) -> Iterator[dict]:
    """Yield rows on mean ranks of k rows: that they lie between 1 and k, and that they
    add to k (k + 1) / 2.

    columns: the key columns within whose values rows are ranked; columns that the file lacks do not
    matter.
    """
    keys = list_key_columns(table)
    ranks = table[(table["statistic"] == "mean") & (table["metric"] == "rank")]
    within = [column for column in columns if column in keys]
    for group in group_rows(ranks, within):
        count, texts = len(group), group["as_printed"].to_list()
        if count < 2:
            continue
        numbers = [possible.read_printed(text) for text in texts]
        adds = possible.can_be_ranks(numbers)
        added, total = float(sum(each.value for each in numbers)), count * (count + 1) // 2
        arithmetic = f"{' + '.join(texts)} = {added:.10g}; {count} x {count + 1} / 2 = {total}"
        location = describe_cell(group.iloc[0], [*within, "metric"]) + ", all rows"
        rule = f"mean ranks of {count} rows add to {total}, up to rounding"
        yield build_audit_row(item, location, rule, added, total, adds, arithmetic)
        rule = f"a mean rank of {count} rows lies between 1 and {count}"
        for row, number in zip(group.to_dict("records"), numbers):
            limit, fits = 1 if number.high < 1 else count, number.high >= 1 and number.low <= count
            arithmetic = f"1 <= {row['as_printed']} <= {count}"
            of_row = describe_cell(row, [*keys, "metric"])
            yield build_audit_row(item, of_row, rule, row["value"], limit, fits, arithmetic)


def check_orders(item: str, table: pd.DataFrame, rule: Monotone) -> Iterator[dict]:
    """Check numbers that must rise or fall along a column, each beside the one before it."""
    numbers = table[(table["metric"] == rule.metric) & (table["statistic"] == rule.statistic)]
    keys = list_key_columns(table)
    others = [key for key in keys if key != rule.along]
    words = f"{rule.metric} goes {rule.direction} along {rule.along}: {rule.because}"
    sign = "<=" if rule.direction == "up" else ">="
    for group in group_rows(numbers, others):
        ordered = group.sort_values(rule.along, kind="stable").to_dict("records")
        for before, row in itertools.pairwise(ordered):
            pair = [possible.read_printed(each["as_printed"]) for each in (before, row)]
            fits = possible.is_in_order(*(pair if rule.direction == "up" else pair[::-1]))
            where = describe_cell(row, [*keys, "metric", "statistic"])
            told = f"{before['as_printed']} {sign} {row['as_printed']}"
            yield build_audit_row(item, where, words, row["value"], before["value"], fits, told)


def check_paper(
    job: Any,
    of_paper: Callable[[dict[str, pd.DataFrame]], list[dict]],
    experiment_files: Mapping[str, Files],
    files: Mapping[str, str],
) -> pd.DataFrame:
    """Check all printed numbers of a paper and return its audit, a table.

    job: the job (`jobs.Audit`). of_paper: the rules for this paper alone. experiment_files: by
    experiment. files: of published numbers, by table.
    """
    published = {name: read_printed_numbers(file) for name, file in files.items()}
    rows = []
    for name, spec in job.tables.items():
        # Bounds of maps that a paper does not print say nothing of its numbers.
        if name not in job.reconstructed:
            bounds = pd.read_parquet(experiment_files[spec.experiment].bounds).set_index("problem")
            rows += check_lengths(name, published[name], bounds, spec.primary)
    rows += check_any_paper(published, job.tables)
    for name, spec in job.tables.items():
        if spec.identify:
            made, _ = problems.read(experiment_files[spec.experiment].problems)
            rows += identified.check_declared_paths(name, published[name], spec.identify, made)
    return build_audit(job.study, rows + of_paper(published))


def build_audit(study: str, rows: list[dict]) -> pd.DataFrame:
    """Build the table from the rows of a study's audit."""
    return pd.DataFrame([{"study": study, **row} for row in rows], columns=COLUMNS_OF["audit"])
