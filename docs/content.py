"""The content of the site: tables and figures of a scale, which mirror the papers', and as evidence
the numbers, verdicts and reasons of many runs that docs/outcome keeps.
"""

import contextlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import outcome
import yaml

from bezierplan.analysis import study_code
from bezierplan.commands import read_studies
from bezierplan.figures.page import EVIDENCE, build, reader
from bezierplan.schema.checked import Fault
from bezierplan.study import page as page_jobs

ROOT = Path(__file__).parents[1]
SCALES = ("extended", "full", "smoke")
PICTURES = {
    "song2016": "figure3",
    "elhoseny2017": "figure10",
    "ma2020": "figure4",
    "tharwat2018": "figure15",
    "meledje": "figure4",
}
"""The figure of each paper that shows what it is about; of another study, its first."""


def find_results() -> tuple[str, Path]:
    """Find the scale with the most runs that there is, and its folder of results. Raises Fault."""
    for scale in SCALES:
        if (ROOT / "results" / scale / "index.html").is_file():
            return scale, ROOT / "results" / scale
    raise Fault("no results to show: `snakemake smoke` or `make reproduce` makes them")


def read_content() -> tuple[SimpleNamespace, Path]:
    """Read the content of the page of results, and return it with the folder of its results.

    Each study also gets its name, as people search for it; definition; and picture, one of its
    figures. Raises Fault.
    """
    scale, folder = find_results()
    with contextlib.chdir(ROOT):
        studies = read_studies()
        whole = page_jobs.build_page(studies, scale)
        study_code.load_functions(whole.code)  # what a study's metrics mean
        page = build.gather_content(
            whole.page._replace(outcome=[*studies]),
            folder,
            [str(folder / name) for name in outcome.TABLES],
            evidence=reader.Evidence(*map(reader.read, EVIDENCE)),
        )
    for key, study in page.studies.items():
        study.name, study.definition = outcome.format_name(key), studies[key]
        of_name = {figure["name"]: figure for figure in study.figures}
        study.picture = of_name.get(PICTURES.get(key), study.figures[0])
    return page, folder


def read_prose(key: str) -> str:
    """Read the text on a paper or planner that is written by hand."""
    return (ROOT / "docs" / "prose" / f"{key}.md").read_text(encoding="utf-8")


# --------------------------------------------------------------------------------------------------
# Citations


def list_citations() -> list[dict[str, Any]]:
    """List this software, then the papers, as CITATION.cff has them.

    Added keys: key; names, of the authors; where, journal, version and year; doi, maybe none;
    bibtex.
    """
    content = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    year = content["date-released"].year
    first = content | {"notes": "bezierplan", "year": year, "type": "software"}
    return [
        {"doi": None}
        | entry
        | {
            "key": entry["notes"],
            "names": format_authors(entry, ", "),
            "where": "".join(
                f", {entry[name]}" for name in ("journal", "version", "year") if name in entry
            ),
            "bibtex": format_bibtex(entry),
        }
        for entry in (first, *content["references"])
    ]


def format_authors(entry: dict[str, Any], between: str) -> str:
    """Return the names of the authors of an entry of CITATION.cff, with a text between them."""
    return between.join(
        each.get("name") or f"{each['given-names']} {each['family-names']}"
        for each in entry["authors"]
    )


def format_bibtex(entry: dict[str, Any]) -> str:
    """Return an entry of CITATION.cff for BibTeX."""
    kind = {"article": "article" if "journal" in entry else "unpublished"}
    authors = format_authors(entry, " and ")
    fields = {"author": f"{{{authors}}}" if entry["type"] == "software" else authors}
    fields |= {name: entry.get(name) for name in ("title", "journal", "year", "version", "doi")}
    fields["url"] = entry.get("repository-code")
    lines = [f"  {name} = {{{value}}}," for name, value in fields.items() if value]
    return "\n".join([f"@{kind.get(entry['type'], 'misc')}{{{entry['notes']},", *lines, "}"])
