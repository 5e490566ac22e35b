"""Tables as printed, and the comparison with published numbers."""

import io
import itertools
import math

import numpy as np
import pandas as pd
import pytest
from pivots import pivot_of

from bezierplan.analysis import metrics, statistics, table_kinds
from bezierplan.analysis.numbers import comparison, listing, tables
from bezierplan.analysis.results import Results
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem

GRID = from_lines(["..", ".."], 1.0, "m")
PROBLEMS = {name: Problem(name, GRID, (0.5, 0.5), (1.5, 1.5)) for name in ("long", "brief")}

SPEC = {
    "where": {"problem": ["long", "brief"], "method": ["plain", "fast"]},
    "index": ["problem"],
    "columns": ["value", "method"],
    "values": [
        {
            "metric": "evaluations",
            "statistic": "median",
            "label": "number of evaluations",
            "decimals": 0,
        },
        {"metric": "length", "statistic": "median", "decimals": 2},
    ],
}
LABELS = {"long": "the long one", "plain": "plain method"}


def of_values(*values: tuple[str, str], **keys) -> dict:
    """The table with other values, given by metric and statistic, and further keys."""
    described = [dict(zip(("metric", "statistic"), value)) for value in values]
    return SPEC | {"values": described} | keys


PUBLISHED = """problem,method,metric,statistic,n,unit,value
long,plain,length,unstated,,m,{plain}
long,fast,length,unstated,,m,10.00
long,fast,evaluations,median,20,-,1000
"""


def results(repeats: int = 20) -> Results:
    """Three methods, one of them a variant of `fast`, on two problems; every fifth run is
    infeasible and shorter than any path.
    """
    rng = np.random.default_rng(5)
    rows = [
        {
            "id": f"study/experiment/{problem}/{method}/{repeat}",
            "condition": problem,
            "problem": problem,
            "workspace": f"{problem}_map",
            "method": method,
            "drew": True,
            "repeat": repeat,
            "length": 1.0 if repeat % 5 == 0 else rng.normal(10 if problem == "long" else 5, 0.1),
            "evaluations": 1000 if method == "fast" else 2000,
            "feasible": repeat % 5 != 0,
            "claimed_feasible": True,
            "bound": 9.0 if problem == "long" else 4.5,
        }
        for problem in PROBLEMS
        for method in ("faster", "fast", "plain")
        for repeat in range(repeats)
    ]
    return Results(pd.DataFrame(rows), PROBLEMS, pd.DataFrame())


def published(plain: float = 10.0) -> pd.DataFrame:
    return pd.read_csv(io.StringIO(PUBLISHED.format(plain=plain)))


def with_texts() -> pd.DataFrame:
    """The published numbers with their digits."""
    return published().assign(as_printed=["10", "10.00", "1000"])


def printed(metric: str, statistic: str, n: float, numbers: dict) -> pd.DataFrame:
    """Published numbers: (problem, method) -> value."""
    rows = [(*place, metric, statistic, n, "-", value) for place, value in numbers.items()]
    return pd.DataFrame(rows, columns=published().columns)


def pivot(ours: Results, spec: dict, labels: dict[str, str]) -> pd.DataFrame:
    texts = with_texts() if "published" in spec else None
    return tables.build_pivot(ours, pivot_of(spec), labels, texts)


def beside(ours: Results, spec: dict, printed: pd.DataFrame) -> pd.DataFrame:
    printed = printed if "as_printed" in printed else printed.assign(as_printed="10.00")
    return comparison.compare(ours, pivot_of(spec), printed, "study/table1", [], {})


def compare(ours: Results, plain: float = 10.0, spec: dict = SPEC) -> pd.DataFrame:
    return beside(ours, spec, published(plain))


def row(table: pd.DataFrame, *key: str) -> pd.Series:
    """The row of a comparison with the given problem, method, metric."""
    found = table[(table[["problem", "method", "metric"]] == list(key)).all(axis=1)]
    assert len(found) == 1
    return found.iloc[0]


