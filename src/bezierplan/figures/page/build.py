"""The page as text: its content in templates, with style, scripts and the table library in the same
file.
"""

import base64
import re
import zlib
from collections import Counter
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

from bezierplan.analysis import baseline_comparison
from bezierplan.analysis.metrics import METRICS
from bezierplan.figures.page import (
    HERE,
    addresses,
    answer,
    charts,
    content,
    glossary,
    pictures,
    search,
)
from bezierplan.figures.page.gather import printed_key
from bezierplan.schema.words import amount

# Verdict -> the class that colours it and its symbol; another verdict gets the last one.
LOOKS = {
    "identified": ("good", "◉"),
    "agrees": ("good", "●"),
    "disagrees": ("bad", "✕"),
    "inconclusive": ("open", "○"),
    "supported": ("good", "●"),
    "partly": ("part", "◑"),
    "contradicted": ("bad", "✕"),
    "no effect": ("bad", "="),
    "depends": ("open", "±"),
    "undecided": ("open", "?"),
    "untestable": ("open", "–"),
}
_OTHER = ("open", "·")
# Mark of a comparison -> the class that colours it, and what it says.
MARKS = {
    "+": ("good", "holds"),
    "-": ("bad", "the opposite holds"),
    "0": ("part", "neither holds"),
    "?": ("open", "not known"),
}


# Elements whose blanks mean something.
_AS_WRITTEN = ("<script", "<style", "<pre")
_PARTS = re.compile(r"(<(?:script|style|pre)\b.*?</(?:script|style|pre)>)", re.DOTALL)
# Elements that stand on lines of their own, whatever stands before their tags.
_BLOCKS = "table|caption|thead|tbody|tr|th|td|dl|dt|dd|ul|ol|li|details|summary|figure|figcaption"


def html(page: content.Page, folder: Path) -> str:
    """The page as one html text that needs no other file. folder: where the pictures of its figures
    are.
    """
    import jinja2
    from markupsafe import Markup

    loader = jinja2.FileSystemLoader([HERE / "templates", HERE / "static"])
    environment = jinja2.Environment(
        loader=loader,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "look": look,
        "short": short,
        "heading": addresses.heading,
        "settings": settings,
        "json_text": _json_text,
    }
    drawn = charts.charts(page)
    environment.globals |= {
        "charts": drawn,
        "chart_library": _packed(charts.script()) if drawn else "",
        "specifications": {name: chart.spec for name, chart in drawn.items()},
        "still": lambda chart: Markup(chart.svg),
        "forests": pictures.forests,
        "grid": grid,
        "counts": counts,
        "entries": search.entries,
        "tip": tip,
        "evidence": evidence,
        "failing": answer.failing,
        "meaning": meaning,
        "deviation": deviation,
        "words": glossary.WORDS,
        "baseline": baseline_comparison.BASELINE,
        "address": addresses.address,
        "methods_shown": {
            method.address for study in page.studies.values() for method in study.methods
        },
        "reliable": answer.reliable,
        "times_as_long": times_as_long,
        "marks": MARKS,
        "picture": lambda figure: Markup(pictures.data_uri(folder / figure.svg)),
        "size": lambda figure: pictures.size(folder / figure.svg),
        "static": lambda name: Markup((HERE / "static" / name).read_text(encoding="utf-8")),
        "table_library": _packed(
            resources.files("itables").joinpath("html/dt_bundle.js").read_text(encoding="utf-8")
        ),
    }
    data, schema = page.model_dump(mode="json"), content.Page.model_json_schema()
    template = environment.get_template("page.html.jinja")
    return _unindented(template.render(page=page, data=data, schema=schema))


def _unindented(text: str) -> str:
    """A page without the blanks before its tags, and without the line breaks before those of tables
    and lists, except where these mean something.
    """
    return "".join(
        part
        if part.startswith(_AS_WRITTEN)
        else re.sub(r"\n +(?=<|\Z)", "\n", re.sub(rf"\n *(?=</?(?:{_BLOCKS})\b)", "", part))
        for part in _PARTS.split(text)
    )


def _packed(text: str) -> str:
    """Text that the page's script unpacks: a library takes less than half its room so."""
    return base64.b64encode(zlib.compress(text.encode(), 9)).decode()


def _json_text(value: Any) -> Any:
    """JSON for a script element: nothing in it can end the element."""
    import json

    from markupsafe import Markup

    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return Markup(
        text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
    )


def look(verdict: str) -> tuple[str, str]:
    """The class and the symbol of a verdict."""
    return LOOKS.get(verdict, _OTHER)


def short(value: content.Cell, digits: int = 4) -> str:
    """A value as printed: a number to some significant digits, an unknown one as a dash."""
    if value is None:
        return "–"
    return f"{value:.{digits}g}" if isinstance(value, float) else str(value)


def times_as_long(ratio: float) -> str:
    """How long paths are compared with others, to a tenth of a per cent.

    >>> times_as_long(1.0002), times_as_long(1.25)
    ('as long', '1.25 times as long')
    """
    return "as long" if abs(ratio - 1) < 0.0005 else f"{ratio:.4g} times as long"


def counts(verdicts: list[str]) -> list[tuple[str, int]]:
    """How many there are of each verdict, in the order of `LOOKS`."""
    found = Counter(filter(None, verdicts))
    names = [*LOOKS, *sorted(found.keys() - LOOKS.keys())]
    return [(name, found[name]) for name in names if found[name]]


