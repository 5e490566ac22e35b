"""A paper's own numbers checked against each other and against exact bounds: contradictions that
need no runs.

Columns: study, item (table or text), place (which cell), rule (in words), printed, limit,
consistent (whether the number obeys the rule; empty if the rule cannot tell), arithmetic (of the
rules that hold for any paper: how the number was checked).

The rules that hold for any paper follow from what a metric is (`metrics.Metric`: its step, its
least and largest value, whether it is a rank) and from how a table is laid out: `of_cells` checks
the statistics of one cell, `of_ranks` mean ranks, `of_orders` the order of rows, `of_digits` last
digits. `analysis.possible` has the closed forms.
"""

import importlib
import itertools
import math
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

import pandas as pd

from bezierplan.analysis import identified, possible
from bezierplan.analysis.audit_rows import COLUMNS, NOT_KEYS, checked
from bezierplan.analysis.jobs import AuditJob
from bezierplan.analysis.metrics import METRICS
from bezierplan.analysis.possible import Printed
from bezierplan.analysis.results import published_table
from bezierplan.analysis.table_kinds import Layout, Monotone
from bezierplan.running import problems

# Metrics that are path lengths or never less, and their statistics that need not be the value of
# any single path.
_AT_LEAST_A_LENGTH = ("length", "objective")
_SPREADS = ("std", "iqr", "range")

# From the lowest to the highest.
_IN_ORDER = ("min", "quartile1", "median", "quartile3", "max")

# Last digits are tested where so many numbers of a metric are printed, whose standard deviation is
# so many units of the last digit: then each digit is about equally likely, whatever is measured. A
# distribution is inconsistent if chance makes one as uneven so seldom.
LEAST_NUMBERS, _LEAST_SPREAD, DIGITS_LEVEL = 30, 10, 0.01


def below_bound(
    tables: dict[str, pd.DataFrame], bounds: dict[str, pd.DataFrame], primary: dict[str, dict]
) -> list[dict]:
    """Check every published length against the exact shortest length of its problem.

    tables: published numbers, by table, as from `read_published`. bounds: of the same tables'
    experiments, one row per problem, indexed by name. primary: of a table, column -> the value of
    the primary interpretation. The allowance is half a unit of the last printed digit.

    A number's problem is the one that its row names, as problem or as workspace; without either,
    that of the primary interpretation, or the only one of the experiment. Numbers that cover
    several problems are left out.
    """
    rows, rule = [], "a path is no shorter than the shortest path"
    for name, table in tables.items():
        keys = _keys(table)
        for _, row in table[
            table["metric"].isin(_AT_LEAST_A_LENGTH) & ~table["statistic"].isin(_SPREADS)
        ].iterrows():
            bound = bounds[name]["bound"].get(
                _problem(primary.get(name, {}) | row.to_dict(), bounds[name]), math.nan
            )
            if math.isnan(bound):
                continue
            place = _place(row, keys, "metric", "statistic")
            fits = row["value"] + _half_a_digit(row["printed"]) >= bound
            rows.append(checked(name, place, rule, row["value"], bound, fits))
    return rows


def _problem(place: dict, bounds: pd.DataFrame) -> str | None:
    """The problem of a published number, from the columns that describe it; None if it is
    ambiguous.
    """
    named = place.get("problem", place.get("workspace"))
    return (
        named
        if named in bounds.index
        else bounds.index[0]
        if named is None and len(bounds) == 1
        else None
    )


def _keys(table: pd.DataFrame) -> list[str]:
    """The columns of a table of published numbers that tell its rows apart."""
    return [column for column in table if column not in NOT_KEYS]


def _place(row: pd.Series, keys: list[str], *more: str) -> str:
    return ", ".join(f"{key}={row[key]}" for key in [*keys, *more])


def _half_a_digit(printed: str) -> float:
    """Half a unit of the last printed digit of a number."""
    return 0.5 * 10.0 ** -len(printed.partition(".")[2])


# Rules that hold for any paper


