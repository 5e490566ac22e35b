"""The page: addresses, what is computed for it, and its text."""

import math
import re
import sys
import zlib
from base64 import b64decode
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
from bs4 import BeautifulSoup
from hypothesis import given
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).parent))
from page_content import SVG, job, page

from bezierplan.figures.page import addresses, build, charts, overview, reader, runs
from bezierplan.figures.page.page_job import ExperimentView
from bezierplan.figures.panels import paths
from bezierplan.geometry import curves
from bezierplan.running import problems as problem_files
from bezierplan.running import table_files
from bezierplan.running.inputs import Files
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Path as Curve
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import ChangingCells


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("page")


@pytest.fixture(scope="module")
def content(folder):
    return page(folder)


@pytest.fixture(scope="module")
def text(content, folder):
    return build.render_page(content, folder)


@pytest.fixture(scope="module")
def elements(text):
    """The page as a tree."""
    return BeautifulSoup(text, "html.parser")


def test_page_asks_for_no_other_file_while_scripts_run(text):
    shown = re.sub("<noscript>.*?</noscript>", "", text, flags=re.DOTALL)
    sources = re.findall(r'\b(?:src|srcset|poster)="([^"]*)"', shown)
    assert sources
    assert all(source.startswith("data:") for source in sources)
    assert "@import" not in text


def test_addresses_are_unique_and_every_link_within_the_page_has_its_place(elements):
    places = [each["id"] for each in elements(id=True)]
    assert len(places) == len(set(places))
    links = {link["href"] for link in elements("a")}
    assert {link[1:] for link in links if link.startswith("#")} <= set(places)
    assert {"one/table1/a/length/mean", "one/C2", "one/table1", "one/O1"} <= set(places)


def test_pictures_have_their_size_before_they_are_unpacked(elements):
    (picture,) = elements.select("[data-packed]")
    assert (picture["width"], picture["height"]) == ("144", "72")
    assert picture["alt"] == "Figure 1: Lengths. (a) lowest mean: b."
    assert zlib.decompress(b64decode(picture["data-packed"])).decode() == SVG


# --------------------------------------------------------------------------------------------------
# Addresses


@given(
    st.lists(
        st.tuples(st.sampled_from("abc"), st.sampled_from([1, 2, 0.5, "a"])),
        min_size=1,
        unique=True,
    ),
    st.sampled_from("abc"),
)
def test_addresses_of_different_cells_differ(keys, primary):
    cells = [
        {"name": name, "value": value, "metric": "m", "statistic": "s"} for name, value in keys
    ]
    found = addresses.build_cell_addresses("t/t1", cells, {"name": primary})
    assert len(set(found)) == len(cells)
    assert not any(" " in each for each in found)


# --------------------------------------------------------------------------------------------------
# What is read and said


def test_numbers_stand_beside_published_ones_with_how_near_they_are(content):
    table, more, _ = content.studies["one"].tables
    (first, second, third), other = table["numbers"], more["numbers"][-1]
    assert first["address"] == "one/table1/a/length/mean"
    for end in ("low", "high"):
        assert first["bar"][end] == second["bar"][end], "one axis a column"
    assert second["bar"]["ours"] > first["bar"]["ours"]
    assert (second["beside"], second["value_published"]) == (14, 10.51)
    assert [cell["counted"] for cell in (first, second, third, other)] == [True] * 3 + [False]
    assert other["value_published"] is None


def test_a_printed_table_has_the_papers_rows_and_columns_with_both_numbers_in_each_cell(content):
    first, second, third = content.studies["one"].tables[0]["numbers"]
    laid = content.studies["one"].tables[0]["laid"]
    assert laid["head"] == ["method", "length", "objective"]
    assert laid["rows"] == [
        (["a"], [("10.51", "10.715", first), ("10.51", "10.715", third)]),
        (["b"], [("10.51", "14.000", second), ("", "", None)]),
    ]
    assert content.studies["one"].tables[0]["order_and_level"] == "", (
        "few runs judge no column as a whole"
    )


def test_counts_are_shown_for_as_many_runs_as_the_paper_made():
    cell = {"method": "a", "metric": "length", "statistic": "count", "value_published": 5.0}
    cell |= {"value_ours": 220.0, "value_ours_scaled": 5.5, "position": None}
    _, spec = job().studies["one"].tables["table1"]
    empty = pd.DataFrame()
    (found,) = reader._list_numbers("one/t", pd.DataFrame([cell]), spec, empty, empty, {})
    assert found["beside"] == 5.5
    assert math.isclose(found["beside"], 1.1 * found["value_published"])


