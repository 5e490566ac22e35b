"""One file that shows all results of a scale: its content (`content`, `gather`, `runs`, `answer`),
and its look (`build`).
"""

from pathlib import Path

HERE = Path(__file__).parent


def files() -> list[str]:
    """The templates, styles and scripts of the page, whose content decides how it looks."""
    return sorted(
        str(file) for folder in ("templates", "static") for file in (HERE / folder).iterdir()
    )