@pytest.fixture(autouse=True)
def few_draws(monkeypatch):
    monkeypatch.setattr(statistics, "DRAWS", 1000)


def shuffled(ours: Results) -> Results:
    return ours._replace(runs=ours.runs.sample(frac=1, random_state=6).reset_index(drop=True))


def test_table_in_the_order_of_the_configuration():
    table = pivot(results(), SPEC, LABELS)
    assert table.index.to_list() == ["the long one", "brief"]
    assert table.columns.to_list() == [
        "number of evaluations: plain method",
        "number of evaluations: fast",
        "length: plain method",
        "length: fast",
        "runs counted: length: plain method to length: fast",
    ]
    assert table.iloc[:, 0].to_list() == ["2000", "2000"]
    assert [float(text) for text in table["length: fast"]] == pytest.approx([10, 5], abs=0.2)


def test_a_table_in_the_papers_form_shows_small_numbers_and_the_printed_ones_in_its_cells():
    ours = results()
    spec = SPEC | {"published": "table1.csv"}
    ours.runs["length"] /= 1000
    table = pivot(ours, spec, LABELS)
    assert list(table) == list(pivot(ours, SPEC, LABELS))[:-1], "no counts of runs"
    own = table["length: fast"]
    assert own.str.fullmatch(r"0\.0\d{3}").all(), "two digits of the smallest"
    assert own.str.len().nunique() == 1, "a column has one number of decimals"
    laid = in_cells(ours, spec, LABELS, with_texts())
    assert laid.index.equals(table.index)
    assert list(laid) == list(table)
    assert laid.loc["the long one"].to_list() == ["", "1000", "10", "10.00"]
    assert laid.loc["brief"].to_list() == [""] * 4


def in_cells(
    ours: Results, spec: dict, labels: dict[str, str], printed: pd.DataFrame
) -> pd.DataFrame:
    """Printed numbers in the cells of their table."""
    table = pivot(ours, spec, labels)
    placed = beside(ours, spec, printed)
    return tables.lay_out(placed, placed["as_printed"], table.index, table.columns)


@pytest.mark.parametrize(
    ("labels", "titles"),
    [
        ({"length": "way", "evaluations": "work", "median": "middle"}, ("length", "evaluations")),
        ({"length: median": "way", "way": "length"}, ("way", "length")),
        (dict.fromkeys(["long", "brief", "plain", "fast"], "one"), ("value", "statistic")),
    ],
)
def test_labels_lose_no_printed_number(labels, titles):
    """Not those of the study, nor those of a table's values, whatever names they collide with; two
    values may be of one metric.
    """
    values = [
        {"metric": "length", "statistic": ["median", "min"], "label": titles[0]},
        {"metric": "evaluations", "statistic": "median", "label": titles[1]},
        {"metric": "length", "statistic": "max", "label": "most"},
    ]
    numbers = pd.DataFrame(
        [
            (*names, 20, "m", 10, " ".join(names))
            for place in itertools.product(("long", "brief"), ("plain", "fast"))
            for value in ("length unstated", "length min", "evaluations median", "length max")
            for names in [(*place, *value.split())]
        ],
        columns=[*published(), "as_printed"],
    )
    for index, columns in (
        (["problem"], ["value", "method"]),
        (["method"], ["problem", "value", "statistic"]),
        (["value", "problem"], ["method"]),
    ):
        spec = SPEC | {"published": "table1.csv", "values": values}
        spec |= {"index": index, "columns": columns}
        laid = in_cells(results(), spec, labels, numbers).to_numpy()
        assert sorted(laid[laid != ""]) == sorted(numbers["as_printed"])
        without = in_cells(results(), spec, {}, numbers).to_numpy()
        assert laid.tolist() == without.tolist()


def test_a_printed_number_that_no_cell_takes_is_an_error():
    ours = results()
    spec = SPEC | {"published": "table1.csv"}
    ours = ours._replace(runs=ours.runs[ours.runs["method"] != "fast"])
    printed = published().assign(as_printed="10.00")
    with pytest.raises(ValueError, match=r"2 printed numbers .* 10.00 .*method fast, metric"):
        beside(ours, spec, printed)
    alone = spec | {"where": {"method": ["plain"]}}
    assert len(beside(ours, alone, printed)) == 3, "others are not of this table"


