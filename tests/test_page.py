"""The page: addresses, what is computed for it, and its text."""

import json
import math
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import jsonschema
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
from hypothesis import given
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).parent))
from page_content import HOSTILE, comparison, number, page

from bezierplan.figures.page import HERE, addresses, answer, build, content, gather, pictures, runs
from bezierplan.geometry import curves
from bezierplan.running import problems as problem_files
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Path as Curve
from bezierplan.workspaces.problem import Problem


class Reader(HTMLParser):
    """Elements of a page, by what a test asks of them."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.blocks, self._block = [], {}, None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        self._block = dict(attributes).get("id") if tag == "script" else None

    def handle_data(self, data):
        if self._block:
            self.blocks[self._block] = data

    def handle_endtag(self, tag):
        self._block = None


@pytest.fixture(scope="module")
def text():
    return build.html(page(), Path())


@pytest.fixture(scope="module")
def read(text):
    return Reader(text)


def test_hostile_words_stay_words(read):
    assert not [tag for tag, attributes in read.elements if tag == "img" or "onerror" in attributes]
    assert sum(tag == "script" for tag, _ in read.elements) == 5
    assert json.loads(read.blocks["page-data"])["studies"]["one"]["title"] == HOSTILE


def test_data_block_obeys_the_schema_of_the_page_and_restores_the_content(read):
    data, schema = (json.loads(read.blocks[name]) for name in ("page-data", "page-schema"))
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.validate(data, schema)
    assert content.Page.model_validate(data) == page()
    del data["studies"]["one"]["claims"][0]["verdict"]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(data, schema)


def test_page_asks_for_no_other_file(read):
    sources = [attributes[name] for _, attributes in read.elements for name in ("src", "srcset", "poster") if name in attributes]
    sources += [attributes["href"] for tag, attributes in read.elements if tag == "link"]
    assert all(source.startswith("data:") for source in sources)
    assert "@import" not in HERE.joinpath("static/page.css").read_text()


def test_addresses_are_unique_and_every_link_within_the_page_has_its_place(read):
    places = [attributes["id"] for _, attributes in read.elements if "id" in attributes]
    assert len(places) == len(set(places))
    links = {attributes["href"][1:] for tag, attributes in read.elements if tag == "a" and attributes["href"].startswith("#")}
    assert links <= set(places)
    assert {"one/table1/a/length/mean", "one/C2", "one/table1", "one/O1"} <= set(places)


def test_same_content_gives_the_same_bytes(text):
    assert build.html(page(), Path()) == text


def test_scripts_never_insert_markup():
    for file in HERE.glob("static/*.js"):
        assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(", file.read_text())
    assert sum(len(file.read_text().splitlines()) for file in HERE.glob("static/*.js")) < 400


# ---------------------------------------------------------------------------------------------------------------------
# Addresses


def test_cell_is_named_by_what_tells_it_from_the_primary_reading():
    cells = [
        {"method": method, "workspace": room, "profile": "default", "metric": "objective", "statistic": "mean"}
        for method in ("singer", "gauss")
        for room in ("equal", "other")
    ]
    found = addresses.of_cells("t/table3", cells, {"workspace": "equal"})
    assert found[:2] == ["t/table3/singer/objective/mean", "t/table3/singer/other/objective/mean"]


def test_cells_that_would_share_an_address_name_all_their_keys():
    cells = [{"a": "x", "b": "y", "metric": "m", "statistic": "s"}, {"a": "y", "b": "x", "metric": "m", "statistic": "s"}]
    cells += [{"a": "x", "b": "x", "metric": "m", "statistic": "s"}]
    found = addresses.of_cells("t/t1", cells, {"a": "x", "b": "x"})
    assert found == ["t/t1/x/y/m/s", "t/t1/y/x/m/s", "t/t1/m/s"]


@given(st.lists(st.tuples(st.sampled_from("ab c"), st.integers(0, 3)), unique=True, min_size=1), st.sampled_from("ab"))
def test_addresses_tell_cells_apart(keys, primary):
    cells = [{"name": name, "value": value, "metric": "m", "statistic": "s"} for name, value in keys]
    found = addresses.of_cells("t/t1", cells, {"name": primary})
    assert len(set(found)) == len(cells)
    assert not any(" " in each for each in found)


# ---------------------------------------------------------------------------------------------------------------------
# The answer


def said(sentences):
    return ["".join(part.text for part in sentence) for sentence in sentences]


def test_answer_counts_numbers_and_claims_and_links_to_those_that_fail():
    sentences = page().answer
    words = said(sentences)
    assert words[0].startswith("Of 3 published numbers that can be judged, 1 (33 %) are reproduced, 1 (33 %) agree")
    assert words[1] == "Of 2 sentences that the papers state, 1 is supported and 1 is contradicted."
    assert words[2].startswith(
        "one reproduces in part: 1 reproduced, 1 not, 1 not decisive; 1 of 2 claims supported; against the paper: C2"
    )
    assert content.Part(text="C2", address="one/C2") in sentences[2]
    assert "1 of 2 claims that can be read in several ways" in " ".join(words)
    assert "1 of 1 checks" in " ".join(words)
    assert "39.6 %" in words[-1]


@pytest.mark.parametrize(
    ("good", "bad", "count", "word"),
    [
        (1, 0, 16, "can hardly be judged"),
        (3, 0, 3, "reproduces"),
        (3, 1, 4, "mostly reproduces"),
        (1, 3, 4, "hardly reproduces"),
        (2, 2, 4, "reproduces in part"),
        (0, 3, 4, "does not reproduce"),
    ],
)
def test_degree_of_reproduction_follows_the_shares_of_verdicts(good, bad, count, word):
    assert answer._degree(good, bad, count).startswith(word)


def test_scale_without_judged_numbers_says_so():
    bare = page().studies["one"].model_copy(update={"claims": [], "tables": [], "audit": []})
    assert said(answer.answer({"one": bare})) == ["A subset that shows how the page works: no runs, too few to judge numbers or claims."]


# ---------------------------------------------------------------------------------------------------------------------
# Pictures


def test_strips_share_one_scale_and_keep_order():
    (forest,) = pictures.forests([comparison(-1.0, -2.0, -0.2), comparison(0.5, 0.1, 1.0)])
    first, second = forest.strips
    assert first.zero == second.zero
    assert 0 < first.low < first.effect < first.high < first.zero < second.low < second.effect < second.high < 100
    # Places are linear in effects.
    assert math.isclose((second.effect - first.effect) / (first.high - first.low), 1.5 / 1.8, rel_tol=1e-3)
    assert first.margin[0] < first.zero < first.margin[1]


def test_interval_far_beyond_the_effects_is_cut_and_says_so():
    (forest,) = pictures.forests([comparison(-1.0, -500.0, 0.5), comparison(1.0, 0.5, 1.5)])
    assert [strip.cut for strip in forest.strips] == [True, False]


def test_unknown_effect_leaves_the_strip_empty():
    (forest,) = pictures.forests([comparison(None, None, None, "?")])
    assert (forest.strips[0].effect, forest.strips[0].low) == (None, None)


def test_figure_in_the_page_keeps_its_words_and_its_shape(tmp_path):
    import matplotlib.pyplot as plt
    from matplotlib.figure import Figure

    from bezierplan.figures import sheet, style

    with plt.rc_context(style.SETTINGS):
        figure = Figure(figsize=(2, 1))
        figure.add_subplot().plot([0, 1], [0, 1.2345678], label="a & b < 'c' 1.23456")
        figure.legend()
    sheet.save(figure, str(tmp_path / "a.svg"), str(tmp_path / "a.png"))
    uri = pictures.data_uri(tmp_path / "a.svg")
    small = unquote(uri.removeprefix("data:image/svg+xml,"))
    assert not set('"#&') & set(uri)
    assert "a &amp; b &lt; 'c' 1.23456" in small
    was = [float(each) for each in re.findall(r"[ML] (\S+)", (tmp_path / "a.svg").read_text())]
    now = [float(each) for each in re.findall(r"[ML] (\S+)", small)]
    assert len(was) == len(now)
    assert np.allclose(was, now, atol=0.0051, rtol=0)
    assert pictures.size(tmp_path / "a.svg") == (144, 72)


# ---------------------------------------------------------------------------------------------------------------------
# Tables


def test_row_holds_all_columns_of_its_keys_and_other_readings_come_last():
    table = page().studies["one"].tables[0]
    laid = build.grid(table, {})
    assert (laid.keys, laid.columns, laid.decimals) == (["method"], ["length", "objective"], [2, 2])
    assert [(row.keys, [cell and cell.address for cell in row.cells], row.primary) for row in laid.rows] == [
        (["a"], ["one/table1/a/length/mean", "one/table1/a/objective/mean"], True),
        (["b"], ["one/table1/b/length/mean", None], True),
        (["c"], ["one/table1/c/length/mean", None], False),
    ]


def test_tip_gives_interval_n_share_and_bound():
    words = build.tip(number("a/length", "reproduced"))
    for each in (
        "published 10.51 (n 10)",
        "95 % interval 10.2 to 11.1, n 10",
        "size: 10.1 to 11.3",
        "feasible 90 %",
        "exact bound 7.7, gap 39.6 %",
    ):
        assert each in words


def test_column_that_the_page_does_not_know_is_kept_with_the_claim():
    row = {
        "study": "one",
        "id": "C1",
        "primary": True,
        "finding": False,
        "verdict": "supported",
        "variant": np.nan,
        "artefact": "table1, figure2",
    }
    (found,) = gather._claims("one", pd.DataFrame([row | {"verdict_at_paper_size": "undecided"}]), None, [], {})
    assert found.more == {"verdict_at_paper_size": "undecided"}
    assert found.shown_in == ["one/table1", "one/figure2"]


def test_alternative_judged_beside_another_verdict_is_out_of_date():
    tried = pd.DataFrame(
        {
            "assumption": "O1",
            "alternative": [8, 8],
            "claim": ["C1", "C2"],
            "verdict": ["supported", "supported"],
            "verdict_alternative": "undecided",
        }
    )
    judged = pd.DataFrame({"id": ["C1", "C2"], "primary": True, "verdict": ["supported", "contradicted"]})
    assert [choice.claim for choice in gather._choices(tried, judged)] == ["C1"]


# ---------------------------------------------------------------------------------------------------------------------
# Runs


def stored(folder, lengths, feasible):
    """Files of runs of a method m on an empty room, whose paths are straight."""
    room = Problem("room", from_lines(["....", "....", "...."], cell=1.0, unit="m"), (0.5, 0.5), (3.5, 0.5))
    problem_files.write({"room": room}, {"room": "room"}, str(folder / "p.parquet"))
    parquet.write_table(problem_files.bounds_of({"room": room}), folder / "p.bounds.parquet")
    rows = [
        {"id": f"s/e/room/m/{n}", "problem": "room", "method": "m", "repeat": n, "feasible": ok, "length": length, "claimed_feasible": True}
        | {"collision_at": math.nan if ok else 0.5, "collision_depth": 0.0, "clearance": 0.1, "evaluations": 5, "stop": "generations"}
        | {"history": [5.0, 5.0, 4.0, 4.0], "path_curve": "polyline", "path_points": [0.5, 0.5, 3.5, 0.5]}
        for n, (length, ok) in enumerate(zip(lengths, feasible, strict=True))
    ]
    parquet.write_table(pa.Table.from_pylist(rows), folder / "0.parquet")
    files = {"runs": [str(folder / "0.parquet")], "problems": str(folder / "p.parquet"), "bounds": str(folder / "p.bounds.parquet")}
    return {"methods": ["m"], "repeats": len(rows)} | files


def test_best_median_worst_and_the_first_failed_runs_are_shown(tmp_path):
    lengths, feasible = [5.0, 3.5, 4.0, 9.0, 8.0, 7.0, 6.0], [True, True, True, True, False, False, False]
    found = runs.chosen("s", "e", stored(tmp_path, lengths, feasible))
    (shown,) = found.shown
    assert (shown.count, shown.feasible) == (7, 4)
    assert [shown.best, shown.median, shown.worst, *shown.failed] == [f"s/e/room/m/{n}" for n in (1, 2, 3, 4, 5)]
    assert found.runs.keys() == {f"s/e/room/m/{n}" for n in (1, 2, 3, 4, 5)}
    assert found.runs["s/e/room/m/4"].collision == (2.0, 0.5)
    assert found.runs["s/e/room/m/1"].history == [(0, 5.0), (2, 4.0), (3, 4.0)]
    assert found.problems["s/e/room"].bound == 3.0


def test_repeats_that_a_chunk_has_beyond_those_wanted_are_not_shown(tmp_path):
    described = stored(tmp_path, [5.0, 4.0, 3.0], [True, True, True]) | {"repeats": 2}
    assert runs.chosen("s", "e", described).shown[0].best == "s/e/room/m/1"


def test_method_without_a_feasible_run_has_failed_ones_only(tmp_path):
    (shown,) = runs.chosen("s", "e", stored(tmp_path, [5.0, 4.0], [False, False])).shown
    assert (shown.best, shown.median, shown.worst, len(shown.failed)) == (None, None, None, 2)


@given(
    # Thousandths, because shapely's simplification fails on numbers near the smallest.
    st.lists(st.tuples(st.integers(0, 10**5), st.integers(0, 10**5)), min_size=4, max_size=8),
    st.sampled_from(["bezier", "polyline", "piecewise_quadratic"]),
)
def test_drawn_path_stays_within_its_tolerance(points, kind):
    import shapely

    path = Curve(kind, np.array(points) / 1000)
    drawn = runs._flattened(path, 0.05)
    exact = curves.sample_matrix(kind, len(points), 301) @ path.points
    # The straight steps from which points are left out are themselves within 0.01 of the curve.
    assert shapely.distance(shapely.points(exact), shapely.LineString(drawn)).max() <= 0.05 + 0.01
