"""Charts of the page, in Vega-Lite: numbers and claims by verdict, ours over published, and methods
compared with the baseline.

Colours of text and lines are names of the page's style, which differ in a light and a dark page;
those of verdicts and papers are the same in both, and in a print.
"""

import contextlib
import math
import os
import re
from collections.abc import Iterable
from functools import cache
from typing import Any, NamedTuple

from bezierplan.analysis import baseline_comparison, comparison
from bezierplan.analysis.claims.verdicts import VERDICTS
from bezierplan.figures.page import content
from bezierplan.figures.page.addresses import heading
from bezierplan.places import cache_folder

VEGA_LITE = "6.1"

# Verdict -> colour and mark of its points. Neighbours differ in lightness, so no two are alike in a
# grey print or to colour-blind eyes.
_VERDICTS = {
    "identified": ("#3f8fd0", "diamond"),
    "agrees": ("#009e73", "circle"),
    "inconclusive": ("#8f979f", "square"),
    "disagrees": ("#d55e00", "cross"),
    "supported": ("#009e73", "circle"),
    "partly": ("#d6b000", "square"),
    "depends": ("#777f87", "square"),
    "undecided": ("#8f979f", "square"),
    "untestable": ("#c3c8ce", "square"),
    "no effect": ("#eba878", "cross"),
    "contradicted": ("#d55e00", "cross"),
}
# Colours and marks of papers.
_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#8c510a", "#7e67d6")
_MARKS = (
    *("circle", "square", "triangle-up", "diamond"),
    *("cross", "triangle-down", "triangle-right", "triangle-left"),
)
# An axis of ratios reaches at most from one over this to this.
_MOST_TIMES = 8.0
# Heights of a bar and of a row of points, in pixels.
_BAR, _ROW = 27, 38
# Width of a chart where nothing says how wide the page is, in pixels.
_WIDTH = 620

_TEXT, _SOFT, _LINE = "var(--ink)", "var(--soft)", "var(--line)"
_STYLE = {
    "background": "transparent",
    "font": "system-ui, sans-serif",
    # What a chart shows stands in words beside it, and number by number in the tables.
    "aria": False,
    "mark": {"aria": False},
    "view": {"stroke": None, "continuousWidth": _WIDTH},
    "axis": {
        "labelColor": _TEXT,
        "titleColor": _TEXT,
        "gridColor": _LINE,
        "domainColor": _SOFT,
        "tickColor": _SOFT,
        "labelFontSize": 12,
        "titleFontSize": 12,
        "titleFontWeight": "normal",
        "labelLimit": 220,
    },
    "legend": {
        "labelColor": _TEXT,
        "titleColor": _TEXT,
        "labelFontSize": 12,
        "titleFontSize": 12,
        "titleFontWeight": "normal",
        "orient": "top",
        "symbolSize": 90,
        "symbolOpacity": 1,
        "columns": 3,
        "labelLimit": 260,
    },
    "text": {"fontSize": 12},
}


class Chart(NamedTuple):
    """A chart: its title, what it shows in words, its specification, and its picture as svg for a
    page without scripts.
    """

    title: str
    text: str
    spec: dict[str, Any]
    svg: str


def charts(page: content.Page) -> dict[str, Chart]:
    """The charts that the page has data for, by name."""
    import vl_convert

    written = {
        "numbers": _numbers_by_verdict(page),
        "claims": _claims_by_verdict(page),
        "ratios": _ratios(page),
        "methods": _methods(page),
    }
    drawn = {}
    for name, (title, text, body) in ((name, each) for name, each in written.items() if each):
        spec = {
            "$schema": f"https://vega.github.io/schema/vega-lite/v{VEGA_LITE}.json",
            "config": _STYLE,
            "width": "container",
            "autosize": {"type": "fit-x", "contains": "padding"},
            **body,
        }
        svg = vl_convert.vegalite_to_svg(spec, vl_version=VEGA_LITE)
        drawn[name] = Chart(title, text, spec, _named(svg, name))
    return drawn


def _named(svg: str, chart: str) -> str:
    """A picture whose parts have names of their own in the page; Vega counts them through all
    pictures of a process.
    """
    names = {
        name: f"page-chart-{chart}-{n}"
        for n, name in enumerate(dict.fromkeys(re.findall(r'\bid="([^"]*)"', svg)))
    }
    return re.sub(
        r'(\bid="|url\(#|href="#)([^")]*)',
        lambda found: found[1] + names.get(found[2], found[2]),
        svg,
    )