def test_evidence_of_many_runs_stands_in_place_of_the_verdicts_of_a_mirror(content, folder):
    numbers, claims = (reader.read(folder / f"{name}.csv") for name in ("numbers", "claims"))
    numbers["n_ours"], claims["verdict"] = 4000, "partly"
    nothing = pd.DataFrame(columns=["study", "table", "id", "variant"])
    (file,) = (folder / "one").rglob("table1.order_and_level.csv")
    columns = reader.read(file).assign(study="one", table="table1")
    evidence = reader.Evidence(numbers, claims, nothing, nothing, columns)
    own = reader.read_study_results(job()._replace(outcome=["one"]), folder, None, evidence)["one"]
    assert [cell["n_ours"] for cell in own.tables[0]["numbers"]] == [4000] * 3
    assert {claim["verdict"] for claim in own.claims} == {"partly"}
    assert own.families is None
    assert own.tables[0]["order_and_level"] == (
        "length: the methods' order is reversed (rank correlation -0.5; ours 0 to 1)"
    )
    alone = reader.read_study_results(job(), folder, None)["one"]
    assert {claim["verdict"] for claim in alone.claims} > {"supported"}


def test_row_holds_all_columns_of_its_keys_and_other_interpretations_come_last(content):
    laid = build.build_grid(content.studies["one"].tables[1], {})
    assert (laid.head, laid.decimals) == (["method", "length", "objective"], [2, 2])
    assert [
        (primary, keys, [cell and cell["address"] for cell in cells])
        for primary, keys, cells in laid.rows
    ] == [
        (True, [("a", "one/method/a")], [f"one/more/a/{m}/mean" for m in laid.head[1:]]),
        (True, [("b", "one/method/b")], ["one/more/b/length/mean", None]),
        (False, [("c", "one/method/c")], ["one/more/c/length/mean", None]),
    ]


def test_a_scale_says_how_many_runs_it_has_and_where_the_evidence_is():
    alone = overview.describe_scale("full", [[10, 30], [100, 100], []], False)
    assert alone.endswith(
        "as many runs as the papers report: 10 to 100 runs per method and condition."
    )
    assert "docs/outcome" in overview.describe_scale("full", [[10, 30]], True)


def test_the_answer_to_a_paper_stands_first_and_at_its_head(text):
    first, _, rest = text.partition('id="one"')
    head, _, _ = rest.partition('id="page-claims/one"')
    for part in (first, head):
        assert "One fails.</strong> &lt;/script&gt;" in part


def test_the_page_says_what_to_use_with_a_command_on_a_map_that_exists(text):
    (map_file,) = re.findall(r"bezierplan plan (\S+) --start", text)
    assert (Path(__file__).parents[1] / map_file).is_file()


# --------------------------------------------------------------------------------------------------
# Charts


def comparison(effect, low, high):
    row = {"check": 1, "test": "lower", "metric": "length", "statistic": "mean", "unit": "unit"}
    row |= {"primary": True, "effect": effect, "low95": low, "high95": high, "reference": 0.0}
    return row | {"effect_published": None, "margin": 0.1}


def test_strips_share_one_scale_and_keep_order():
    (rows,) = charts.group_comparisons([comparison(-1.0, -2.0, -0.2), comparison(0.5, 0.1, 1.0)])
    first, second = (row["strip"] for row in rows)
    assert first["reference"] == second["reference"]
    places = [strip[name] for strip in (first, second) for name in ("low95", "effect", "high95")]
    assert places == sorted(places)
    assert places[2] < first["reference"] < places[3]
    # Places are linear in effects.
    assert math.isclose((places[4] - places[1]) / (places[2] - places[0]), 1.5 / 1.8, rel_tol=1e-3)
    assert first["margin"][0] < first["reference"] < first["margin"][1]


def test_interval_far_beyond_the_effects_is_cut_and_an_unknown_effect_is_not_drawn():
    rows = [comparison(-1.0, -500.0, 0.5), comparison(1.0, 0.5, 1.5), comparison(None, None, None)]
    (rows,) = charts.group_comparisons(rows)
    assert [row["strip"]["cut"] for row in rows] == [True, False, False]
    assert (rows[2]["strip"]["effect"], rows[2]["strip"]["low95"]) == (None, None)


# --------------------------------------------------------------------------------------------------
# Runs


def stored(folder, lengths, feasible, **more):
    """Files of runs of a method m on an empty room, whose paths are straight."""
    room = Problem(
        "room", from_lines(["....", "....", "...."], cell=1.0, unit="m"), (0.5, 0.5), (3.5, 0.5)
    )
    problem_files.write({"room": room}, {"room": "room"}, str(folder / "p.parquet"))
    table_files.write(
        problem_files.compute_bounds({"room": room}, {}), str(folder / "p.bounds.parquet")
    )
    row = {"problem": "room", "method": "m", "claimed_feasible": True, "collision_depth": 0.0}
    row |= {"clearance": 0.1, "evaluations": 5, "stop": "generations", "path_curve": "polyline"}
    row |= {"history": [5.0, 5.0, 4.0, 4.0], "path_points": [0.5, 0.5, 3.5, 0.5]}
    rows = [
        row
        | {"id": f"s/e/room/m/{n}", "repeat": n, "feasible": ok, "length": length}
        | {"collision_at": math.nan if ok else 0.5}
        | more
        for n, (length, ok) in enumerate(zip(lengths, feasible, strict=True))
    ]
    parquet.write_table(pa.Table.from_pylist(rows), folder / "0.parquet")
    files = (str(folder / name) for name in ("p.parquet", "p.bounds.parquet"))
    return Files({"m": [str(folder / "0.parquet")]}, *files)


