"""Every published number of a table beside ours.

One row for each group of runs, metric and statistic; an empty cell means that there is no such number.

| column | meaning |
| --- | --- |
| key columns | columns of the runs table that tell the rows apart: those left of `metric` in the published file, then the table's others |
| metric | what is measured, a name of `metrics.METRICS` |
| statistic | the statistic that the paper prints; `unstated` where it does not say, ours is then the median |
| unit | unit of the metric; `-` for a number without one |
| n_published | runs behind the published number, where the paper says |
| value_published | the published number; a variant of a published method stands beside the number of that method |
| n_ours | our runs that count: feasible ones for metrics of feasible paths, all for the others |
| value_ours | the statistic of these runs |
| best, mean, median, quartile1, quartile3 | of the same runs; best is the lowest |
| low95_ours, high95_ours | 95 % bootstrap interval of value_ours; empty below two runs, and for min, max and range |
| low95_chance, high95_chance | central 95 % of what experiments of n_published runs may print, as far as ours tell (`statistics.chance`) |
| quantile_published | quantile of the published number in experiments of n_published runs (`yardstick`); in our runs if that is empty |
| reproduced | is that within the central 95 %? Ours are rounded like the printed one, ties count; empty for times, and below six runs |
| share_claimed | share of all runs whose path passed the planner's own test |
| share_feasible | share of all runs whose path the certified checker accepts |
| bound | exact shortest length of the problem; of several problems, the median over the runs |
| gap | median over the feasible runs of length / bound - 1 |
"""

import math
from typing import Any

import pandas as pd

from bezierplan import metrics
from bezierplan.analysis import statistics, tables
from bezierplan.analysis.results import Results

_COLUMNS = [
    *("metric", "statistic", "unit", "n_published", "value_published", "n_ours", "value_ours"),
    *("best", "mean", "median", "quartile1", "quartile3", "low95_ours", "high95_ours"),
    *("low95_chance", "high95_chance", "quantile_published", "reproduced", "share_claimed", "share_feasible", "bound", "gap"),
]


def read_published(file: str | None, spec: dict) -> pd.DataFrame:
    """The published numbers of a table: key columns, metric, statistic, n, unit, value. Without a file none, with the table's keys."""
    if file is None:
        return pd.DataFrame(columns=[*tables.keys(spec), "metric", "statistic", "n", "unit", "value"])
    # Only an empty cell means that there is nothing: `none` and `NA` may be names.
    return pd.read_csv(file, keep_default_na=False, na_values=[""])


def compare(
    results: Results, spec: dict, published: pd.DataFrame, variant_of: dict[str, str], controls: list[str], name: str
) -> pd.DataFrame:
    """The published numbers of a table beside ours, in the order of the table; the columns are described above.

    spec: as for `tables.pivot`. published: as from `read_published`. variant_of: method -> the method whose published numbers it is
    compared with. controls: methods without a published number. Variants of the table's methods and controls get rows, whether or not
    the table shows them. name: `study/table`, from which each row's random draws follow.
    """
    given = published.columns[: published.columns.get_loc("metric")].to_list()
    keys = given + [key for key in tables.keys(spec) if key not in given]
    spec = _with_variants(spec, variant_of, controls) if "method" in keys else spec
    both = _side_by_side(tables.cells(results, spec, keys), published, given, variant_of)
    order = tables.in_order(both, spec, list(results.problems)).sort_values([*keys, "value", "metric", "statistic"]).index
    both = both.loc[order].reset_index(drop=True)
    workspace_unit = next(iter(results.problems.values())).workspace.unit
    both["unit"] = [metrics.unit(metric, workspace_unit) for metric in both["metric"]]
    described = pd.DataFrame([_described(row, keys, name) for _, row in both.iterrows()], index=both.index)
    table = both.join(described).reindex(columns=keys + _COLUMNS)
    return table.astype({"n_published": "Int64", "n_ours": "Int64", "reproduced": "boolean"})


def _side_by_side(ours: pd.DataFrame, published: pd.DataFrame, given: list[str], variant_of: dict[str, str]) -> pd.DataFrame:
    """Our cells with n_published and value_published, and published numbers for which there are no runs; statistics named as published.

    given: the key columns of the published numbers.
    """
    theirs = published.rename(columns={"n": "n_published", "value": "value_published", "statistic": "printed"}).drop(columns="unit")
    # What is printed as unstated is compared with the median.
    theirs = theirs.astype({key: ours[key].dtype for key in given}).assign(statistic=theirs["printed"].replace("unstated", "median"))
    ours = ours.assign(statistic=ours["statistic"].replace("unstated", "median"))
    if "method" in given:
        ours = ours.assign(own_method=ours["method"], method=ours["method"].replace(variant_of))
    both = ours.merge(theirs.drop(columns="printed"), how="outer", on=[*given, "metric", "statistic"])
    if "method" in given:
        both["method"] = both["own_method"].fillna(both["method"])
    printed = dict(zip(zip(theirs["metric"], theirs["statistic"]), theirs["printed"]))
    return both.assign(statistic=[printed.get(quantity, quantity[1]) for quantity in zip(both["metric"], both["statistic"])])


def _with_variants(spec: dict, variant_of: dict[str, str], controls: list[str]) -> dict:
    """The table's description with the variants of its methods and the controls selected as well, behind them."""
    where = spec.get("where", {})
    if "method" not in where:
        return spec
    methods = where["method"] if isinstance(where["method"], list) else [where["method"]]
    variants = [variant for variant, method in variant_of.items() if method in methods and variant not in methods]
    beside = variants + [control for control in controls if control not in methods]
    return spec | {"where": where | {"method": methods + beside}, "beside": beside}


def _described(row: pd.Series, keys: list[str], name: str) -> dict[str, Any]:
    """Our side of one row, and where the published number lies in it; empty for a published number that we have no runs for."""
    if pd.isna(row["runs"]):
        return {"n_ours": 0, "reproduced": None}
    numbers = row["numbers"]
    statistic = row["statistic"]
    row_name = "/".join([name, *(f"{key}={row[key]}" for key in keys), row["metric"], statistic])
    low, high = statistics.interval(statistic, numbers, statistics.generator(f"{row_name}/interval"))
    size = None
    if not pd.isna(row["n_published"]):
        # Of the paper's runs, as large a share counted as of ours.
        size = max(1, round(row["n_published"] * len(numbers) / row["runs"]))
    quantile, reproduced = statistics.yardstick(
        statistic, numbers, row["value_published"], size, row["decimals"], statistics.generator(f"{row_name}/yardstick")
    )
    chance = (math.nan, math.nan)
    if not pd.isna(row["value_published"]):
        chance = statistics.chance(statistic, numbers, size, statistics.generator(f"{row_name}/yardstick"))
    return {
        "n_ours": len(numbers),
        "value_ours": statistics.statistic(statistic, numbers),
        "best": statistics.statistic("min", numbers),
        **{each: statistics.statistic(each, numbers) for each in ("mean", "median", "quartile1", "quartile3")},
        "low95_ours": low,
        "high95_ours": high,
        "low95_chance": chance[0],
        "high95_chance": chance[1],
        "quantile_published": quantile,
        # Seconds of another machine are shown, not judged.
        "reproduced": None if row["unit"] == "s" else reproduced,
    }