def test_a_deterministic_method_has_one_run_under_each_condition():
    ours = results()
    plain = ours.runs["method"] == "plain"
    changed = {"drew": False, "length": 10.0, "feasible": True}
    runs = ours.runs.assign(
        **{name: ours.runs[name].mask(plain, changed[name]) for name in changed}
    )
    table = compare(ours._replace(runs=runs))
    found = row(table, "long", "plain", "length")
    assert (found["n_ours"], found["n_asked"], found["value_ours"]) == (1, 1, 10.0)
    assert np.isnan(found["low95_ours"])


def test_failed_runs_are_never_averaged():
    ours = results()
    feasible = ours.runs.query("feasible and problem == 'long' and method == 'plain'")["length"]
    table = pivot(ours, of_values(("length", ["mean", "max"])), {})
    for name in ("mean", "max"):
        assert table.loc["long", f"length: plain: {name}"] == f"{feasible.agg(name):.6f}"
    found = row(compare(ours), "long", "plain", "length")
    assert (found["n_ours"], found["value_ours"]) == (16, feasible.median())
    assert (found["share_feasible"], found["bound"], found["unit"]) == (0.8, 9.0, "m")
    assert found["gap"] == pytest.approx(feasible.median() / 9 - 1)


def test_count_stands_beside_what_leaves_failed_runs_out():
    """One for all statistics of the same runs, and none where every run counts."""
    values = ("length", ["min", "max", "mean"]), ("evaluations", "mean")
    spec = of_values(*values, where={"method": "plain"}, columns=["value", "statistic"])
    ours = results()
    ours.runs.loc[ours.runs["problem"] == "brief", "feasible"] = True
    table = pivot(ours, spec, {})
    assert table.columns.to_list() == [
        "length: min",
        "length: max",
        "length: mean",
        "runs counted: length",
        "evaluations: mean",
    ]
    assert table["runs counted: length"].to_dict() == {"long": "16 of 20", "brief": "20 of 20"}
    ours.runs["feasible"] = True
    assert "runs counted: length" not in pivot(ours, spec, {})


def test_count_is_of_the_runs_that_a_value_asks_for():
    late = {"metric": "length", "statistic": "median", "where": {"repeat": [0, 1, 2]}}
    table = pivot(results(), {"index": ["value"], "columns": ["method"], "values": [late]}, {})
    assert table["runs counted: fast to plain"].to_list() == ["4 of 6"]
    found = row(compare(results(), spec=SPEC | {"values": [late]}), "long", "plain", "length")
    assert (found["n_ours"], found["n_asked"]) == (2, 3)


def test_empty_group_gives_an_empty_cell():
    ours = results()
    ours.runs.loc[ours.runs["method"] == "fast", "feasible"] = False
    assert pivot(ours, SPEC, {})["length: fast"].to_list() == ["", ""]
    found = row(compare(ours), "long", "fast", "length")
    assert found["n_ours"] == 0
    assert found[["value_ours", "low95_ours", "low95_predicted", "wide", "gap"]].isna().all()
    assert found["share_feasible"] == 0


def test_no_runs_at_all():
    ours = results()
    ours = ours._replace(runs=ours.runs.iloc[:0])
    assert pivot(ours, SPEC, {}).empty


def test_words_left_out_become_levels_where_needed():
    mean = {"metric": "length", "statistic": "mean"}
    ends, work = mean | {"statistic": ["min", "max"]}, mean | {"metric": "evaluations"}
    both, counted = ["problem", "method"], "runs counted: "
    for spec, columns in (
        (
            {"index": ["problem"], "columns": ["method"], "values": [mean]},
            ["fast", "faster", "plain", f"{counted}fast to plain"],
        ),
        ({"index": both, "values": [mean]}, ["length", f"{counted}length"]),
        (
            {"index": both, "values": [ends, work]},
            ["length: min", "length: max", f"{counted}length", "evaluations: mean"],
        ),
    ):
        table = pivot(results(), spec, {})
        assert list(table) == columns
        assert list(table.index.names) == spec["index"]


