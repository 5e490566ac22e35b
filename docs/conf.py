"""Sphinx: the documentation as a site, made by `make docs`."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent / "src"), str(HERE)]

import content  # noqa: E402

import bezierplan  # noqa: E402
from bezierplan.figures.page import build  # noqa: E402
from bezierplan.schema import checked  # noqa: E402

project = "bezierplan"
version = release = bezierplan.__version__

extensions = [
    "generate",
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",
]
exclude_patterns = ["outcome/*.md", "prose", "python.md", "verdict-changes.md", "*.in.md"]
suppress_warnings = ["myst.header"]
myst_enable_extensions = ["dollarmath", "deflist", "colon_fence", "attrs_inline"]
myst_heading_anchors = 3

numpydoc_show_class_members = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"

html_theme = "pydata_sphinx_theme"
html_title = "bezierplan"
html_theme_options = {
    "show_prev_next": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["made"],
    "footer_end": [],
}
html_context = {
    "default_mode": "auto",
    "made_by": build.describe_version(),
    "licence": checked.read(content.CITATION)["license"],
}
templates_path = ["templates"]
# Pages without pages below them.
html_sidebars = {
    name: []
    for name in (
        "index",
        "use",
        "gallery",
        "start",
        "verdicts",
        "glossary",
        "faq",
        "cite",
        "changelog",
    )
}
html_static_path = ["static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_show_sourcelink = False
