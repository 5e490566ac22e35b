"""Places of lines and marks in the charts of the page, which templates draw."""

from itertools import groupby
from typing import Any

from bezierplan.analysis.numbers.comparison import NO_RANGE
from bezierplan.running.columns import Row


def add_bars(cells: list[Row]) -> None:
    """Add a bar to each number that has a range, or None.

    A bar has places from 0 to 100, on one axis a column: the ends of our range, ours, and the
    printed number.
    """
    columns: dict[Any, list[Row]] = {}
    for cell in cells:
        cell["bar"] = None
        if cell["value_published"] is not None and cell["position"] not in (None, NO_RANGE):
            columns.setdefault(cell.get("table_column", cell["column"]), []).append(cell)
    for column in columns.values():
        marks = [(cell["beside"], cell["value_published"]) for cell in column]
        ends = [(cell["low95_predicted"], cell["high95_predicted"]) for cell in column]
        reach = [each for pair in marks + ends for each in pair if each is not None]
        low, high = min(reach), max(reach)
        # Of equal numbers any width will do that is not 0.
        width = high - low or 1.0
        for cell, (ours, printed), (left, right) in zip(column, marks, ends, strict=True):
            # From 4 to 96, because marks at the ends need room.
            cell["bar"] = {
                name: round(4 + 92 * (value - low) / width, 1)
                for name, value in (
                    ("ours", ours),
                    ("printed", printed),
                    ("low", low if left is None else left),
                    ("high", high if right is None else right),
                )
            }


def group_comparisons(comparisons: list[Row]) -> list[list[Row]]:
    """Group the comparisons of a claim by check and metric, and add a strip to each.

    A strip has places from 0 to 100 on the scale of its group: effect, ends, reference, printed
    effect and margin.
    """
    groups = []
    kind = ("check", "test", "metric", "statistic", "unit", "primary")
    for _, rows in groupby(comparisons, key=lambda row: [row[name] for name in kind]):
        group = list(rows)
        _add_strips(group)
        groups.append(group)
    return groups


def _add_strips(rows: list[Row]) -> None:
    """Add strips on a scale that holds every effect, also the printed ones.

    Intervals end at three times the largest effect, so that a wide one does not flatten the others.
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
