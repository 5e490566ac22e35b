"""The page of a scale as one file: templates are filled with the content of tables and carry styles
and scripts.
"""

import base64
import hashlib
import json
import re
import zlib
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd

from bezierplan.analysis import legend, naming
from bezierplan.analysis.claims.sentences import describe_metric
from bezierplan.analysis.naming import Labels
from bezierplan.analysis.numbers import comparison, methods
from bezierplan.analysis.outcome import headline
from bezierplan.analysis.outcome.verification import describe_version
from bezierplan.figures.page import HERE, PICTURES, addresses, charts, overview, reader
from bezierplan.figures.page.page_job import PageJob
from bezierplan.running.columns import Row

# Mark of a comparison -> the class that colours it, and what it says.
MARKS = {
    "+": ("good", "holds"),
    "-": ("bad", "the opposite holds"),
    "0": ("part", "neither holds"),
    "?": ("open", "not known"),
}


def gather_content(
    job: PageJob,
    folder: Path,
    summary: list[str],
    proof: str | None = None,
    evidence: reader.Evidence | None = None,
) -> SimpleNamespace:
    """Return the content of the templates.

    folder: the scale's results. summary: the files numbers.csv, claims.csv and methods.csv of all
    studies, none if the scale has none. proof: the file of the check of the runs shown
    (`running.recheck`), if there is one; it lists all other files behind the page. evidence: see
    `reader.read_study_results`.
    """
    tables = [reader.read(file) for file in summary]
    studies = reader.read_study_results(job, folder, tables, evidence)
    repeats = [own.repeats for own in job.studies.values()]
    verified = None
    if proof:
        content = Path(proof).read_bytes()
        verified = json.loads(content) | {"listed": hashlib.sha256(content).hexdigest()}
    return SimpleNamespace(
        scale=job.scale,
        about_scale=overview.describe_scale(job.scale, repeats, bool(evidence)),
        made_by=verified["made_by"] if verified else describe_version(),
        headline=_write_headline(job, tables, evidence),
        # A study with other settings is not the one in the picture.
        pictured=bool(evidence) and {*evidence.numbers["study"]} <= {*job.outcome},
        verified=verified,
        studies=studies,
        compared=[key for key, own in studies.items() if own.families is not None],
    )


def _write_headline(
    job: PageJob, tables: list[pd.DataFrame], evidence: reader.Evidence | None
) -> list[str]:
    """Return the sentences on numbers and claims of the page's studies, if there are any.

    tables: numbers and claims of the scale. evidence: stands in for those of `job.outcome`.
    """
    replaced = job.outcome if evidence else []
    rest = {*job.studies} - {*replaced}
    # A scale without tables of all studies has no rows of its own.
    own = tables or [table[:0] for table in evidence or ()]
    describe = (headline.describe_numbers, headline.describe_claims)
    said = [
        write(pd.concat([many[many["study"].isin(replaced)], table[table["study"].isin(rest)]]))
        for write, table, many in zip(describe, own, evidence or own)
    ]
    return [*filter(None, said)]


def render_page(page: SimpleNamespace, folder: Path) -> str:
    """Return the page as html that needs no other file.

    folder: where the pictures of its figures are.
    """
    return build_environment(folder).get_template("page.html.jinja").render(page=page)


def build_environment(folder: Path, *more: Path) -> Any:
    """Return a `jinja2.Environment` with all that templates can use.

    Templates are those of this folder and of more folders. folder: where the pictures of figures
    are.
    """
    import jinja2
    from markupsafe import Markup

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([*more, HERE / "templates", HERE / "static"]),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        # A misspelt name of a template is a fault, not an empty text.
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "look": lambda verdict: legend.WORDS[verdict],
        "short": format_value,
        "heading": naming.format_heading,
        "amount": naming.format_amount,
        "counts": count_verdicts,
        "positions": describe_positions,
        "range_text": comparison.format_range,
        "packed": pack,
        "failing": overview.select_failing,
        "labelled": label_keys,
    }
    environment.globals |= {
        "address": addresses.build_address,
        "overview": overview,
        "baseline": methods.BASELINE,
        "charts": charts,
        "drawing": lambda figure: (folder / f"{figure['stem']}.svg").read_text(encoding="utf-8"),
        "marks": MARKS,
        "picture": lambda name: base64.b64encode(Path(PICTURES[name]).read_bytes()).decode(),
        "root": "",  # before the paths of files of results
        "meaning": describe_metric,
        "size": read_size,
        "static": lambda name: Markup((HERE / "static" / name).read_text(encoding="utf-8")),
        "verdicts_on": legend.select_words,
        "words": legend.WORDS,
    }
    return environment


def pack(text: str) -> str:
    """Return text compressed for the page's script to unpack."""
    return base64.b64encode(zlib.compress(text.encode(), 9)).decode()


def read_size(drawing: str) -> list[int]:
    """Read width and height of an svg text, in points."""
    found = (re.search(rf'\b{name}="([\d.]+)pt"', drawing) for name in ("width", "height"))
    return [round(float(each[1])) for each in found]


def format_value(value: Any, digits: int = 4) -> str:
    """Return a value as printed: a number to some significant digits, an unknown one as a dash."""
    if value is None:
        return "–"
    return naming.format_number(value, digits) if isinstance(value, float) else str(value)


def label_keys(text: Any, labels: Labels) -> str:
    """Return text with the keys of methods and metrics replaced by their printed names.

    >>> label_keys("the method mga_c of a_study", {"mga_c": "MGA-C"})
    'the method MGA-C of a_study'
    """
    return re.sub(r"\w+_\w+", lambda found: labels.get(found[0], found[0]), str(text))


def count_verdicts(rows: Iterable[Row]) -> list[tuple[str, int]]:
    """Count the rows of each verdict, in the order of `legend.WORDS`."""
    found = Counter(row["verdict"] for row in rows)
    return [(name, found[name]) for name in legend.WORDS if found[name]]


def describe_positions(cells: Iterable[Row]) -> str:
    """Say how many numbers of a table lie inside our range.

    If all numbers share the reason for which this proves nothing, the text ends with it.
    """
    placed = [cell for cell in cells if cell["bar"]]
    if not placed:
        return ""
    told = [cell for cell in placed if not cell["wide"]]
    inside = sum(cell["position"] == "inside" for cell in told)
    text = f"{inside} of {len(told)} printed numbers inside our range"
    if len(told) < len(placed):
        unknown = len(placed) - len(told)
        wide = f"of {len(placed)} printed numbers our range is too wide to tell for {unknown}"
        text = f"{text}; {wide}" if told else wide.capitalize()
    reasons = {cell["reason"] for cell in placed}
    # Different reasons stand beside their numbers.
    if len(reasons) == 1 and (reason := reasons.pop()):
        text += f". This proves nothing: {reason}"
    return text