@cache
def script() -> str:
    """The script that draws charts in a browser: `vegaEmbed` of the element to draw in, a
    specification, and options. To put it together takes longer than most of the page, so it is kept
    for each version of the library.
    """
    import vl_convert

    file = cache_folder() / "charts" / f"{vl_convert.__version__}-{VEGA_LITE}.js"
    with contextlib.suppress(OSError):
        return file.read_text(encoding="utf-8")
    text = vl_convert.javascript_bundle(vl_version=VEGA_LITE)
    with contextlib.suppress(OSError):  # where no folder can be written, each page does this anew
        file.parent.mkdir(parents=True, exist_ok=True)
        part = file.with_suffix(f".{os.getpid()}")
        part.write_text(text, encoding="utf-8")
        part.replace(file)
    return text


Written = tuple[str, str, dict[str, Any]]


def _numbers_by_verdict(page: content.Page) -> Written | None:
    text = (
        "Stacked bars: how many of the published numbers of each paper agree with our runs, "
        "disagree, or are inconclusive."
    )
    return _stacked(page, "Published numbers by verdict", text, comparison.VERDICTS)


def _claims_by_verdict(page: content.Page) -> Written | None:
    text = (
        "Stacked bars: how many of the claims of each paper are supported, hold in part, are "
        "contradicted, or are undecided."
    )
    return _stacked(page, "Claims by verdict", text, VERDICTS)


def _stacked(page: content.Page, title: str, text: str, verdicts: Iterable[str]) -> Written | None:
    """Bars of one length, a row per study, divided by its counts of verdicts, which are printed
    where there is room.
    """
    ordered, rows = [name for name in _VERDICTS if name in set(verdicts)], []
    for key, study in page.studies.items():
        total = sum(study.outcome.get(name, 0) for name in ordered)
        before = 0
        for name in ordered:
            if count := study.outcome.get(name, 0):
                extent = {
                    "from": before / total,
                    "to": (before + count) / total,
                    "middle": (before + count / 2) / total,
                }
                tip = f"{key}; {count} of {total} {name}"
                row = {"study": key, "verdict": name, "count": count, "tip": tip}
                rows.append(row | {"address": study.address} | extent)
                before += count
    if not rows:
        return None
    shown = [name for name in ordered if any(row["verdict"] == name for row in rows)]
    sides = {"domain": False, "ticks": False}
    shares = {"format": "%", "title": None, "tickCount": 5}
    bars = {
        "mark": {"type": "bar", "stroke": "var(--paper)", "height": {"band": 0.82}},
        "encoding": {
            "x": _number("from", axis=shares),
            "x2": {"field": "to"},
            "color": _name("verdict", scale=_scale(shown, 0), legend={"title": None}),
        },
    }
    numbers = {
        "transform": [{"filter": "datum.to - datum.from > 0.045"}],
        "mark": {"type": "text", "color": "#000000"},
        "encoding": {"x": _number("middle"), "text": {"field": "count"}},
    }
    y = _name("study", sort=list(page.studies), title=None, axis=sides)
    spec = {
        "data": {"values": rows},
        "height": _BAR * len({row["study"] for row in rows}),
        "encoding": {"y": y, "tooltip": {"field": "address"}},
        "layer": [bars, numbers],
    }
    return title, text, spec


def _number(field: str, **more: Any) -> dict[str, Any]:
    """The encoding of a field of numbers."""
    return {"field": field, "type": "quantitative", **more}


def _name(field: str, **more: Any) -> dict[str, Any]:
    """The encoding of a field of names."""
    return {"field": field, "type": "nominal", **more}


def _point(**more: Any) -> dict[str, Any]:
    return {"type": "point", "filled": True, **more}


def _scale(names: list[str], part: int) -> dict[str, list[str]]:
    """The scale of verdicts: their colours (part 0) or marks (part 1)."""
    return {"domain": names, "range": [_VERDICTS[name][part] for name in names]}


