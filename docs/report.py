"""Print the report on the papers as a PDF: `snakemake report_pdf`."""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

import content

from bezierplan.analysis.outcome import outcome
from bezierplan.figures.page import build, reader

# The first is Chromium without windows, which needs half the CPU time of the others.
BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
CHROMIUM = next(filter(None, map(shutil.which, BROWSERS)), None)

# What follows for each paper, at a glance.
FIGURES = {
    "song2016": "figure3",
    "elhoseny2017": "figure12",
    "ma2020": "lengths",
    "tharwat2018": "figure9",
    "meledje": "work",
}


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
        first_sentence=outcome.first_sentence,
        chosen_figure=chosen_figure,
    )


def chosen_figure(study: SimpleNamespace) -> reader.Row:
    """The figure that shows what follows for a paper, if there is it, else the first."""
    there = {figure["name"]: figure for figure in study.figures}
    return there.get(FIGURES[study.key], study.figures[0])


if __name__ == "__main__":
    main(sys.argv[1])
