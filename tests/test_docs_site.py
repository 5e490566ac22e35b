"""The documentation as a site: `make docs` builds it without a warning, and every method and every
paper has its page.
"""

import subprocess
import sys
from pathlib import Path

import pytest

from bezierplan.places import STUDIES
from bezierplan.planners import known_planners

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The built site."""
    folder = tmp_path_factory.mktemp("site")
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "--quiet",
        "--fail-on-warning",
        "--builder",
        "html",
        "--doctree-dir",
        str(folder / "trees"),
    ]
    built = subprocess.run(
        [*command, "docs", str(folder / "html")],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stderr
    return folder / "html"


def test_every_method_and_every_paper_has_its_page(site):
    for name in known_planners():
        page = (site / "methods" / f"{name}.html").read_text(encoding="utf-8")
        assert "Settings" in page
        assert f"bezierplan.planners.{name}.plan" in page
    for study in STUDIES.glob("*/experiments.yaml"):
        page = (site / "papers" / f"{study.parent.name}.html").read_text(encoding="utf-8")
        assert "Published numbers" in page
        assert "What the paper leaves open" in page


def test_search_finds_a_method_by_its_name(site):
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    assert '"methods/binary_genetic"' in index
    assert "binary_genetic" in index


def test_verdicts_come_with_examples_on_real_numbers(site):
    page = (site / "verdicts.html").read_text(encoding="utf-8")
    assert page.count("The paper prints") >= 3
    assert "{number:" not in page
    assert "{claim:" not in page


def test_links_between_pages_lead_somewhere(site):
    import re

    for page in site.rglob("*.html"):
        for target in re.findall(
            r'href="([^"#:?]+\.html)(?:#[^"]*)?"', page.read_text(encoding="utf-8")
        ):
            assert (page.parent / target).is_file(), f"{page.name}: {target}"