class Cell(NamedTuple):
    """The statistics of one metric that a table prints in one place.

    texts: statistic -> the number as printed. n: how many values are behind them, None if the paper
    does not say; with `exact` false they are only those of some of these runs, and how many is not
    printed.
    """

    item: str
    place: str
    metric: str
    texts: dict[str, str]
    n: int | None
    exact: bool

    @property
    def inexact(self) -> str:
        """Why numbers of some of the runs cannot be checked."""
        return f"only some of the {self.n} runs count, and how many is not printed"

    def row(
        self, statistic: str, rule: str, limit: float, consistent: bool | None, arithmetic: str
    ) -> dict:
        """A row of the audit about one of its numbers."""
        place, value = f"{self.place}, statistic={statistic}", float(self.texts[statistic])
        return checked(self.item, place, rule, value, limit, consistent, arithmetic)


def of_any_paper(tables: dict[str, pd.DataFrame], layouts: dict[str, Layout]) -> list[dict]:
    """All rows of the rules that hold for any paper.

    tables: published numbers, by table, as from `read_published`. layouts: of each table,
    `columns`, the key columns within whose values its rows are ranked; `selected`, metrics of which
    only some runs count; `monotone`, the orders that its rows must keep, each with metric,
    statistic, along, direction and because.
    """
    rows = []
    for name, table in tables.items():
        for cell in cells(name, table, layouts[name].selected):
            rows += of_cells(cell)
        rows += of_ranks(name, table, layouts[name].columns)
        for rule in layouts[name].monotone:
            rows += of_orders(name, table, rule)
    return [*rows, *of_digits(tables)]


def cells(item: str, table: pd.DataFrame, selected: list[str]) -> Iterator[Cell]:
    """The places of a table, each with all statistics of one metric."""
    keys = _keys(table)
    for _, rows in table.groupby([*keys, "metric"], dropna=False, sort=False):
        location, metric = _place(rows.iloc[0], keys, "metric"), rows["metric"].iloc[0]
        numbers = rows["n"].dropna() if "n" in rows else rows["value"].iloc[:0]
        n = int(numbers.min()) if len(numbers) else None
        exact = (
            not METRICS[metric].feasible_only and metric not in selected and numbers.nunique() == 1
        )
        yield Cell(item, location, metric, dict(zip(rows["statistic"], rows["printed"])), n, exact)


def of_cells(cell: Cell) -> list[dict]:
    """What the statistics of one cell can be, by themselves and beside each other."""
    numbers = {name: possible.printed(text) for name, text in cell.texts.items()}
    parts = [_in_range, _of_steps, _in_order]
    if "std" in numbers and cell.n and cell.n > 1:
        parts.append(_of_spread)
    return [row for part in parts for row in part(cell, numbers)]


def _in_range(cell: Cell, numbers: dict[str, Printed]) -> Iterator[dict]:
    """No mean or quantile lies beyond what a single run can have, for metrics that have two
    ends.
    """
    metric = METRICS[cell.metric]
    if isinstance(metric.least, str) or math.isinf(metric.most) or math.isinf(metric.least):
        return
    rule = f"a run has from {metric.least:g} to {metric.most:g} {metric.meaning}"
    for name, number in numbers.items():
        if name in ("mean", *_IN_ORDER):
            beyond = number.high < metric.least or number.low > metric.most
            limit = metric.least if number.high < metric.least else metric.most
            arithmetic = f"{metric.least:g} <= {cell.texts[name]} <= {metric.most:g}"
            yield cell.row(name, rule, limit, not beyond, arithmetic)


def _of_steps(cell: Cell, numbers: dict[str, Printed]) -> Iterator[dict]:
    """Counts and extremes of whole numbers are whole numbers, and their means and standard
    deviations those of whole numbers.
    """
    if METRICS[cell.metric].step is None:
        return
    step = Fraction(METRICS[cell.metric].step)
    values = "whole numbers" if step == 1 else f"multiples of {_text(step)}"
    rule = f"an extreme of {values} is one of them"
    for name in ("min", "max"):
        if name in numbers:
            nearest = round(numbers[name].value / step) * step
            fits = numbers[name].low <= nearest <= numbers[name].high
            yield cell.row(name, rule, nearest, fits, f"nearest: {_text(nearest)}")
    if "count" in numbers and cell.n:
        value = numbers["count"].value
        fits = value.denominator == 1 and 0 <= value <= cell.n
        rule = f"a count of {cell.n} runs is a whole number up to {cell.n}"
        yield cell.row("count", rule, cell.n, fits, f"0 <= {_text(value)} <= {cell.n}")
    for name in ("mean", "share"):
        if name in numbers and cell.n:
            yield _grim(cell, name, numbers[name], step, values)
    if {"mean", "std"} <= set(numbers) and cell.n and cell.n > 1:
        yield _grimmer(cell, numbers["mean"], numbers["std"], step, values)