def test_order_of_the_runs_never_changes_a_byte():
    ours = results()
    assert pivot(shuffled(ours), SPEC, {}).to_csv() == pivot(ours, SPEC, {}).to_csv()
    assert compare(shuffled(ours)).to_csv() == compare(ours).to_csv()


def test_rows_do_not_depend_on_the_others():
    alone = compare(results(), spec=SPEC | {"where": {"problem": ["long"], "method": ["plain"]}})
    assert alone["n_ours"].gt(0).sum() == 1
    one, among = (row(table, "long", "plain", "length") for table in (alone, compare(results())))
    places = comparison.PLACES
    pd.testing.assert_series_equal(one.drop(places), among.drop(places), check_names=False)


def test_columns_of_the_comparison():
    assert ",".join(compare(results()).columns) == (
        "problem,method,metric,statistic,unit,n_published,value_published,n_ours,n_asked,value_ours,value_ours_scaled,"
        "low95_ours,high95_ours,low95_predicted,high95_predicted,position,wide,reason,possible,"
        "share_feasible,bound,gap,table_row,table_column,as_printed"
    )


def test_rows_of_the_comparison():
    """The printed numbers alone, in the order of the table's methods, and of its values in each;
    statistics are named as in the paper.
    """
    table = compare(results())
    assert table[["problem", "method", "metric", "statistic"]].to_numpy().tolist() == [
        ["long", "plain", "length", "unstated"],
        ["long", "fast", "evaluations", "median"],
        ["long", "fast", "length", "unstated"],
    ]


def test_seconds_of_another_machine_are_shown_but_not_judged():
    ours = results()
    ours.runs["cpu_s"] = 0.01
    given = printed("cpu_s", "mean", 30, {("long", "plain"): 200.0}).assign(unit="s")
    found = row(beside(ours, of_values(("cpu_s", "mean")), given), "long", "plain", "cpu_s")
    assert (found["value_published"], found["value_ours"]) == (200.0, pytest.approx(0.01))
    assert found["position"] == comparison.NO_RANGE


def least(plain, fast=11.0, n=20, other=11.0):
    """The row of the least length of `plain` on the problem `long`, whose bound is 9, beside
    published ones.
    """
    values = {("long", "plain"): plain, ("long", "fast"): fast, ("long", "other"): other}
    numbers = printed("length", "min", n, values).dropna()
    table = beside(results(), of_values(("length", "min")), numbers)
    return row(table, "long", "plain", "length")


def test_published_minimum_below_the_bound_is_impossible_and_lies_below():
    found = least(8.99)
    assert (found["position"], found["possible"]) == ("below", False)
    found = least(9.0)
    assert (found["position"], found["low95_predicted"]) == ("inside", 9.0)


@pytest.mark.parametrize(
    ("reason", "changed", "defined", "reconstructed", "fitted"),
    [
        (comparison.UNDEFINED, {}, False, [], {}),
        (comparison.NO_MAP, {}, True, ["long_map"], {}),
        ("", {}, True, ["brief_map"], {}),
        (comparison.ONE_DRAW, {"layout": 3}, True, [], {}),
        (comparison.FITTED, {}, True, [], {"length": {"method": ["plain"]}}),
    ],
)
def test_why_a_position_proves_nothing_stands_beside_it(
    reason, changed, defined, reconstructed, fitted
):
    values = [entry | {"defined": defined} for entry in SPEC["values"]]
    ours = results()._replace(runs=results().runs.assign(**changed))
    for value, position in ((8.1, "below"), (10.0, "inside"), (10.9, "above")):
        table = comparison.compare(
            ours,
            pivot_of(SPEC | {"values": values}),
            published(value).assign(as_printed="10.00"),
            "study/table1",
            reconstructed,
            fitted,
        )
        found = row(table, "long", "plain", "length")
        assert (found["reason"], found["position"]) == (reason, position)


