"""One file that shows all results of a scale: what is read (`reader`, `runs`), what is said
(`answer`, `why`, `charts`), and templates that show it (`build`).
"""

import csv
import re
from collections.abc import Iterable
from pathlib import Path

from bezierplan.places import TREE

HERE = Path(__file__).parent
OUTCOME = [
    TREE / "docs" / "outcome" / name
    for name in ("numbers.csv", "claims.csv", "baseline_comparison.csv")
]
"""The README's outcome, in a clone: tables of all studies."""
SETTINGS = TREE / "docs" / "outcome" / "settings.csv"
"""The settings of all studies behind it."""


def files() -> list[str]:
    """The templates, styles and scripts of the page, whose content decides how it looks."""
    return sorted(
        str(file) for folder in ("templates", "static") for file in (HERE / folder).iterdir()
    )


def changes(study: str, settings: Iterable[tuple[str, str, str]]) -> list[str]:
    """Which settings of a study, by method and setting, are not those of the README's outcome."""
    if not SETTINGS.is_file():
        return []
    with SETTINGS.open(encoding="utf-8", newline="") as rows:
        before = {(m, s): value for key, m, s, value in csv.reader(rows) if key == study}
    return [
        f"{setting} of {method} is {value}, in the README's outcome {before.get(place, 'absent')}"
        for method, setting, value in settings
        if before.get(place := (method, setting)) != value
    ]


def in_printed_order(names: Iterable[str]) -> list[str]:
    """Names of tables and figures with the numbered ones first, tables before figures, each by its
    number; the others as they were.

    >>> in_printed_order(["work", "figure11", "figure2", "table6", "table4"])
    ['table4', 'table6', 'figure2', 'figure11', 'work']
    """
    numbered = {
        name: found for name in names if (found := re.fullmatch(r"(table|figure)(\d+)", name))
    }
    first = sorted(
        numbered, key=lambda name: (numbered[name][1] != "table", int(numbered[name][2]))
    )
    return [*first, *(name for name in names if name not in numbered)]