def test_best_median_worst_and_the_first_failed_runs_are_shown(tmp_path):
    files = stored(tmp_path, [5.0, 3.5, 4.0, 9.0, 8.0, 7.0, 6.0], [True] * 4 + [False] * 3)
    (shown,), found = runs.choose_runs("s", "e", ExperimentView(["m"], 7, False), files)
    assert (shown["count"], shown["feasible"]) == (7, 4)
    assert [shown["best"], shown["median"], shown["worst"], *shown["failed"]] == [
        f"s/e/room/m/{n}" for n in (1, 2, 3, 4, 5)
    ]
    assert math.isclose(shown["gap"], 1 / 3, rel_tol=1e-6)
    assert found["runs"].keys() == {f"s/e/room/m/{n}" for n in (1, 2, 3, 4, 5)}
    assert found["runs"]["s/e/room/m/4"]["collision"] == [2.0, 0.5]
    assert found["runs"]["s/e/room/m/1"]["history"] == [(0, 5.0), (2, 4.0), (3, 4.0)]
    assert found["problems"]["s/e/room"]["bound"] == 3.0
    # Repeats that a chunk has beyond those of the scale are not shown.
    (shown,), _ = runs.choose_runs("s", "e", ExperimentView(["m"], 1, False), files)
    assert (shown["best"], shown["count"]) == ("s/e/room/m/0", 1)


def test_place_of_a_drive_is_found_where_its_way_crosses_itself():
    # To the right, back through the same places, then up; the robot waits at the first place.
    path = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 0.0], [0.0, 1.5]])
    places = [(0, 0), (0, 0), (1, 0), (2, 0), (3, 0), (2, 0), (1, 0), (0, 0), (0, 1), (0, 1.5)]
    assert np.allclose(
        runs._measure_way(path, np.array(places, dtype=float), 1.0),
        [0, 0, 1, 2, 3, 4, 5, 6, 7, 7.5],
    )


def test_drive_is_shown_with_its_time_and_the_place_of_its_collision(tmp_path):
    files = stored(tmp_path, [3.0], [False], collision_at=1.5, steps=2.5)
    empty = from_lines(["....", "....", "...."], cell=1.0, unit="m")
    later = from_lines(["#...", "....", "...#"], cell=1.0, unit="m")
    room = {"room": Problem("room", empty, (0.5, 0.5), (3.5, 0.5))}
    world = ChangingCells((empty, later), np.array([2.0]), 1.0, 9)
    problem_files.write(room, {"room": "room"}, files.problems, {"room": world})
    trace = [{"id": "s/e/room/m/0", "x": [0.5, 1.5, 2.5, 3.5], "y": [0.5] * 4}]
    parquet.write_table(pa.Table.from_pylist(trace), tmp_path / "0.traces.parquet")
    _, found = runs.choose_runs("s", "e", ExperimentView(["m"], 1, True), files)
    (drive,) = found["runs"].values()
    assert (drive["steps"], drive["driven"], drive["control"]) == (2.5, [0, 1, 2, 3], [])
    assert (drive["collision"], drive["collision_step"]) == ([2.0, 0.5], 1.5)
    moving = found["problems"]["s/e/room"]["world"]
    assert (moving["moments"], moving["changed"]) == ([2.0], [[0, 11]])


@given(
    # Thousandths, because shapely's simplification fails on numbers near the smallest.
    st.lists(st.tuples(st.integers(0, 10**5), st.integers(0, 10**5)), min_size=4, max_size=8),
    st.sampled_from(["bezier", "polyline", "piecewise_quadratic"]),
)
def test_drawn_path_stays_within_its_tolerance(points, kind):
    import shapely

    path = Curve(kind, np.array(points) / 1000)
    drawn = runs._reduce_points(paths.sample_path(path), 0.05)
    exact = curves.sample_matrix(kind, len(points), 301) @ path.points
    # The straight steps from which points are left out are themselves within 0.01 of the curve.
    assert shapely.distance(shapely.points(exact), shapely.LineString(drawn)).max() <= 0.05 + 0.01


def test_a_caption_has_findings_with_verdicts(text, content):
    """Those of the scale, where the outcome keeps none."""
    block = text.split('id="one/table1"')[1].split("</summary>")[1].split("</p>")[0]
    told = re.findall(r'href="#one/(C\d+)">[^<]*</a>: ([^.]+)\.', block)
    assert "onerror" in block, "the remark"
    assert dict(told) == {
        "C1": "supported",
        "C2": "contradicted",
    }
