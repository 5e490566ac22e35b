"""The page in a real browser, opened from disk: a small page with every kind of content, and that
of scale smoke.
"""

import itertools
import os
import re
import shutil
import sys
from pathlib import Path

import pytest
from playwright.sync_api import expect, sync_playwright

sys.path.insert(0, str(Path(__file__).parent))
from page_content import page as small_page

from bezierplan.figures.page import build

# The first is Chromium without windows, which needs half the CPU time of the others.
BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
CHROMIUM = next(filter(None, map(shutil.which, BROWSERS)), None)
SMOKE = Path(__file__).parents[1] / "results" / "smoke" / "index.html"

# The environment comes from PyPI, which has no browser: that belongs to the machine, and not every
# reader can install one. Continuous integration installs it (`.ci/run`).
needs_browser = pytest.mark.skipif(
    CHROMIUM is None,
    reason="no browser here, and PyPI has none; Debian: apt install chromium-headless-shell",
)
pytestmark = needs_browser


@pytest.fixture(scope="module")
def browser():
    # The sandbox of the browser does not start for root, as in a container.
    arguments = ["--no-sandbox"] if os.geteuid() == 0 else []
    with sync_playwright() as playwright:
        # The page answers a click a moment later, on a busy machine much later: what is expected is
        # waited for.
        expect.set_options(timeout=60_000)
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    file = folder / "index.html"
    file.write_text(build.render_page(small_page(folder), folder), encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def smoke():
    """`make test` makes it before the tests."""
    assert SMOKE.is_file(), f"no {SMOKE.relative_to(SMOKE.parents[2])}: run snakemake smoke first"
    return SMOKE


def complaints_of(tab, is_own):
    """What a browser complains of from now on, and what it asks for that is not of the page."""
    found = []
    tab.on(
        "console",
        lambda message: (
            found.append(message.text) if message.type in ("error", "warning") else None
        ),
    )
    tab.on("pageerror", lambda error: found.append(str(error)))
    tab.on("request", lambda asked: None if is_own(asked.url) else found.append(asked.url))
    return found


def violations(tab, **options):
    """The rules for access that a page breaks, with the first places."""
    from axe_playwright_python.sync_playwright import Axe

    # Of what passes, axe would look for selectors as well: a third of its time.
    chosen = {
        "runOnly": ["wcag2a", "wcag2aa", "wcag21aa", "best-practice"],
        "resultTypes": ["violations"],
    }
    found = Axe().run(tab, options=chosen | options).response["violations"]
    return [(each["id"], [node["html"][:200] for node in each["nodes"][:3]]) for each in found]


@pytest.fixture
def visit(browser):
    """Open a file at an address, and fail at the end on any complaint of the browser and any
    request for another file.
    """
    complaints, contexts = [], []

    def visit(file, address="", **options):
        context = browser.new_context(**{"viewport": {"width": 1280, "height": 900}} | options)
        context.set_default_timeout(60_000)
        contexts.append(context)
        tab = context.new_page()
        own = file.as_uri()
        # Without scripts, figures are files of their own.
        asked = ("file:",) if "java_script_enabled" in options else (own, "data:", "blob:")
        complaints.append(complaints_of(tab, lambda url: url.startswith(asked)))
        tab.goto(own + (f"#{address}" if address else ""))
        return tab

    yield visit
    for context in contexts:
        context.close()
    assert [*itertools.chain(*complaints)] == []


WIDTHS = [1280, *([400] if os.environ.get("ALL") else [])]
"""The second width of a window is tried with `make test ALL=1`."""


@pytest.mark.parametrize(
    ("name", "scheme"), [("small", "light"), ("small", "dark"), ("smoke", "light")]
)
@pytest.mark.parametrize("width", WIDTHS)
def test_page_opens_without_complaint_fits_its_width_and_passes_axe(
    visit, request, name, scheme, width
):
    """The small page has every kind of content, so its dark colours are those of any page."""
    file = request.getfixturevalue(name)
    tab = visit(file, viewport={"width": width, "height": 800}, color_scheme=scheme)
    opened = "document.querySelectorAll('details').forEach((part, n) => { part.open = n < %d; })"
    tab.evaluate(opened % 4)
    tab.wait_for_timeout(200)
    assert violations(tab) == []
    tab.evaluate(opened % 10_000)
    assert tab.evaluate("document.documentElement.scrollWidth") <= width


KINDS = {
    "claim": ".claim",
    "table": "details.table[data-finds]",
    "number": "td[id]",
    "figure": ".figures figure",
    "method": "[id*='/method/']",
    "detail": "[data-finds^=assumption]",
    "comparison": "tr[id]",
    "heading": "h3[id]",
    "word": "dt[id]",
    "section": "section[id]",
}
"""Kind of address -> the elements that have one."""


@pytest.mark.parametrize("width", WIDTHS)
def test_each_kind_of_address_opens_there_in_a_new_tab(visit, smoke, width):
    """The last of each kind, above which the most can move. A page can be sent: at most 8 MB."""
    window = {"viewport": {"width": width, "height": 800}}
    tab = visit(smoke, **window)
    last = "(kind) => [...document.querySelectorAll(kind)].at(-1).id"
    assert smoke.stat().st_size < 8e6
    places = [tab.evaluate(last, kind) for kind in KINDS.values()]
    for kind, place in zip(KINDS, places, strict=True):
        tab = visit(smoke, place, **window)
        tab.wait_for_function("!document.querySelector('[data-packed]')")
        box = tab.locator(f"[id='{place}']").bounding_box()
        top, bottom = box["y"], box["y"] + box["height"]
        end = tab.evaluate("scrollY + innerHeight >= document.documentElement.scrollHeight - 2")
        assert 0 <= top < 600 or (end and bottom <= 800), (kind, place, top)


def test_without_scripts_tables_verdicts_charts_and_figures_are_there(visit, small):
    tab = visit(small, java_script_enabled=False)
    expect(tab.locator("h1")).to_be_visible()
    tab.locator("[id='one/table1'] > summary").click()
    expect(tab.locator("[id='one/table1'] table.sortable")).to_be_visible()
    expect(tab.locator("figure noscript img")).to_have_attribute("src", "one/paper/figure1.svg")
    expect(tab.locator("[id='page-chart/verdicts'] .scroll > *")).to_be_visible()
    expect(tab.locator(".search")).to_be_hidden()


def test_figures_are_unpacked_and_enlarge(visit, small):
    tab = visit(small, "one/figure1")
    tab.locator(".sheet img[src^=blob]").click()
    expect(tab.locator("#page-enlarged img[src^=blob]")).to_be_visible()


def test_hostile_words_do_not_run(visit, small):
    tab = visit(small)
    tab.locator("#page-query").fill("script")
    assert tab.evaluate("window.broken") is None
    expect(tab.locator("[id='one'] h2")).to_contain_text("</script>")


def test_table_sorts(visit, small):
    tab = visit(small, "one/listed")
    rows = tab.locator("[id='one/listed'] tbody tr")
    heading = tab.locator("[id='one/listed'] th").first
    for order, first in (("ascending", "0"), ("descending", "11")):
        heading.locator("button").click()
        expect(heading).to_have_attribute("aria-sort", order)
        expect(rows.first.locator("td").first).to_have_text(first)


def test_address_of_a_number_shows_its_interval(visit, small):
    tab = visit(small, "one/table1/b/length/mean")
    bar = tab.locator("[id='one/table1/b/length/mean'] svg")
    expect(bar).to_have_attribute(
        "aria-label", re.compile(r"printed [0-9.]+, our range .* to .*: ")
    )


def test_filter_shows_claims_of_one_verdict_and_an_address_opens_any(visit, small):
    tab = visit(small)
    shown = tab.locator(".claims").first.locator(".claim:visible")
    tab.locator("button[data-verdict=supported]").click()
    expect(shown).to_have_count(1)
    tab.evaluate("location.hash = 'one/C2'")
    tab.locator("[id='one/C2'] .forest").first.wait_for()
    expect(shown).to_have_count(2)


def test_search_works_by_keyboard(visit, small):
    tab = visit(small)
    tab.keyboard.press("/")
    tab.keyboard.type("C2 best")
    expect(tab.locator("#page-hits a")).to_have_count(1)
    tab.keyboard.press("ArrowDown")
    tab.keyboard.press("Enter")
    tab.locator("[id='one/C2'] .facts").wait_for()
    expect(tab.locator("#page-hits")).to_be_hidden()
    assert tab.url.endswith("#one/C2")


# A question, the addresses of its first answers, and words of the first.
QUESTIONS = [
    ("overall answer", ["page-answer"], "What reproduces, and what does not"),
    ("What should I use instead?", ["page-use"], "What should I use?"),
    ("What is the mean objective of a?", ["one/table1/a/objective/mean"], "published 10.51"),
    ("Which claims of one fail?", ["one/C2"], "C2 Method a is the best"),
    ("Why do claims fail", ["page-failures"], "The claim that fails"),
    ("What does above mean?", ["page-word/above"], "lies above our range"),
    ("How do I repeat a run?", ["page-paths"], "Repeat a single run"),
]


def test_questions_in_plain_words_find_their_answers_in_one_step(visit, small, subtests):
    """One after the other, as a reader asks them: to open the page for each takes most of the
    time.
    """
    tab = visit(small)
    hits = tab.locator("#page-hits a")
    for question, addresses, answer in QUESTIONS:
        with subtests.test(question=question):
            tab.locator("#page-query").fill(question)
            for hit, address in enumerate(addresses):
                expect(hits.nth(hit)).to_have_attribute("href", f"#{address}", timeout=5000)
            expect(hits.first).to_contain_text(answer, timeout=5000)


def test_claims_that_fail_are_listed_with_the_reason(visit, small):
    tab = visit(small, "page-failures")
    expect(tab.locator(".failing li")).to_have_count(1)
    expect(tab.locator(".failing")).to_contain_text(
        "Length, b lower than c, the room: relative effect -1"
    )
