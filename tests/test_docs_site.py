"""The site: `make docs` builds it without a warning from the results that are there, every method
and every paper has its page, and a reader finds an answer within two clicks or one search.
"""

import copy
import re
import subprocess
import sys
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import unquote, urldefrag

import pandas as pd
import pytest
from bs4 import BeautifulSoup
from playwright.sync_api import expect
from test_page_browser import browser, complaints_of, needs_browser, violations  # noqa: F401

import bezierplan as bp
from bezierplan.analysis.legend import WORDS
from bezierplan.places import OUTCOME, STUDIES
from bezierplan.planners import list_planners
from bezierplan.study import loading

ROOT = Path(__file__).parents[1]
WIDTHS = [1400, 390]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The built site."""
    folder = tmp_path_factory.mktemp("site")
    options = ["--quiet", "--fail-on-warning", "--builder", "html"]
    options += ["--doctree-dir", str(folder / "trees")]
    built = subprocess.run(
        [sys.executable, "-m", "sphinx", *options, "docs", str(folder / "html")],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stderr
    return folder / "html"


@pytest.fixture(scope="module")
def pages(site):
    """The pages of the site as trees, by file."""
    found = (file for file in site.rglob("*.html") if "/_" not in str(file))
    return {file: BeautifulSoup(file.read_text(encoding="utf-8"), "html.parser") for file in found}


@pytest.fixture(scope="module")
def papers(site, pages):
    """By study, its page."""
    keys = (file.parent.name for file in STUDIES.glob("*/experiments.yaml"))
    return {key: pages[site / "papers" / f"{key}.html"] for key in keys}


def test_every_method_has_a_page_with_equations_settings_and_a_run(site, pages):
    for name in list_planners():
        page = pages[site / "methods" / f"{name}.html"]
        assert page.select("math")
        assert page.find(id=f"bezierplan.planners.{name}.plan")
    page = pages[site / "methods" / "modified_genetic.html"]
    assert page.title.text.startswith("MGA (Elhoseny 2017)")
    assert page.find(id="a-run")
    assert page.find(id="the-algorithm-on-one-page")
    for part in ("settings", "what-the-paper-leaves-open", "what-it-achieves"):
        assert "{'" not in page.find(id=part).text


def test_the_run_of_each_method_page_is_made_again_by_its_example(site):
    sources = [page.read_text(encoding="utf-8") for page in site.glob("_sources/methods/*")]
    names = [name for text in sources for name in re.findall(r"replay (\S+/\d+)$", text, re.M)]
    assert len(names) >= 10
    assert all(bp.replay(name).length > 0 for name in names[:3])


def test_the_page_of_a_paper_is_the_one_of_docs_outcome_with_its_figures(papers):
    texts = pd.read_csv(OUTCOME / "texts.csv").set_index("study")
    for key, page in papers.items():
        said = " ".join(page.text.split()).replace("’", "'")
        assert f"{texts['title'][key]}. {texts['text'][key]}" in said
        assert page.select(f"[id='{key}/figure1']")
        assert page.select(f"a[href='../results/index.html#{key}']")


def test_verdicts_come_with_examples_on_real_numbers(site):
    page = (site / "verdicts.html").read_text(encoding="utf-8")
    numbers = pd.read_csv(OUTCOME / "numbers.csv")
    interval = numbers[["low95_predicted", "high95_predicted"]].notna().all(axis=1)
    shown = numbers[numbers["counted"] & interval & ~numbers["wide"].astype(bool)]
    assert page.count("The paper prints") == shown["position"].nunique() >= 2


def test_claims_and_captions_have_the_verdicts_of_the_outcome(papers):
    claims = pd.read_csv(OUTCOME / "claims.csv")
    for key, page in papers.items():
        own = claims[claims["primary"] & (claims["study"] == key)]
        kept = own.set_index("id")["verdict"].to_dict()
        rows = [[cell.text for cell in row.select("td")] for row in page.select("tr")]
        shown = {row[0]: row[2] for row in rows if row and row[0] in kept}
        assert shown
        assert shown == {name: kept[name] for name in own.loc[own["main"].astype(bool), "id"]}
        known = dict(zip(own["id"], own["statement"].str.removesuffix("."), strict=True))
        for name, text in known.items():
            for link in page.select(f'a[href$="/{name}"]'):
                if link.text == text:
                    said = WORDS[kept[name]].caption.partition("{}")[0]
                    assert said in link.next_sibling.partition(". ")[0]


def test_pages_have_words_and_no_more_digits_than_are_read(site, pages):
    studies = loading.load([*STUDIES.iterdir()]).values()
    keys = {name for study in studies for name in study.methods if "_" in name} | {"None"}
    faults = {}
    for file in [*site.glob("*.html"), *site.glob("papers/*"), *site.glob("methods/*")]:
        page = copy.copy(pages[file].select_one("article"))
        if page is None or file.stem in ("api", "names", "changelog", "genindex"):
            continue
        # What a program reads.
        for part in page.select("pre, code, script, math, dl.py, #settings"):
            part.decompose()
        found = keys & set(re.findall(r"\w+", page.get_text(" ")))
        # What papers print, and what their maps are recognised by.
        printed = "table" if file.parent.name == "papers" else ".printed"
        for part in page.select(f"{printed}, #maps"):
            part.decompose()
        for part in page.select(".claims, .headline, table"):
            numbers = re.findall(r"\d+\.\d+", part.get_text(" "))
            found |= {each for each in numbers if len(each.replace(".", "").lstrip("0")) > 5}
        if found:
            faults[file.name] = sorted(found)
    assert faults == {}


def values_of(page, *attributes):
    """The values that elements of a page have of some attributes."""
    return {each[name] for name in attributes for each in page.find_all(attrs={name: True})}


def test_every_link_leads_somewhere(site, pages):
    anchors = {file: values_of(page, "id", "name") for file, page in pages.items()}
    broken = []
    for page, tree in pages.items():
        for target in values_of(tree, "href", "src"):
            path, anchor = urldefrag(target)
            if target.startswith(("http", "data:", "mailto:", "blob:")) or "${" in target:
                continue
            file = (page.parent / unquote(path.partition("?")[0])).resolve() if path else page
            known = anchors.get(file, {unquote(anchor)}) | {""}
            if not file.is_file() or unquote(anchor) not in known:
                broken.append(f"{page.relative_to(site)}: {target}")
    assert broken == []


# --------------------------------------------------------------------------------------------------
# In a browser


@pytest.fixture(scope="module")
def address(site):
    """Where the site is served; its search needs that."""

    class Silent(SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Silent, directory=site)) as server:
        # A window that closes breaks off what it was loading.
        server.handle_error = lambda *_: None
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@pytest.fixture(params=WIDTHS)
def tab(request, browser, address):  # noqa: F811
    """The site's home in a window of each width; at the end no complaint."""
    context = browser.new_context(
        base_url=address, viewport={"width": request.param, "height": 900}
    )
    context.set_default_timeout(60_000)
    tab = context.new_page()
    complaints = complaints_of(tab, lambda url: url.startswith(address))
    tab.goto("/index.html")
    yield tab
    context.close()
    assert complaints == []


