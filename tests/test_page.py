"""The page: addresses, what is computed for it, and its text."""

import json
import math
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
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
from page_content import HOSTILE, claim, comparison, number, page
from page_content import study as page_study
from studies import study

from bezierplan.figures.page import (
    HERE,
    addresses,
    answer,
    build,
    charts,
    content,
    gather,
    job,
    other,
    outcome,
    pictures,
    runs,
    search,
)
from bezierplan.figures.page.page_job import ExperimentShown, FigureShown
from bezierplan.figures.panels import paths
from bezierplan.geometry import curves
from bezierplan.running import problems as problem_files
from bezierplan.running import worlds as world_files
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Path as Curve
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import ChangingCells


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
    assert sum(tag == "script" for tag, _ in read.elements) == 8
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
    sources = [
        attributes[name]
        for _, attributes in read.elements
        for name in ("src", "srcset", "poster")
        if name in attributes
    ]
    sources += [attributes["href"] for tag, attributes in read.elements if tag == "link"]
    assert all(source.startswith("data:") for source in sources)
    assert "@import" not in HERE.joinpath("static/page.css").read_text()


def test_addresses_are_unique_and_every_link_within_the_page_has_its_place(read):
    places = [attributes["id"] for _, attributes in read.elements if "id" in attributes]
    assert len(places) == len(set(places))
    links = {
        attributes["href"][1:]
        for tag, attributes in read.elements
        if tag == "a" and attributes["href"].startswith("#")
    }
    assert links <= set(places)
    assert {"one/table1/a/length/mean", "one/C2", "one/table1", "one/O1"} <= set(places)


def test_same_content_gives_the_same_bytes(text):
    assert build.html(page(), Path()) == text


def test_blanks_before_tags_go_except_where_they_mean_something():
    text = "<p>\n    <b>a</b>\n  b</p>\n  <pre>\n  <td></pre>\n  <script>\n  '<i>'\n  </script>"
    short = "<p>\n<b>a</b>\n  b</p>\n<pre>\n  <td></pre>\n<script>\n  '<i>'\n  </script>"
    assert build._unindented(text) == short
    table = "<table>\n  <tr>\n    <td>1</td>\n    <td>\n2 <b>\n</b></td>\n  </tr>\n</table>"
    assert build._unindented(table) == "<table><tr><td>1</td><td>\n2 <b>\n</b></td></tr></table>"