def _grim(cell: Cell, name: str, mean: Printed, step: Fraction, values: str) -> dict:
    rule = f"GRIM: a mean of {cell.n} {values} is a sum of them over {cell.n}"
    nearest = possible.nearest_mean(mean, cell.n, step)
    if not cell.exact:
        return cell.row(name, rule, nearest, None, cell.inexact)
    if not possible.grim_decides(mean, cell.n, step):
        apart = (
            f"means of {cell.n} lie {_text(step / cell.n)} apart, printed numbers "
            f"{_text(2 * mean.half)}: every one is possible"
        )
        return cell.row(name, rule, nearest, None, apart)
    told = (
        f"{cell.texts[name]} x {cell.n} = {_text(mean.value * cell.n)}; nearest possible: "
        f"{_text(nearest * cell.n)} / {cell.n} = {float(nearest):.6g}"
    )
    return cell.row(name, rule, nearest, len(possible.sums(mean, cell.n, step)) > 0, told)


def _grimmer(cell: Cell, mean: Printed, std: Printed, step: Fraction, values: str) -> dict:
    rule = (
        f"GRIMMER: {cell.n} {values} with the printed mean can have the printed standard deviation"
    )
    if not cell.exact:
        return cell.row("std", rule, math.nan, None, cell.inexact)
    sums = possible.grimmer(mean, std, cell.n, step)
    if sums is None:
        squares = [
            (cell.n - 1) * (each / step) ** 2 + (mean.value / step) ** 2 * cell.n
            for each in (max(std.low, Fraction(0)), std.high)
        ]
        told = (
            f"sum {_text(mean.value / step * cell.n)}; no sum of squares from "
            f"{float(squares[0]):.6g} to {float(squares[1]):.6g} fits it"
        )
        return cell.row("std", rule, math.nan, False, told)
    total, squares = sums
    exact = math.sqrt((squares - total**2 / cell.n) / (cell.n - 1)) * float(step)
    told = (
        f"sum {total}, sum of squares {squares}: sqrt(({squares} - {total}^2 / {cell.n}) / "
        f"{cell.n - 1}) = {exact:.6g}"
    )
    if step != 1:
        told = f"in steps of {_text(step)}: {told}"
    if possible.grimmer_decides(mean, std, cell.n, step):
        return cell.row("std", rule, exact, True, told)
    return cell.row("std", rule, exact, None, f"{told}; no number could fail here")


def _in_order(cell: Cell, numbers: dict[str, Printed]) -> Iterator[dict]:
    """Quantiles in their order, and the mean where n values with these ends can have it."""
    for low, high in itertools.pairwise(name for name in _IN_ORDER if name in numbers):
        fits = possible.in_order(numbers[low], numbers[high])
        told = f"{cell.texts[low]} <= {cell.texts[high]}"
        yield cell.row(low, f"{low} <= {high}", numbers[high].value, fits, told)
    if not {"min", "max", "mean"} <= set(numbers) or not cell.n or cell.n < 2:
        return
    low, high = possible.mean_limits(numbers["min"], numbers["max"], cell.n)
    fits = low <= numbers["mean"].high and numbers["mean"].low <= high
    limit = low if numbers["mean"].high < low else high
    rule = (
        f"a mean of {cell.n} values lies between (max + {cell.n - 1} min) / {cell.n} and (min "
        f"+ {cell.n - 1} max) / {cell.n}"
    )
    told = f"{float(low):.6g} <= {cell.texts['mean']} <= {float(high):.6g}"
    yield cell.row("mean", rule, limit, fits, told)


