"""One file that shows all results of a scale: its content (`content`, `gather`, `runs`, `answer`),
and its look (`build`).
"""

from pathlib import Path

from bezierplan.places import TREE

HERE = Path(__file__).parent
OUTCOME = [
    TREE / "docs" / "outcome" / name
    for name in ("numbers.csv", "claims.csv", "baseline_comparison.csv")
]
"""The README's outcome, in a clone: tables of all studies."""


def files() -> list[str]:
    """The templates, styles and scripts of the page, whose content decides how it looks."""
    return sorted(
        str(file) for folder in ("templates", "static") for file in (HERE / folder).iterdir()
    )