def test_scripts_never_insert_markup():
    for file in HERE.glob("static/*.js"):
        assert not re.search(
            r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(", file.read_text()
        )
    assert sum(len(file.read_text().splitlines()) for file in HERE.glob("static/*.js")) < 500


# --------------------------------------------------------------------------------------------------
# Addresses


def test_cell_is_named_by_what_tells_it_from_the_primary_interpretation():
    cells = [
        {
            "method": method,
            "workspace": room,
            "profile": "default",
            "metric": "objective",
            "statistic": "mean",
        }
        for method in ("singer", "gauss")
        for room in ("equal", "other")
    ]
    found = addresses.of_cells("t/table3", cells, {"workspace": "equal"})
    assert found[:2] == ["t/table3/singer/objective/mean", "t/table3/singer/other/objective/mean"]


def test_cells_that_would_share_an_address_name_all_their_keys():
    cells = [
        {"a": "x", "b": "y", "metric": "m", "statistic": "s"},
        {"a": "y", "b": "x", "metric": "m", "statistic": "s"},
    ]
    cells += [{"a": "x", "b": "x", "metric": "m", "statistic": "s"}]
    found = addresses.of_cells("t/t1", cells, {"a": "x", "b": "x"})
    assert found == ["t/t1/x/y/m/s", "t/t1/y/x/m/s", "t/t1/m/s"]


@given(
    st.lists(st.tuples(st.sampled_from("ab c"), st.integers(0, 3)), unique=True, min_size=1),
    st.sampled_from("ab"),
)
def test_addresses_tell_cells_apart(keys, primary):
    cells = [
        {"name": name, "value": value, "metric": "m", "statistic": "s"} for name, value in keys
    ]
    found = addresses.of_cells("t/t1", cells, {"name": primary})
    assert len(set(found)) == len(cells)
    assert not any(" " in each for each in found)


# --------------------------------------------------------------------------------------------------
# The answer


def said(sentences):
    return ["".join(part.text for part in sentence) for sentence in sentences]


def test_answer_says_what_fails_in_each_paper_and_links_to_it():
    sentences = page().answer
    assert said(sentences) == [
        "one: 1 of 3 numbers agrees, 1 disagrees; 1 of 2 claims is supported, C2 fails.",
        "1 of 1 supported claims that can be resampled would show again in at least 80\u00a0% of "
        "experiments of the paper's size.",
        "1 of 2 claims that can be interpreted in more than one way keeps its verdict in every "
        "interpretation.",
        "The papers' own numbers contradict each other or an exact bound in 1 of 1 check: one.",
    ]
    assert content.Part(text="C2", address="one/C2") in sentences[0]


def test_five_papers_are_answered_in_eight_sentences():
    own = page().studies["one"]
    good = own.model_copy(update={"claims": own.claims[:1]})
    sentences = answer.answer(dict.fromkeys("abcd", own) | {"e": good})
    assert len(sentences) == 8
    assert (
        said(sentences)[4]
        == "e: 1 of 3 numbers agrees, 1 disagrees; 1 of 1 claim is supported, none fails."
    )
    assert said(sentences)[5].startswith(
        "All 5 supported claims that can be resampled would show again"
    )


def test_claims_that_fail_are_named_with_the_comparison_that_decides():
    own = page().studies["one"]
    assert [(key, claim.id) for key, claim in answer.failing({"x": own, "y": own})] == [
        ("x", "C2"),
        ("y", "C2"),
    ]
    words = [build.evidence(own.claims[0].model_copy(update={"decisive": n})) for n in (0, 1)]
    assert (
        words[0]
        == "exact arc length, a lower than b: effect -1 unit (95\u00a0% interval -2 to -0.2)"
    )
    assert words[1] == "exact arc length, a lower than b: effect 0.4 units"
    assert build.evidence(own.claims[0].model_copy(update={"decisive": None})) == ""
    failed = comparison(None, None, None, "-").model_copy(update={"counted": "0 of 10, 10 of 10"})
    claim = own.claims[0].model_copy(update={"comparisons": [failed], "decisive": 0})
    assert (
        build.evidence(claim)
        == "exact arc length, a lower than b: a value in 0 of 10 and 10 of 10 runs"
    )


def test_scale_without_judged_numbers_says_so():
    bare = page().studies["one"].model_copy(update={"claims": [], "tables": [], "audit": []})
    assert said(answer.answer({"one": bare})) == [
        "A subset that shows how the page works: no runs, too few to judge numbers or claims."
    ]


# --------------------------------------------------------------------------------------------------
# Pictures


def test_strips_share_one_scale_and_keep_order():
    (forest,) = pictures.forests([comparison(-1.0, -2.0, -0.2), comparison(0.5, 0.1, 1.0)])
    first, second = forest.strips
    assert first.zero == second.zero
    assert (
        0
        < first.low
        < first.effect
        < first.high
        < first.zero
        < second.low
        < second.effect
        < second.high
        < 100
    )
    # Places are linear in effects.
    assert math.isclose(
        (second.effect - first.effect) / (first.high - first.low), 1.5 / 1.8, rel_tol=1e-3
    )
    assert first.margin[0] < first.zero < first.margin[1]


def test_interval_far_beyond_the_effects_is_cut_and_says_so():
    (forest,) = pictures.forests([comparison(-1.0, -500.0, 0.5), comparison(1.0, 0.5, 1.5)])
    assert [strip.cut for strip in forest.strips] == [True, False]


def test_unknown_effect_leaves_the_strip_empty():
    (forest,) = pictures.forests([comparison(None, None, None, "?")])
    assert (forest.strips[0].effect, forest.strips[0].low) == (None, None)


def outline(text):
    """Places of an outline in absolute steps (M L Q C z) or relative ones (also h v), control
    points among them.
    """
    places, at, first = [], np.zeros(2), np.zeros(2)
    for name, numbers in re.findall("([A-Za-z])([^A-Za-z]*)", text):
        values = [float(each) for each in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", numbers)]
        values = [values[0], 0.0] if name == "h" else [0.0, values[0]] if name == "v" else values
        if name in "zZ":
            at = first
            continue
        steps = np.reshape(values, (-1, 2)) + (at if name.islower() else 0.0)
        places += steps.tolist()
        at = steps[-1]
        first = at if name in "mM" else first
    return places


def test_outlines_in_short_words():
    assert (
        pictures._stepwise("M 1.5 2 \nL 1.5 0.126 \nL -0.5 .13 \nz \nM 3 3 \nQ 4 3 4 4.004 \n")
        == "m1.5 2v-1.87h-2zm1.5 1q1 0 1 1"
    )


@given(st.lists(st.tuples(*[st.integers(-(10**6), 10**6)] * 4), min_size=1, max_size=30))
def test_relative_steps_add_up_without_drift(steps):
    text = (
        "M 0.5 0.25 "
        + "".join(
            f"Q {a / 1000} {b / 1000} {c / 1000} {d / 1000} L {d / 1000} {b / 1000} "
            for a, b, c, d in steps
        )
        + "z"
    )
    assert np.allclose(outline(text), outline(pictures._stepwise(text)), atol=0.00501, rtol=0)


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
    was = [outline(each) for each in re.findall(r' d="([^"]*)"', (tmp_path / "a.svg").read_text())]
    now = [outline(each) for each in re.findall(r" d='([^']*)'", small)]
    assert [len(each) for each in now] == [len(each) for each in was] != []
    assert all(
        np.allclose(one, other, atol=0.0051, rtol=0) for one, other in zip(was, now, strict=True)
    )
    assert len(re.findall("clip-path:", small)) == 1
    assert pictures.size(tmp_path / "a.svg") == (144, 72)


@pytest.mark.parametrize("seen", ["", "(a) lowest mean: b (1), highest: c (2)."])
def test_a_picture_says_what_is_seen_to_those_who_do_not_see_it(seen, tmp_path):
    from matplotlib.figure import Figure

    from bezierplan.figures import sheet

    folder = tmp_path / "one" / "figures"
    folder.mkdir(parents=True)
    sheet.save(Figure(figsize=(2, 1)), str(folder / "a.svg"), str(folder / "a.png"))
    (folder / "a.txt").write_text(f"(a) run one/first/b/0.\n{seen}\n")
    found = gather._figure("one", "a", FigureShown("Lengths", "Lengths."), tmp_path)
    assert (found.told, found.seen) == ("(a) run one/first/b/0.", seen)
    shown = page()
    studies = {"one": shown.studies["one"].model_copy(update={"figures": [found]})}
    text = build.html(shown.model_copy(update={"studies": studies}), tmp_path)
    assert f'alt="a: Lengths{". " if seen else ""}{seen}"' in text


# --------------------------------------------------------------------------------------------------
# Tables


def test_row_holds_all_columns_of_its_keys_and_other_interpretations_come_last():
    table = page().studies["one"].tables[0]
    laid = build.grid(table, {})
    assert (laid.keys, laid.columns, laid.decimals) == (["method"], ["length", "objective"], [2, 2])
    assert [
        (row.keys, [cell and cell.address for cell in row.cells], row.primary) for row in laid.rows
    ] == [
        (
            [("a", "one/method/a")],
            ["one/table1/a/length/mean", "one/table1/a/objective/mean"],
            True,
        ),
        ([("b", "one/method/b")], ["one/table1/b/length/mean", None], True),
        ([("c", "one/method/c")], ["one/table1/c/length/mean", None], False),
    ]


def test_deviation_is_in_per_cent_of_the_published_number_and_of_counts_for_as_many_runs():
    given = number("a/length", "agrees", published=200.0, ours=198.0)
    assert build.deviation(given) == "-1.0\u00a0%"
    assert build.deviation(given.model_copy(update={"ours": 298.0})) == "+49\u00a0%"
    assert build.deviation(given.model_copy(update={"published": 0.0})) == ""
    count = given.model_copy(
        update={
            "statistic": "count",
            "published": 5.0,
            "n_published": 100.0,
            "ours": 220.0,
            "scaled": 5.5,
            "n": 4000.0,
        }
    )
    assert build.deviation(count) == "+10\u00a0%"
    assert (count.beside, given.beside) == (5.5, 198.0)


def test_the_scale_is_said_first_with_what_the_readme_rests_on():
    repeats = {"full": [[10, 30], [100, 100]], "extended": [[250, 4000]]}
    assert answer.about_scale("full", repeats) == [
        "Scale full has as many runs as the papers report: 10 to 100 per method and condition.",
        "The README's numbers rest on scale extended (250 to 4,000 runs; make extended), so they "
        "can differ from these.",
    ]
    assert answer.about_scale("extended", repeats)[1] == "The README's numbers are of this scale."


def test_the_page_says_what_to_use_with_a_command_on_a_map_that_exists():
    text = build.html(page(), Path())
    assert 'id="page-use"' in text
    (map_file,) = re.findall(r"bezierplan plan (\S+) --start", text)
    assert (Path(__file__).parents[1] / map_file).is_file()


def test_tip_gives_interval_n_share_and_bound():
    words = build.tip(number("a/length", "agrees"))
    for each in (
        "published 10.51 (n 10)",
        "95 % interval 10.2 to 11.1, n 10",
        "size: 10.1 to 11.3",
        "feasible 90 %",
        "exact bound 7.7, gap 39.6 %",
    ):
        assert each in words


def test_numbers_and_claims_stand_next_to_those_of_the_readme():
    row = {"study": "one", "table": "table1", "metric": "length", "statistic": "mean"}
    numbers = pd.DataFrame(
        [
            row
            | {"method": method, "obstacles": 5.0, "value_ours": ours, "value_ours_scaled": scaled}
            | {"n_ours": 4000, "verdict": "disagrees", "counted": True, "primary": True}
            for method, ours, scaled in (("a", 10.9, np.nan), ("b", 400.0, 4.0))
        ]
    )
    claims = pd.DataFrame(
        [
            {"study": "one", "id": "C1", "primary": primary, "verdict": verdict, "n": 4000.0}
            | {"holds": "0 of 2"}
            for primary, verdict in ((False, "supported"), (True, "contradicted"))
        ]
    )
    shown = page_study(
        [claim("C1", "supported"), claim("C2", "supported")],
        [
            number("a/length", "agrees", keys={"method": "a", "obstacles": 5}),
            number("b/length", "agrees", keys={"method": "b", "obstacles": 5}),
            number("a/length", "agrees", keys={"method": "a", "obstacles": 10}),
        ],
    )
    readme = outcome.Outcome(numbers, claims, pd.DataFrame({"study": []}))
    found = outcome.beside({"one": shown}, readme)["one"]
    first, second = found.claims
    assert (first.extended.verdict, first.extended.holds, first.extended.n) == (
        "contradicted",
        "0 of 2",
        4000,
    )
    assert second.extended is None
    mean, count, other = found.tables[0].numbers
    assert (mean.extended.ours, count.extended.ours, other.extended) == (10.9, 4.0, None)
    assert "README, at scale extended: ours 10.9, n 4000, disagrees" in build.tip(mean)
    assert "README" not in build.tip(other)


def test_the_readmes_headline_is_of_the_studies_of_the_page():
    titles = {key: f"{key}: its title" for key in ("ma2020", "song2016", "my_own")}
    readme = outcome.kept()
    first = outcome.sentences(readme, titles)[0]
    counted = readme.numbers[readme.numbers["counted"].astype(bool)]
    assert first.startswith(f"Of {counted['study'].isin(titles).sum()} published numbers, ")


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
    judged = pd.DataFrame([row | {"verdict_at_paper_size": "undecided"}])
    known = SimpleNamespace(labels={}, tables={"table1": ...}, figures={"figure2": ...}, checks={})
    (found,) = gather._claims("one", judged, None, [], known)
    assert found.more == {"verdict_at_paper_size": "undecided"}
    assert found.shown_in == ["one/table1", "one/figure2"]
    known.figures = {}
    (found,) = gather._claims("one", judged, None, [], known)
    assert found.shown_in == ["one/table1"]


def test_method_with_corners_has_no_number_of_curvature():
    row = {
        "study": "one",
        "method": "a",
        "baseline": "rounded",
        "conditions": 2,
        "feasible": 0.5,
        "feasible_baseline": 1.0,
    }
    measured = pd.DataFrame(
        [row | {"compared": 2, "length": 1.5, "bent": 2, "curvature": math.inf, "cpu": 3.0}]
    )
    found = other.of_baseline_comparison("one", measured)
    assert [
        (each.cornered, each.curvature, each.length) for each in found["baseline_comparison"]
    ] == [(True, None, 1.5)]
    assert found["baseline_comparison_in_words"].startswith("1 method: feasible in 50 %")
    assert other.of_baseline_comparison("two", measured) == {}


def test_search_finds_every_published_number_and_every_run_shown_by_its_words():
    found = {entry.address: entry for entry in search.entries(page())}
    assert (
        found["one/table1/a/objective/mean"].text
        == "a: objective, mean: 10.51 → 10.71 inconclusive"
    )
    assert found["one/circles/p/a/0"].text.startswith("best feasible run of ")
    assert found["one/baseline_comparison/a"].more == "one baseline a"
    assert "one/table1/c/length/mean" not in found


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
    judged = pd.DataFrame(
        {"id": ["C1", "C2"], "primary": True, "verdict": ["supported", "contradicted"]}
    )
    assert [choice.claim for choice in gather._choices(tried, judged)] == ["C1"]


# --------------------------------------------------------------------------------------------------
# Runs


def stored(folder, lengths, feasible):
    """Files of runs of a method m on an empty room, whose paths are straight."""
    room = Problem(
        "room", from_lines(["....", "....", "...."], cell=1.0, unit="m"), (0.5, 0.5), (3.5, 0.5)
    )
    problem_files.write({"room": room}, {"room": "room"}, str(folder / "p.parquet"))
    parquet.write_table(problem_files.bounds_of({"room": room}), folder / "p.bounds.parquet")
    rows = [
        {
            "id": f"s/e/room/m/{n}",
            "problem": "room",
            "method": "m",
            "repeat": n,
            "feasible": ok,
            "length": length,
            "claimed_feasible": True,
        }
        | {
            "collision_at": math.nan if ok else 0.5,
            "collision_depth": 0.0,
            "clearance": 0.1,
            "evaluations": 5,
            "stop": "generations",
        }
        | {
            "history": [5.0, 5.0, 4.0, 4.0],
            "path_curve": "polyline",
            "path_points": [0.5, 0.5, 3.5, 0.5],
        }
        for n, (length, ok) in enumerate(zip(lengths, feasible, strict=True))
    ]
    parquet.write_table(pa.Table.from_pylist(rows), folder / "0.parquet")
    files = (str(folder / name) for name in ("p.parquet", "p.bounds.parquet"))
    return ExperimentShown(["m"], len(rows), [str(folder / "0.parquet")], *files, traces=[])


def test_best_median_worst_and_the_first_failed_runs_are_shown(tmp_path):
    lengths, feasible = (
        [5.0, 3.5, 4.0, 9.0, 8.0, 7.0, 6.0],
        [True, True, True, True, False, False, False],
    )
    found = runs.chosen("s", "e", stored(tmp_path, lengths, feasible))
    (shown,) = found.shown
    assert (shown.count, shown.feasible) == (7, 4)
    assert [shown.best, shown.median, shown.worst, *shown.failed] == [
        f"s/e/room/m/{n}" for n in (1, 2, 3, 4, 5)
    ]
    assert found.runs.keys() == {f"s/e/room/m/{n}" for n in (1, 2, 3, 4, 5)}
    assert found.runs["s/e/room/m/4"].collision == (2.0, 0.5)
    assert found.runs["s/e/room/m/1"].history == [(0, 5.0), (2, 4.0), (3, 4.0)]
    assert found.problems["s/e/room"].bound == 3.0


def test_repeats_that_a_chunk_has_beyond_those_wanted_are_not_shown(tmp_path):
    described = stored(tmp_path, [5.0, 4.0, 3.0], [True, True, True])._replace(repeats=2)
    assert runs.chosen("s", "e", described).shown[0].best == "s/e/room/m/1"


def test_method_without_a_feasible_run_has_failed_ones_only(tmp_path):
    (shown,) = runs.chosen("s", "e", stored(tmp_path, [5.0, 4.0], [False, False])).shown
    assert (shown.best, shown.median, shown.worst, len(shown.failed)) == (None, None, None, 2)


def test_place_of_a_drive_is_found_where_its_way_crosses_itself():
    # To the right, back through the same places, then up; the robot waits at the first place.
    path = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 0.0], [0.0, 1.5]])
    places = [(0, 0), (0, 0), (1, 0), (2, 0), (3, 0), (2, 0), (1, 0), (0, 0), (0, 1), (0, 1.5)]
    assert np.allclose(
        runs._driven(path, np.array(places, dtype=float), 1.0), [0, 0, 1, 2, 3, 4, 5, 6, 7, 7.5]
    )