def _of_spread(cell: Cell, numbers: dict[str, Printed]) -> Iterator[dict]:
    """A standard deviation against the range, and against the mean and the ends of what is
    possible.
    """
    metric, std, text = METRICS[cell.metric], numbers["std"], cell.texts["std"]
    if {"min", "max"} <= set(numbers):
        low, _ = possible.std_of_range(numbers["min"], numbers["max"], cell.n)
        # Fewer values can have a larger one.
        fewest = cell.n if cell.exact else 2
        _, high = possible.std_of_range(numbers["min"], numbers["max"], fewest)
        rule = (
            "a standard deviation lies between (max - min) / sqrt(2 (n - 1)) and (max - min) / "
            "2 x sqrt(n / (n - 1))"
        )
        limit, fits = low if std.high < low else high, low <= std.high and std.low <= high
        told = f"n = {cell.n}: {low:.6g} <= {text} <= {high:.6g}"
        yield cell.row("std", rule, limit, fits, told)
    least = numbers["min"].low if "min" in numbers else _finite(metric.least)
    most = numbers["max"].high if "max" in numbers else _finite(metric.most)
    if "mean" in numbers and least is not None:
        most = most if cell.exact else None
        limit = possible.std_of_mean(numbers["mean"], cell.n, least, most)
        ends = f"none below {_text(least)}" + ("" if most is None else f" or above {_text(most)}")
        rule = f"the largest standard deviation of values with this mean, {ends}"
        told = f"n = {cell.n}: {text} <= {limit:.6g}"
        yield cell.row("std", rule, limit, float(std.low) <= limit, told)


def _finite(end: float | str) -> Fraction | None:
    return None if isinstance(end, str) or math.isinf(end) else Fraction(end)


def of_ranks(item: str, table: pd.DataFrame, columns: list[str]) -> Iterator[dict]:
    """Mean ranks of k rows lie between 1 and k and add to k (k + 1) / 2; their order beside that of
    the mean objectives.

    columns: the key columns within whose values rows are ranked; those that the file lacks do not
    matter. An order that differs is no contradiction: a mean says how far runs lie apart, a rank
    does not.
    """
    keys, means = _keys(table), table[table["statistic"] == "mean"]
    ranks, objectives = (means[means["metric"] == name] for name in ("rank", "objective"))
    within = [column for column in columns if column in keys]
    for _, group in ranks.groupby(within, sort=False) if within else [((), ranks)]:
        count, texts = len(group), group["printed"].to_list()
        if count < 2:
            continue
        numbers = [possible.printed(text) for text in texts]
        added, total = sum(each.value for each in numbers), possible.rank_sum(count)
        told = f"{' + '.join(texts)} = {_text(added)}; {count} x {count + 1} / 2 = {total}"
        location = _place(group.iloc[0], within, "metric") + ", all rows"
        rule = f"mean ranks of {count} rows add to {total}, up to rounding"
        fits = possible.are_ranks(numbers)
        yield checked(item, location, rule, float(added), total, fits, told)
        rule = f"a mean rank of {count} rows lies between 1 and {count}"
        for (_, row), number in zip(group.iterrows(), numbers):
            limit, fits = 1 if number.high < 1 else count, number.high >= 1 and number.low <= count
            told = f"1 <= {row['printed']} <= {count}"
            of_row = _place(row, keys, "metric")
            yield checked(item, of_row, rule, row["value"], limit, fits, told)
        yield from _against_means(item, location, group, objectives, keys)


def _against_means(
    item: str, location: str, ranks: pd.DataFrame, means: pd.DataFrame, keys: list[str]
) -> Iterator[dict]:
    """Pairs of rows whose mean ranks are in another order than their means."""
    both = ranks.merge(means, on=keys, suffixes=("", "_mean"))
    pairs, apart = 0, []
    for (_, one), (_, other) in itertools.combinations(both.iterrows(), 2):
        lower, upper = sorted((one, other), key=lambda row: row["value_mean"])
        if _are_in_order(upper["printed_mean"], lower["printed_mean"]):
            continue
        pairs += 1
        if not _are_in_order(lower["printed"], upper["printed"]):
            apart.append(
                f"{lower['printed_mean']} < {upper['printed_mean']} but {lower['printed']} > "
                f"{upper['printed']}"
            )
    if pairs:
        rule = (
            "pairs of rows whose mean ranks and mean objectives are in different orders, which can "
            "be, but seldom is"
        )
        told = "; ".join([f"{len(apart)} of {pairs} pairs", *apart])
        yield checked(item, location, rule, len(apart), 0, None if apart else True, told)


def _are_in_order(first: str, second: str) -> bool:
    """Whether the number behind one text can be at most that behind another."""
    return possible.in_order(possible.printed(first), possible.printed(second))


