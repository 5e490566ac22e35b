"""Places of what the charts of the page show; the templates draw them."""

import math
from itertools import groupby
from types import SimpleNamespace

from bezierplan.figures.page.reader import Row

MOST_TIMES = 8.0
"""An axis of ratios reaches from one over this to this."""


def along(ratio: float) -> float:
    """The place of a ratio on a logarithmic axis from 0 to 100; at an end for one beyond it."""
    low, high = 1 / MOST_TIMES, MOST_TIMES
    share = math.log(min(max(ratio, low), high) / low) / math.log(high / low)
    return round(100 * share, 2)


def ratios(studies: list[SimpleNamespace]) -> list[Row]:
    """Ours over published, a row for each table, from the lowest number to the highest, each with
    the interval that its verdict rests on; a ratio with 0 has no place.
    """
    rows = []
    for study in studies:
        for table in study.tables:
            numbers = [
                cell
                for cell in table["numbers"]
                if cell["counted"] and cell["apart"] is not None and cell["apart"] > -1
            ]
            dots = [
                {
                    "number": cell,
                    "at": along(1 + cell["apart"]),
                    "ends": [
                        along((end or edge) / cell["value_published"])
                        for end, edge in (
                            (cell["low95_predicted"], 1e-9),
                            (cell["high95_predicted"], 1e9),
                        )
                    ],
                }
                for cell in sorted(numbers, key=lambda cell: cell["apart"])
                if cell["value_published"] > 0
            ]
            if dots:
                rows.append({"study": study, "table": table, "dots": dots})
    return rows


def forests(comparisons: list[Row]) -> list[list[Row]]:
    """Comparisons of a claim by check and metric. Added to each: strip, the places from 0 to 100 of
    effect, ends, reference, printed effect and margin on the scale of its group.
    """
    groups = []
    kind = ("check", "test", "metric", "statistic", "unit", "primary")
    for _, rows in groupby(comparisons, key=lambda row: [row[name] for name in kind]):
        group = list(rows)
        _add_strips(group)
        groups.append(group)
    return groups


def _add_strips(rows: list[Row]) -> None:
    """The scale of a group holds every effect, also the printed ones, and intervals up to three
    times the largest.
    """
    effects = [row[name] for row in rows for name in ("effect", "effect_published")]
    effects = [effect for effect in effects if effect is not None]
    most = 3 * max(map(abs, effects), default=0.0) or 1.0
    ends = [row[name] for row in rows for name in ("low95", "high95") if row[name] is not None]
    reach = [row["reference"] for row in rows] + effects
    reach += [min(max(end, -most), most) for end in ends]
    pad = 0.06 * (max(reach) - min(reach)) or 1.0
    low, high = min(reach) - pad, max(reach) + pad

    def place(value: float | None) -> float | None:
        if value is None:
            return None
        return round(100 * (min(max(value, low), high) - low) / (high - low), 2)

    for row in rows:
        names = ("reference", "effect", "low95", "high95", "effect_published")
        margin = row["margin"] and [place(-abs(row["margin"])), place(abs(row["margin"]))]
        beyond = [row[name] for name in ("low95", "high95") if row[name] is not None]
        row["strip"] = {name: place(row[name]) for name in names} | {
            "margin": margin,
            "cut": any(not low <= end <= high for end in beyond),
        }
