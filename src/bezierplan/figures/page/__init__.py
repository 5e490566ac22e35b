"""One file that shows all results of a scale: what is read (`reader`, `runs`), what is said
(`answer`, `why`, `charts`), and templates that show it (`build`).
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
