"""One file that shows all results of a scale. `reader` and `runs` read them, `overview` and
`charts` prepare words and drawings, and `build` fills templates.
"""

import re
from collections.abc import Iterable
from pathlib import Path

from bezierplan.places import OUTCOME

HERE = Path(__file__).parent
EVIDENCE = [
    str(OUTCOME / f"{name}.csv") for name in ("numbers", "claims", "methods", "claim_checks")
]
"""What many runs say of all studies: tables of `reader.Evidence`."""
PICTURES = {name: str(OUTCOME / f"{name}.png") for name in ("numbers", "numbers_tall")}
"""All printed numbers beside our ranges, for wide and for narrow screens."""


def list_files() -> list[str]:
    """List the templates, styles and scripts of the page, whose content decides how it looks."""
    return sorted(
        str(file) for folder in ("templates", "static") for file in (HERE / folder).iterdir()
    )


def sort_as_printed(names: Iterable[str]) -> list[str]:
    """Return names of tables and figures with the numbered ones first, tables before figures.

    Numbered ones are sorted by number; the others keep their order.

    >>> sort_as_printed(["work", "figure11", "figure2", "table6", "table4"])
    ['table4', 'table6', 'figure2', 'figure11', 'work']
    """

    def find_place(name: str) -> tuple[int, ...]:
        found = re.fullmatch(r"(table|figure)(\d+)", name)
        return (0, found[1] != "table", int(found[2])) if found else (1,)

    return sorted(names, key=find_place)