class Row(NamedTuple):
    """A row of a table of numbers: its keys as printed, each with the address of the method that it
    may name; its cells in the order of the columns; whether it is the paper's interpretation.
    """

    keys: list[tuple[str, str]]
    cells: list[content.Number | None]
    primary: bool


class Grid(NamedTuple):
    """Numbers as rows and columns. same: keys that all rows share, as printed. decimals: of each
    column.
    """

    keys: list[str]
    columns: list[str]
    rows: list[Row]
    same: list[str]
    decimals: list[int]


def grid(table: content.Table, labels: dict[str, str]) -> Grid:
    """The numbers of a table: a row for each combination of keys, the paper's interpretation first,
    a column for each metric and statistic.
    """
    keys = list(table.numbers[0].keys) if table.numbers else []
    values = {key: {number.keys[key] for number in table.numbers} for key in keys}
    told = [key for key in keys if len(values[key]) > 1]
    columns = list(dict.fromkeys(number.column for number in table.numbers))
    rows: dict[tuple, dict[str, content.Number]] = {}
    for number in table.numbers:
        rows.setdefault(tuple(number.keys.values()), {})[number.column] = number
    listed = [
        Row(
            [_key(key, next(iter(cells.values())).keys[key], labels, table) for key in told],
            [cells.get(column) for column in columns],
            any(number.primary for number in cells.values()),
        )
        for cells in rows.values()
    ]
    listed.sort(key=lambda row: not row.primary)
    decimals = [
        max((_decimals(n.published) for n in table.numbers if n.column == column), default=0)
        for column in columns
    ]
    same = [
        f"{key.replace('_', ' ')}: {printed_key(key, next(iter(values[key])), labels)}"
        for key in keys
        if key not in told
    ]
    return Grid(
        [labels.get(key, key.replace("_", " ")) for key in told], columns, listed, same, decimals
    )


def _key(
    key: str, value: content.Cell, labels: dict[str, str], table: content.Table
) -> tuple[str, str]:
    """A key in a column that names it, where a number stands alone, and the address of the method
    of this name.
    """
    words = short(value) if isinstance(value, int | float) else printed_key(key, value, labels)
    return words, addresses.address(table.address.partition("/")[0], "method", value)


def _decimals(value: float | None) -> int:
    return 0 if value is None else min(4, len(f"{value:.6g}".partition(".")[2]))


def settings(item: content.Table | content.Figure) -> str:
    """The methods, settings and repeats of a table or figure: its caption without the title; empty
    for a drawing without runs.
    """
    return item.caption.removeprefix(f"{item.title}.").strip()


def deviation(number: content.Number) -> str:
    """How far ours lies from the published number, in per cent of it; empty if that is 0 or one of
    them is unknown.
    """
    if not number.published or number.ours is None:
        return ""
    percent = 100 * (number.beside / number.published - 1)
    return f"{percent:+.0f}\u00a0%" if abs(percent) >= 10 else f"{percent:+.1f}\u00a0%"


def tip(number: content.Number) -> str:
    """What a cell says on hover or focus."""
    low, high = number.interval
    why = f" ({number.why})" if number.why else ""
    parts = [f"{number.verdict or 'not judged'}{why}: {number.row}, {number.column}"]
    if number.published is not None:
        size = "" if number.n_published is None else f" (n {number.n_published:g})"
        parts.append(f"published {number.published:g}{size}")
    interval = "" if low is None else f", 95 % interval {low:.5g} to {short(high, 5)}"
    parts.append(f"ours {short(number.ours, 5)}{interval}, n {short(number.n)}")
    if number.scaled not in (None, number.ours):
        parts.append(f"of the paper's number of runs {short(number.scaled, 5)}")
    if number.predicted != (None, None):
        parts.append(
            "an experiment of the paper's size: "
            f"{' to '.join(short(end, 5) for end in number.predicted)}"
        )
    if number.share_feasible is not None:
        parts.append(f"feasible {100 * number.share_feasible:.0f} %")
    if number.bound is not None:
        parts.append(
            f"exact bound {number.bound:.5g}"
            + ("" if number.gap is None else f", gap {100 * number.gap:.1f} %")
        )
    if number.extended:
        more = number.extended
        parts.append(
            f"README, at scale extended: ours {short(more.ours, 5)}, n {short(more.n)}, "
            f"{more.verdict or 'not judged'}"
        )
    return "; ".join(parts)


def evidence(claim: content.Claim) -> str:
    """The comparison that determines the verdict on a claim, in words; empty if there is none."""
    if claim.decisive is None:
        return ""
    comparison = claim.comparisons[claim.decisive]
    low, high = comparison.interval
    what = f"{meaning(comparison.metric) or comparison.metric.replace('_', ' ')}, {comparison.name}"
    if comparison.effect is None:
        counted = comparison.counted.replace(", ", " and ")
        return f"{what}: a value in {counted} runs" if counted else what
    effect = short(comparison.effect, 3)
    if comparison.unit not in ("", "-") and comparison.test != "share":
        effect = amount(effect, comparison.unit)
    interval = (
        ""
        if low is None or high is None
        else f" (95\u00a0% interval {short(low, 3)} to {short(high, 3)})"
    )
    return f"{what}: {'share' if comparison.test == 'share' else 'effect'} {effect}{interval}"


def meaning(metric: str) -> str:
    """What a metric measures, in a phrase; empty if it is not one of the metrics of runs."""
    return METRICS[metric].meaning if metric in METRICS else ""
