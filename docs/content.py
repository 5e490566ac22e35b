"""The content of the site: tables and figures of a scale, which mirror the papers', and as evidence
the numbers, verdicts and reasons of many runs that docs/outcome keeps.
"""

from pathlib import Path
from types import SimpleNamespace

import outcome

from bezierplan.analysis import naming, study_code
from bezierplan.commands import read_studies
from bezierplan.figures.page import EVIDENCE, build, reader
from bezierplan.schema.checked import Fault
from bezierplan.study import page as page_jobs

ROOT = Path(__file__).parents[1]
CITATION = ROOT / "CITATION.cff"
SCALES = ("extended", "full", "smoke")
PICTURES = {
    "song2016": "figure3",
    "elhoseny2017": "figure10",
    "ma2020": "figure4",
    "tharwat2018": "figure15",
    "meledje": "figure4",
}
"""The figure of each paper that shows what it is about; of another study, its first."""


def find_results() -> Path:
    """Find the results of the scale with the most runs that there is. Raises Fault."""
    for scale in SCALES:
        folder = ROOT / "results" / scale
        if (folder / "index.html").is_file():
            return folder
    raise Fault("no results to show: `snakemake smoke` or `make reproduce` makes them")


def read_content() -> SimpleNamespace:
    """Read the content of the page of results.

    Each study also gets its name, as people search for it; definition; and picture, one of its
    figures. Raises Fault.
    """
    folder = find_results()
    studies = read_studies()
    whole = page_jobs.build_page(studies, folder.name, f"{folder.parent}/")
    study_code.load_functions(whole.code)  # what a study's metrics mean
    page = build.gather_content(
        whole.page._replace(outcome=[*studies]),
        folder,
        [str(folder / name) for name in outcome.TABLES],
        evidence=reader.Evidence(*map(reader.read, EVIDENCE)),
    )
    for key, study in page.studies.items():
        study.name, study.definition = naming.format_heading(key), studies[key]
        of_name = {figure["name"]: figure for figure in study.figures}
        study.picture = of_name.get(PICTURES.get(key), study.figures[0])
    return page


def read_prose(key: str) -> str:
    """Read the text on a paper or planner that is written by hand."""
    return (ROOT / "docs" / "prose" / f"{key}.md").read_text(encoding="utf-8")