# A question, what a reader clicks on from the site's home, and what is then in sight.
CLICKS = [
    ("overall answer", [], "lie inside our range"),
    ("is a paper right", [], "seldom the shortest"),
    ("how long does it take", ["Which method should I use?"], "takes some milliseconds"),
    ("two methods on one map", ["Which method should I use?"], "A method plans on any map that"),
    ("MGA's mutation", ["Which method should I use?", "MGA (Elhoseny 2017)"], "Mutation."),
    ("a map of Ma", ["Ma 2020"], "environment2.txt"),
    ("what did you find about Tharwat 2018", ["Tharwat 2018"], "Chaos seldom helps"),
    ("may I cite it and how", ["May I cite it, and how?"], "@misc{bezierplan"),
    ("Table 2 of Elhoseny beside yours", ["Elhoseny 2017"], "Proposed Method"),
    ("which planner for a maze", ["Which method should I use?"], "A maze"),
    ("what for a map of my own", ["Which method should I use?"], "On a map of your own begin with"),
    ("CPSO-I in Table 3", ["Tharwat 2018"], "Singer"),
    ("what too wide means", ["What do the verdicts mean?"], "too wide to tell"),
]
# A question, the first page that the search finds.
SEARCHES = {
    "MGA": "methods/modified_genetic.html",
    "BCA": "methods/bca.html",
    "which method should I use": "use.html",
    "how long does it take": "use.html",
    "compare two methods": "use.html",
    "Tharwat 2018": "papers/tharwat2018.html",
    "how to cite": "cite.html",
}


@needs_browser
def test_answers_are_two_clicks_or_one_search_from_home(tab, subtests):
    for question, clicks, answer in CLICKS:
        with subtests.test(question=question):
            tab.goto("/index.html")
            for words in clicks:
                tab.locator("main").get_by_role("link", name=words, exact=True).first.click()
            expect(
                tab.locator("main").get_by_text(answer).filter(visible=True).first
            ).to_be_visible()
    # A search does not ask how wide the window is.
    for question, page in SEARCHES.items() if tab.viewport_size["width"] == WIDTHS[0] else ():
        with subtests.test(question=question):
            tab.goto(f"/search.html?q={question}")
            first = tab.locator("#search-results li a").first
            expect(first).to_have_attribute("href", re.compile(f"^{page}(#.*)?$"))


# Of each template one.
PAGES = ["index", "use", "gallery", "papers/song2016", "methods/ant_colony"]


@needs_browser
def test_pages_fit_their_width_and_pass_axe(tab, subtests):
    for page in PAGES:
        with subtests.test(page=page):
            tab.goto(f"/{page}.html")
            width = tab.viewport_size["width"]
            assert tab.evaluate("document.documentElement.scrollWidth") <= width
            if width < WIDTHS[0] and page != "index":
                continue  # what a narrow window has of its own is on every page
            assert violations(tab, preload=False) == []


def test_a_method_has_one_value_on_each_family_wherever_it_stands(pages, papers):
    shown: dict[tuple[str, ...], set[tuple[str, ...]]] = {}
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    lines = [line.strip("|\n ").split(" | ") for line in readme.splitlines() if line[:1] == "|"]
    start = next(i for i, cells in enumerate(lines) if "free paths" in cells)
    tables = [("", lines[start], lines[start + 2 :])]
    results = (ROOT / "results/smoke/index.html").read_text(encoding="utf-8")
    for place in (BeautifulSoup(results, "html.parser"), *pages.values()):
        for table in place.find_all("table"):
            head, *rows = ([cell.text.strip() for cell in row(("th", "td"))] for row in table("tr"))
            if "free paths" in head:
                section = table.find_parent("section", class_="paper")
                tables.append((section["id"] if section else "", head, rows))
    for study, head, rows in tables:
        for cells in rows:
            of = dict(zip(head, cells, strict=False))
            if "scenarios" not in of:
                continue
            paper, _, method = f"{of.pop('paper', study)}, {of.pop('method')}".rpartition(", ")
            key = (paper.strip(", ").replace(" ", "").lower(), method, of.pop("scenarios"))
            shown.setdefault(key, set()).add(tuple(of.values()))
    assert len(tables) > len(papers)
    assert {key: values for key, values in shown.items() if len(values) > 1} == {}