def _ratios(page: content.Page) -> Written | None:
    """All published numbers as ours over published, a row per table, each with the interval that
    its verdict rests on.
    """
    rows = [
        row
        for study in page.studies.values()
        for table in study.tables
        for row in _of_table(study, table)
    ]
    if not rows:
        return None
    reach = min(_MOST_TIMES, 1.05 * max(max(row["ratio"], 1 / row["ratio"]) for row in rows))
    shown = [name for name in _VERDICTS if any(row["verdict"] == name for row in rows)]
    scale = {"type": "log", "domain": [1 / reach, reach], "clamp": True, "nice": False}
    ticks = [each for each in (1 / 8, 1 / 4, 1 / 2, 1, 2, 4, 8) if 1 / reach <= each <= reach]
    y = _name(
        "table",
        sort=list(dict.fromkeys(row["table"] for row in rows)),
        title=None,
        axis={"grid": True, "tickBand": "extent", "ticks": False, "domain": False},
    )
    above = _number("height", scale={"domain": [-0.08, 1.08]})
    colour, shape = (
        _name("verdict", scale=_scale(shown, part), legend={"title": None, "columns": 2})
        for part in (0, 1)
    )
    axis = {"values": ticks, "title": "ours / published", "format": "~g"}
    equal = {
        "data": {"values": [{"one": 1}]},
        "mark": {"type": "rule", "color": _SOFT},
        # It crosses the whole chart: none of the channels of the others.
        "encoding": dict.fromkeys(("y", "yOffset", "color", "tooltip")) | {"x": _number("one")},
    }
    ranges = {
        "mark": {"type": "rule", "opacity": 0.55, "clip": True},
        "encoding": {"x": _number("low", scale=scale, axis=axis), "x2": {"field": "high"}},
    }
    points = {
        "mark": _point(size=34, opacity=1, strokeWidth=0),
        "encoding": {"x": _number("ratio"), "shape": shape},
    }
    spec = {
        "data": {"values": rows},
        "height": _ROW * len({row["table"] for row in rows}),
        "encoding": {"y": y, "yOffset": above, "color": colour, "tooltip": {"field": "address"}},
        "layer": [equal, ranges, points],
    }
    counted = sum(
        number.counted
        for study in page.studies.values()
        for table in study.tables
        for number in table.numbers
    )
    of = f" of {counted}" if counted > len(rows) else ""
    zero = " (a ratio with 0 has no place)" if of else ""
    text = (
        f"Dots: {len(rows)}{of} published numbers, ours divided by the published one, on a "
        f"logarithmic axis{zero}, one row per table; lines: the range (95 %) that an experiment of "
        "the paper's size would print. A line that does not reach 1 is a number that disagrees."
    )
    return "Ours over published, every number", text, spec


def _of_table(study: content.Study, table: content.Table) -> list[dict[str, Any]]:
    """Rows of a table: ratios to its published numbers, from the lowest to the highest; none where
    a ratio is undefined.
    """
    numbers_shown = [
        number
        for number in table.numbers
        if number.counted and number.published and (number.beside or 0) / number.published > 0
    ]
    numbers_shown.sort(key=lambda number: number.beside / number.published)
    rows = []
    for position, number in enumerate(numbers_shown):
        low, high = (None if end is None else end / number.published for end in number.predicted)
        row = {
            "address": number.address,
            "table": f"{study.address} {heading(table.name)}",
            "verdict": number.verdict,
            "ratio": _digits(number.beside / number.published),
            "height": _digits((position + 0.5) / len(numbers_shown)),
            # A range without an end reaches to the edge.
            "low": _digits(max(low or 0, 1 / _MOST_TIMES)),
            "high": _digits(min(high or math.inf, _MOST_TIMES)),
        }
        rows.append(row)
    return rows


def _digits(value: float) -> float:
    """A value to as many digits as a picture shows."""
    return float(f"{value:.4g}")