def of_orders(item: str, table: pd.DataFrame, rule: Monotone) -> Iterator[dict]:
    """Numbers that must rise or fall along a column: each beside the one before it."""
    own = table[(table["metric"] == rule.metric) & (table["statistic"] == rule.statistic)]
    keys = _keys(table)
    others = [key for key in keys if key != rule.along]
    words = f"{rule.metric} goes {rule.direction} along {rule.along}: {rule.because}"
    for _, group in own.groupby(others, dropna=False, sort=False) if others else [((), own)]:
        ordered = [row for _, row in group.sort_values(rule.along, kind="stable").iterrows()]
        for before, row in itertools.pairwise(ordered):
            first, second = before["printed"], row["printed"]
            if rule.direction == "up":
                fits, told = _are_in_order(first, second), f"{first} <= {second}"
            else:
                fits, told = _are_in_order(second, first), f"{first} >= {second}"
            place = _place(row, keys, "metric", "statistic")
            yield checked(item, place, words, row["value"], before["value"], fits, told)


def of_digits(tables: dict[str, pd.DataFrame]) -> Iterator[dict]:
    """Last digits of all numbers of a metric: an exact test of equal chances, where there are
    enough numbers that spread widely.

    A number that several tables repeat counts once, and numbers of 1 to n runs, such as counts, are
    left out.
    """
    if not tables:
        return
    together = pd.concat([table.assign(item=name) for name, table in tables.items()])
    for metric, every in together.groupby("metric", sort=False):
        printed_rows = every[~every["statistic"].isin(["count", "share"])]
        printed_rows = printed_rows.drop_duplicates(
            [column for column in printed_rows if column not in ("item", "n")]
        )
        texts = printed_rows["printed"].to_list()
        if len(texts) < LEAST_NUMBERS:
            continue
        digit = 2 * min(possible.printed(text).half for text in texts)
        if printed_rows["value"].std() < _LEAST_SPREAD * digit:
            continue
        digits = possible.last_digits(texts)
        counts = [digits.count(each) for each in range(10)]
        p = possible.digits_p(counts)
        rule = "last digits are equally likely: exact test of the sum of squared counts"
        told = (
            f"0 to 9: {' '.join(map(str, counts))}; p = {p:.3g}, inconsistent below "
            f"{DIGITS_LEVEL:g}"
        )
        items, place = (
            ", ".join(printed_rows["item"].unique()),
            f"metric={metric}, {len(texts)} numbers",
        )
        yield checked(items, place, rule, max(counts), len(texts) / 10, p >= DIGITS_LEVEL, told)


def _text(number: Fraction) -> str:
    return f"{float(number):.10g}"


def audited(
    job: AuditJob,
    problem_files: Mapping[str, str],
    bound_files: Mapping[str, str],
    files: Mapping[str, str],
) -> pd.DataFrame:
    """The audit of a paper as a table with `COLUMNS`.

    problem_files and bound_files: by experiment, problems of those alone whose printed lengths are
    identified. files: of published numbers, by table.
    """
    layouts = job.layouts
    published = {name: read_published(file) for name, file in files.items()}
    bounds = {
        name: pd.read_parquet(file).set_index("problem") for name, file in bound_files.items()
    }
    of_tables = {table: bounds[experiment] for table, experiment in job.tables.items()}
    compared = {table: published[table] for table in of_tables}
    # Numbers to which a workspace was fitted lie above its bound by construction.
    independent = {name: table for name, table in compared.items() if not layouts[name].fitted}
    rows = below_bound(independent, of_tables, job.primary) + of_any_paper(compared, layouts)
    made = {name: problems.read(file) for name, file in problem_files.items()}
    for name, layout in layouts.items():
        rows += identified.of_table(
            name, published[name], layout.identify, made.get(job.tables[name], {})
        )
    if job.module:
        rows += importlib.import_module(job.module).audit(published)
    return table(job.study, rows)


def read_published(file: str) -> pd.DataFrame:
    """Published numbers with an extra column `printed`, their text, which keeps trailing zeros."""
    table = published_table(file)
    if "value" in table:
        table["printed"] = pd.read_csv(file, dtype=str)["value"]
    return table


def table(study: str, rows: list[dict]) -> pd.DataFrame:
    """The rows of an audit as a table with `COLUMNS`."""
    return pd.DataFrame([{"study": study, **row} for row in rows], columns=COLUMNS)