def test_drive_is_shown_with_its_time_and_the_place_of_its_collision(tmp_path):
    described = stored(tmp_path, [3.0], [False])
    rows = [
        {**row, "collision_at": 1.5, "steps": 2.5}
        for row in parquet.read_table(described.runs[0]).to_pylist()
    ]
    parquet.write_table(pa.Table.from_pylist(rows), described.runs[0])
    empty = from_lines(["....", "....", "...."], cell=1.0, unit="m")
    later = from_lines(["#...", "....", "...#"], cell=1.0, unit="m")
    room = {"room": Problem("room", empty, (0.5, 0.5), (3.5, 0.5))}
    world_files.write(
        room,
        {"room": "room"},
        {"room": ChangingCells((empty, later), np.array([2.0]), 1.0, 9)},
        described.problems,
    )
    trace = [{"id": "s/e/room/m/0", "x": [0.5, 1.5, 2.5, 3.5], "y": [0.5] * 4}]
    parquet.write_table(pa.Table.from_pylist(trace), tmp_path / "0.traces.parquet")
    found = runs.chosen("s", "e", described._replace(traces=[str(tmp_path / "0.traces.parquet")]))
    (drive,) = found.runs.values()
    assert (drive.steps, drive.driven, drive.collision, drive.collision_step, drive.control) == (
        2.5,
        [0, 1, 2, 3],
        (2.0, 0.5),
        1.5,
        [],
    )
    assert found.problems["s/e/room"].world == content.World(moments=[2.0], changed=[[0, 11]])