@pytest.mark.parametrize(
    ("fast", "other", "wide"),
    [(0.06, 0.07, True), (0.06, 1000.0, True), (999.0, 1000.0, False), (math.nan, math.nan, False)],
)
def test_a_range_that_holds_half_of_the_other_numbers_is_too_wide(fast, other, wide):
    ours = results().runs.query("feasible and problem == 'long' and method == 'plain'")["length"]
    near = float(ours.min())
    found = least(near + 0.05, fast=near + fast, other=near + other)
    assert (found["position"], found["wide"]) == ("inside", wide)
    assert least(1.0, fast=near + fast, other=near + other)["wide"] == wide


def test_number_that_the_metric_cannot_have_is_not_possible():
    values = {("long", "plain"): -1.0, ("long", "fast"): 1000.0}
    numbers = printed("evaluations", "mean", 9, values)
    table = beside(results(), of_values(("evaluations", "mean")), numbers)
    found = [row(table, *place, "evaluations")["possible"] for place in values]
    assert found == [False, True]


def test_size_of_the_paper_is_not_cut_to_the_share_that_counts(monkeypatch):
    """A fifth of our runs failed; the paper's ten are ten."""
    sizes = []
    monkeypatch.setattr(
        statistics,
        "compute_prediction_interval",
        lambda *given: sizes.append(given[2]) or (9.0, 11.0),
    )
    least(10.0, n=10)
    assert set(sizes) == {10}


def test_lengths_that_count_cells_carry_their_own_bound_and_gap():
    ours = results()
    ours = ours._replace(runs=ours.runs.assign(octile_bound=11.0, path_curve="", path_points=None))
    wanted = {"length": "gap", "cells4": "gap4", "cells8": "gap8"}
    spec = of_values(*((metric, "mean") for metric in wanted), where={"problem": "long"})
    cells = tables.compute_cells(ours, pivot_of(spec), ["problem", "method"])
    for column in ("bound", "least"):
        found = cells.groupby("metric")[column].unique().map(list).to_dict()
        assert found == {"length": [9.0], "cells4": [11.0], "cells8": [11.0]}
    assert {metric: metrics.METRICS[metric].gap for metric in wanted} == wanted


def test_published_number_without_runs_keeps_its_row():
    alone = compare(results(), spec=SPEC | {"where": {"method": ["fast"]}})
    found = row(alone, "long", "plain", "length")
    assert (found["value_published"], found["n_ours"]) == (10, 0)
    assert math.isnan(found["value_ours"])


def test_published_file(tmp_path):
    file = tmp_path / "table.csv"
    file.write_text(
        "problem,term,metric,statistic,n,unit,value\nlong,none,length,mean,,m,3\nlong,NA,length,mean,5,m,\n"
    )
    table = comparison.read_published(str(file), pivot_of(SPEC))
    assert table["term"].to_list() == ["none", "NA"]
    assert table[["n", "value"]].isna().to_numpy().tolist() == [[True, False], [False, True]]


def described(given: dict) -> table_kinds.TableEntry:
    return table_kinds.TABLES[given["kind"]].model_validate({"title": "any"} | given)


def test_a_transcribed_table_is_printed_as_it_stands(tmp_path):
    file = tmp_path / "table1.csv"
    file.write_text("part,value\nmemory,4.0 GB\nNA,\n")
    spec = described({"kind": "transcribed", "published": "table1.csv"})
    table = listing.build_listing(spec, {"table1": str(file)}, {})
    assert table.to_csv(index=False) == file.read_text()


def test_a_table_of_a_function_is_computed_from_the_published_numbers(tmp_path):
    file = tmp_path / "table2.csv"
    file.write_text("method,value\nplain,2.5\n")
    table = listing.build_listing(
        described({"kind": "function", "function": "twice"}),
        {"table2": str(file)},
        {"twice": lambda tables: 2 * tables["table2"][["value"]]},
    )
    assert table["value"].tolist() == [5.0]


