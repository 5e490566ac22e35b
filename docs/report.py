"""Print the report on the papers as a PDF: `snakemake report_pdf`."""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import content
import outcome

from bezierplan.figures.page import build

# The first is Chromium without windows, which needs half the CPU time of the others.
BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
CHROMIUM = next(filter(None, map(shutil.which, BROWSERS)), None)


def main(file: str) -> None:
    """Write the report to a file."""
    if CHROMIUM is None:
        sys.exit("report_pdf: needs Chromium; Debian: apt install chromium-headless-shell")
    options = ["--headless", "--no-pdf-header-footer", "--virtual-time-budget=10000"]
    # The sandbox of the browser does not start for root, as in a container.
    options += ["--no-sandbox"] if os.geteuid() == 0 else []
    with tempfile.TemporaryDirectory() as place:
        source = Path(place) / "report.html"
        source.write_text(html(), encoding="utf-8")
        printed = f"--print-to-pdf={Path(file).resolve()}"
        subprocess.run(
            [CHROMIUM, *options, printed, source.as_uri()], check=True, capture_output=True
        )


def html() -> str:
    """The report."""
    page, folder = content.content()
    environment = build.environment(page, folder, Path(__file__).parent / "templates")
    software, *references = content.citations()
    return environment.get_template("report.html.jinja").render(
        page=page,
        folder=folder.as_uri(),
        software=software,
        references=references,
        about=content.about,
        sentences=outcome.sentences,
    )


if __name__ == "__main__":
    main(sys.argv[1])