def test_equal_workspaces_stand_once():
    problem = page().problems["one/first/p"]
    found = job._once(
        {"a": {"x": 1}, "b": {"x": 2}, "c": {"x": 1}},
        {n: problem.model_copy(update={"workspace": n}) for n in "abc"},
    )
    assert found["workspaces"] == {"a": {"x": 1}, "b": {"x": 2}}
    assert {name: each.workspace for name, each in found["problems"].items()} == {
        "a": "a",
        "b": "b",
        "c": "a",
    }


@given(
    # Thousandths, because shapely's simplification fails on numbers near the smallest.
    st.lists(st.tuples(st.integers(0, 10**5), st.integers(0, 10**5)), min_size=4, max_size=8),
    st.sampled_from(["bezier", "polyline", "piecewise_quadratic"]),
)
def test_drawn_path_stays_within_its_tolerance(points, kind):
    import shapely

    path = Curve(kind, np.array(points) / 1000)
    drawn = runs._simplified(paths.steps(path), 0.05)
    exact = curves.sample_matrix(kind, len(points), 301) @ path.points
    # The straight steps from which points are left out are themselves within 0.01 of the curve.
    assert shapely.distance(shapely.points(exact), shapely.LineString(drawn)).max() <= 0.05 + 0.01


def test_a_shortest_path_is_kept_with_as_few_points_as_show_it():
    workspace = from_lines(["..."] * 3, 1.0, "cell")
    arc = np.linspace(0, np.pi / 2, 1001)
    points = 0.2 + 2.6 * np.column_stack([np.sin(arc), 1 - np.cos(arc)])
    bound = pd.Series({"bound": 4.1, "bound_path": points.ravel()})
    start, target = tuple(points[0]), tuple(points[-1])
    kept = runs._problem("one", Problem("one", workspace, start, target), None, bound).bound_path
    assert 4 < len(kept) < 100
    assert kept[:2] == pytest.approx(start, abs=1e-4)
    assert kept[-2:] == pytest.approx(target, abs=1e-4)