def test_a_printed_length_is_compared_with_the_metric_that_the_table_reads_it_as(tmp_path):
    file = tmp_path / "table.csv"
    file.write_text(
        "method,metric,statistic,n,unit,value\nplain,length,mean,10,m,3\nplain,cpu_s,mean,10,s,4\n"
    )
    for reads, metric in (({"length": "cells4"}, "cells4"), ({}, "length")):
        spec = pivot_of(SPEC | {"published": "table.csv", "reads": reads})
        assert comparison.read_published(str(file), spec)["metric"].to_list() == [metric, "cpu_s"]


def test_printed_ranks_that_no_runs_have_are_impossible():
    """Two methods' mean ranks add to 3 on every problem, up to rounding; on the long one these do
    not.
    """
    spec = {"index": ["method"], "columns": ["problem", "value"]}
    spec |= {"values": [{"metric": "rank", "statistic": "mean"}]}
    ours = results()
    runs = ours.runs[ours.runs["method"] != "faster"].assign(
        objective=ours.runs["length"], condition=ours.runs["problem"], vary=""
    )
    places = [*itertools.product(("long", "brief"), ("plain", "fast"))]
    numbers = printed("rank", "mean", 20, dict(zip(places, (1.2, 1.6, 1.4, 1.7))))
    table = beside(ours._replace(runs=runs), spec, numbers)
    found = table.set_index(["problem", "method"])["possible"]
    assert found[places].to_list() == [False, False, True, True]


@pytest.mark.parametrize(
    ("statistic", "published", "possible"),
    [
        *(("share", 1.0, True), ("share", 1.1, False), ("share", -0.1, False)),
        *(("std", 0.0, True), ("std", -0.1, False), ("std", 99.0, True)),
        *(("mean", 5.0, True), ("mean", 4.96, True), ("mean", 4.94, False), ("mean", 9.06, False)),
    ],
)
def test_a_printed_number_is_possible_within_the_range_of_its_statistic(
    statistic, published, possible
):
    """Of twenty runs with values from 5 to 9; the mean is printed with one decimal."""
    row = {"statistic": statistic, "value_published": published, "least": 5.0, "most": 9.0}
    row |= {"decimals": 1 if statistic == "mean" else 6, "bound": 0.0, "metric": "objective"}
    assert comparison.is_possible(row, 20) == possible


@pytest.mark.parametrize(
    ("found", "ours", "decimals", "shown", "below", "above"),
    [
        ((14.6, 31.4), 20.0, 0, (15, 31), 14, 32),
        ((14.5, 31.5), 20.0, 0, (14, 32), 13, 33),  # what lies half a unit away belongs to it
        ((10.0, 10.0), 10.0, 3, (9.99, 10.01), 9.989, 10.011),  # 0.1 % of ours to each side
        ((32.3848, 32.3848), 32.3848, 4, (32.3524, 32.4172), 32.35, 32.42),
        ((-math.inf, 3.0), 2.0, 1, (-math.inf, 3.0), -math.inf, 3.1),
        ((0.035, 0.145), 0.1, 2, (0.03, 0.15), 0.02, 0.16),  # whatever binary fractions say
    ],
)
def test_a_printed_number_has_a_position(found, ours, decimals, shown, below, above):
    low, high = comparison.round_range(found, ours, decimals)
    assert (low, high) == pytest.approx(shown)
    assert comparison.find_position(above, low, high) == "above"
    assert (
        comparison.find_position(low, low, high)
        == comparison.find_position(high, low, high)
        == "inside"
    )
    assert below == low or comparison.find_position(below, low, high) == "below"
    assert comparison.find_position(ours, math.nan, math.nan) == comparison.NO_RANGE


@pytest.mark.parametrize(
    ("printed", "size", "expected"),
    [(10.5, 10, True), (10.6, 10, False), (-0.5, 10, True), (-0.6, 10, False), (1e6, None, True)],
)
def test_a_count_can_be_none_to_all_of_the_runs_but_for_its_rounding(printed, size, expected):
    row = {"least": 5.0, "most": 6.0, "statistic": "count", "decimals": 0}
    assert comparison.is_possible(row | {"value_published": printed}, size) == expected
