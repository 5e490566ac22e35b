"""The page: addresses, what is computed for it, and its text."""

import math
import re
import sys
import zlib
from base64 import b64decode
from pathlib import Path

import pandas as pd
import pytest
from bs4 import BeautifulSoup

sys.path.insert(0, str(Path(__file__).parent))
from page_content import SVG, job, page

from bezierplan.figures.page import build, charts, overview, reader


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
# What is read and said


def test_numbers_stand_beside_published_ones_with_how_near_they_are(content):
    table, more, _ = content.studies["one"].tables
    first, second, third = table["numbers"]
    assert first["address"] == "one/table1/a/length/mean"
    for end in ("low", "high"):
        assert first["bar"][end] == second["bar"][end], "one axis a column"
    assert second["bar"]["ours"] > first["bar"]["ours"]
    assert (second["beside"], second["value_published"]) == (14, 10.51)
    assert [cell["counted"] for cell in (first, second, third)] == [True] * 3
    assert more["numbers"] == []


def test_a_printed_table_has_the_papers_rows_and_columns_with_both_numbers_in_each_cell(content):
    first, second, third = content.studies["one"].tables[0]["numbers"]
    laid = content.studies["one"].tables[0]["laid"]
    assert laid["head"] == ["method", "length", "objective"]
    assert laid["rows"] == [
        (["a"], [("10.715", first), ("10.715", third)]),
        (["b"], [("14.000", second), ("", None)]),
    ]


def test_counts_are_shown_for_as_many_runs_as_the_paper_made():
    cell = {"method": "a", "metric": "length", "statistic": "count", "value_published": 5.0}
    cell |= {"value_ours": 220.0, "value_ours_scaled": 5.5, "position": "no range"}
    _, spec = job().studies["one"].tables["table1"]
    empty = pd.DataFrame()
    (found,) = reader._list_numbers("one/t", pd.DataFrame([cell]), spec, empty, empty, {})
    assert found["beside"] == 5.5


def test_evidence_of_many_runs_stands_in_place_of_the_verdicts_of_a_mirror(content, folder):
    numbers, claims = (reader.read(folder / f"{name}.csv") for name in ("numbers", "claims"))
    numbers["n_ours"], claims["verdict"] = 4000, "partly"
    nothing = pd.DataFrame(columns=["study", "table", "id", "variant"])
    evidence = reader.Evidence(numbers, claims, nothing, nothing)
    own = reader.read_study_results(job()._replace(outcome=["one"]), folder, None, evidence)["one"]
    assert [cell["n_ours"] for cell in own.tables[0]["numbers"]] == [4000] * 3
    assert {claim["verdict"] for claim in own.claims} == {"partly"}
    assert own.families is None
    alone = reader.read_study_results(job(), folder, None)["one"]
    assert {claim["verdict"] for claim in alone.claims} > {"supported"}


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


def test_a_caption_has_findings_with_verdicts(text, content):
    """Those of the scale, where the outcome keeps none."""
    block = text.split('id="one/table1"')[1].split("</summary>")[1].split("</p>")[0]
    told = re.findall(r'href="#one/(C\d+)">[^<]*</a>: ([^.]+)\.', block)
    assert "onerror" in block, "the remark"
    assert dict(told) == {
        "C1": "supported",
        "C2": "contradicted",
    }