def _methods(page: content.Page) -> Written | None:
    """All methods by feasible runs, length and CPU time, the last two over the baseline's."""
    rows = [
        _of_method(key, study, row)
        for key, study in page.studies.items()
        for row in study.baseline_comparison
        if row.length and row.cpu
    ]
    if not rows:
        return None
    names = list(dict.fromkeys(row["study"] for row in rows))
    colours, marks = (
        {"domain": names, "range": [looks[n % len(looks)] for n in range(len(names))]}
        for looks in (_COLOURS, _MARKS)
    )
    feasible = min(
        row.feasible_baseline
        for study in page.studies.values()
        for row in study.baseline_comparison
    )
    # Axes stay as they are when methods are hidden.
    lengths, shares = (
        _span([1.0, *(row["length"] for row in rows)]),
        _span([feasible, *(row["feasible"] for row in rows)]),
    )
    times = _span([row["cpu"] for row in rows])
    x = _number(
        "length",
        scale={"type": "log", "domain": lengths, "nice": False, "padding": 12},
        axis={"title": "path length / baseline's", "format": "~g", "tickCount": 6},
    )
    y = _number(
        "feasible",
        scale={"domain": shares, "zero": False, "padding": 12},
        axis={"title": "feasible runs", "format": "%", "tickCount": 6},
    )
    powers = _powers(row["cpu"] for row in rows)
    size = _number(
        "cpu",
        scale={"type": "log", "domain": times, "range": [40, 420]},
        legend={"title": "CPU time / baseline's", "values": powers, "format": "~g"} | _BELOW,
    )
    colour, shape = (
        _name("study", legend={"title": None}, scale=scale) for scale in (colours, marks)
    )
    methods = {
        "data": {"values": rows},
        "transform": [{"filter": "indexof(hidden, datum.address) < 0"}],
        "mark": _point(opacity=0.75, stroke="var(--paper)", strokeWidth=0.7),
        "encoding": {
            "x": x,
            "y": y,
            "size": size,
            "tooltip": {"field": "address"},
            "color": colour,
            "shape": shape,
        },
    }
    star = {
        "type": "point",
        "shape": _STAR,
        "size": 160,
        "filled": True,
        "color": _TEXT,
        "opacity": 1,
    }
    words = {"type": "text", "align": "left", "dx": 12, "dy": -12, "color": _TEXT}
    baseline = {
        "data": {"values": [{"length": 1, "feasible": feasible}]},
        "layer": [
            {"mark": star},
            {"mark": words, "encoding": {"text": {"value": "the baseline"}}},
        ],
        "encoding": {"x": _number("length"), "y": _number("feasible")},
    }
    spec = {
        "params": [{"name": "hidden", "value": []}],
        "height": 340,
        "layer": [methods, baseline],
    }
    text = (
        f"Dots: {len(rows)} methods by the share of their runs that are feasible, and by the "
        "median length of their paths over that of the baseline (star), "
        f"{baseline_comparison.BASELINE}; the larger a dot, the more CPU time. Best is high up at "
        "the left, and small."
    )
    return "Methods compared with the baseline", text, spec


_BELOW = {
    "orient": "bottom",
    "direction": "horizontal",
    "symbolFillColor": _SOFT,
    "symbolStrokeColor": _SOFT,
}
# The outline of a star with five points, in the unit of Vega's marks.
_STAR = (
    "M0,-1L0.2245,-0.309L0.9511,-0.309L0.3633,0.118L0.5878,0.809"
    "L0,0.382L-0.5878,0.809L-0.3633,0.118L-0.9511,-0.309L-0.2245,-0.309Z"
)


def _span(values: list[float]) -> list[float]:
    """The domain of an axis: from the least value to the largest, or around a single one."""
    least, most = min(values), max(values)
    return [least, most] if least < most else [0.95 * least, 1.05 * most]


def _of_method(key: str, study: content.Study, row: content.BaselineComparison) -> dict[str, Any]:
    name = study.labels.get(row.method, row.method)
    tip = (
        f"{name} ({key}); feasible {100 * row.feasible:.1f} %; length {row.length:.4g} times "
        f"the baseline's; CPU time {row.cpu:.3g} times"
    )
    named = {"study": key, "name": name, "address": row.address, "tip": tip}
    return named | {
        "length": _digits(row.length),
        "feasible": _digits(row.feasible),
        "cpu": _digits(row.cpu),
    }


def _powers(values: Iterable[float]) -> list[float]:
    """Powers of ten in the range of values, or the range itself."""
    known = sorted(values)
    powers = [
        10.0**n
        for n in range(math.ceil(math.log10(known[0])), math.floor(math.log10(known[-1])) + 1)
    ]
    return powers or [known[0], known[-1]]