def test_the_answer_counts_claims_that_would_show_again_and_keep_their_verdict():
    claims = [
        claim(f"C{n}", "supported", replication=share)
        for n, share in enumerate([0.9, 0.8, 0.79, 0.1, None])
    ]
    told = "".join(part.text for part in answer._replication(claims))
    assert told.startswith("2 of 4 supported claims that can be resampled would show again")
    one, other = (
        content.Interpretation(variant="a", verdict=verdict, holds="1 of 1")
        for verdict in ("supported", "contradicted")
    )
    read = [
        claim(f"C{n}", "supported", interpretations=interpretations)
        for n, interpretations in enumerate([[one], [one, other], [other], []])
    ]
    told = "".join(part.text for part in answer._interpretations(read))
    assert told.startswith(
        "1 of 3 claims that can be interpreted in more than one way keeps its verdict in every "
        "interpretation"
    )


def test_what_was_judged_again_stands_on_the_page():
    assert "were judged again" not in build.html(page(), Path())
    verified = content.Verified(
        files=2,
        runs=1234,
        paths=567,
        bounds=89,
        digest="0123abcd",
        versions={"numba": "1.2", "numpy": "3.4"},
    )
    told = " ".join(build.html(page().model_copy(update={"verified": verified}), Path()).split())
    assert "All 1,234 runs shown here, 567 different paths, were judged again" in told
    assert "and 89 bounds computed again, without a difference" in told
    assert "digest 0123abcd, with numba 1.2, numpy 3.4." in told


def test_a_number_whose_statistic_is_not_stated_has_the_name_of_the_column_beside_it():
    table = study("song2016").tables["table1"]
    headings = [
        gather._heading(metric, "unstated", table, {}) for metric in ("objective", "length")
    ]
    assert headings == ["objective value", "length: unstated"]


def test_the_script_of_the_charts_is_kept(tmp_path, monkeypatch):
    made = charts.script()
    monkeypatch.setattr(charts, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr("vl_convert.javascript_bundle", lambda vl_version: "a script")
    assert charts.script.__wrapped__() == "a script"
    (kept,) = (tmp_path / "charts").iterdir()
    kept.write_text(made, encoding="utf-8")
    assert charts.script.__wrapped__() == made
    monkeypatch.setattr(charts, "cache_folder", lambda: kept)  # a file, so no folder of it
    assert charts.script.__wrapped__() == "a script"
