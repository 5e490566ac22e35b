"""One file that shows all results of a scale: what is read (`reader`, `runs`), what is said
(`answer`, `why`, `charts`), and templates that show it (`build`).
"""

import csv
import re
from collections.abc import Iterable
from pathlib import Path

from bezierplan.places import TREE

HERE = Path(__file__).parent
SETTINGS = TREE / "docs" / "outcome" / "settings.csv"
"""The settings of all studies behind it."""
TEXTS = SETTINGS.with_name("texts.csv")
"""The answer to each paper: study, title, text."""
EVIDENCE = [
    str(SETTINGS.with_name(f"{name}.csv"))
    for name in ("numbers", "claims", "methods", "claim_checks", "wholes")
]
"""What many runs say of all studies: tables of `reader.Evidence`."""


def files() -> list[str]:
    """The templates, styles and scripts of the page, whose content decides how it looks."""
    return sorted(
        str(file) for folder in ("templates", "static") for file in (HERE / folder).iterdir()
    )


def changes(study: str, settings: Iterable[tuple[str, str, str]]) -> list[str]:
    """Which settings of a study, by what has them and setting, are not those of the README's
    outcome.
    """
    if not SETTINGS.is_file():
        return []
    with SETTINGS.open(encoding="utf-8", newline="") as rows:
        before = {(of, name): value for key, of, name, value in csv.reader(rows) if key == study}
    now = {(of, name): value for of, name, value in settings}
    return [
        f"{name} of {of} is {now.get((of, name), 'absent')}, in the README's outcome "
        f"{before.get((of, name), 'absent')}"
        for of, name in now | before
        if now.get((of, name)) != before.get((of, name))
    ]


def read_answers() -> dict[str, tuple[str, str]]:
    """Read title and text of the README's outcome, by study."""
    if not TEXTS.is_file():
        return {}
    with TEXTS.open(encoding="utf-8", newline="") as rows:
        return {row["study"]: (row["title"], row["text"]) for row in csv.DictReader(rows)}


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
