"""Places of lines and marks in the charts of the page, which templates draw."""

from itertools import groupby
from operator import itemgetter
from typing import Any

from bezierplan.analysis.numbers.comparison import NO_RANGE
from bezierplan.running.columns import Row

# Places on a bar, and the columns of their values.
_ON_BAR = {
    "ours": "beside",
    "printed": "value_published",
    "low": "low95_predicted",
    "high": "high95_predicted",
}


def add_bars(cells: list[Row]) -> None:
    """Add a bar to each number that has a range, or None.

    A bar has places from 0 to 100, on one axis a column: the ends of our range, ours, and the
    printed number.
    """
    columns: dict[Any, list[Row]] = {}
    for cell in cells:
        cell["bar"] = None
        if cell["position"] not in (None, NO_RANGE):
            columns.setdefault(cell["table_column"], []).append(cell)
    for column in columns.values():
        reach = _list_known(column, *_ON_BAR.values())
        low, high = min(reach), max(reach)
        # Of equal numbers any width will do that is not 0.
        width = high - low or 1.0
        # An open end is that of the axis.
        ends = {"low": low, "high": high}
        for cell in column:
            known = {name: cell[key] for name, key in _ON_BAR.items() if cell[key] is not None}
            # From 4 to 96, because marks at the ends need room.
            cell["bar"] = {
                name: round(4 + 92 * (value - low) / width, 1)
                for name, value in (ends | known).items()
            }


def _list_known(rows: list[Row], *columns: str) -> list[float]:
    """Return the values of some columns that rows have."""
    return [row[name] for row in rows for name in columns if row[name] is not None]


def group_comparisons(comparisons: list[Row]) -> list[list[Row]]:
    """Group the comparisons of a claim by check and metric, and add a strip to each.

    A strip has places from 0 to 100 on the scale of its group: effect, ends, reference, printed
    effect and margin.
    """
    kind = itemgetter("check", "test", "metric", "statistic", "unit", "primary")
    # Comparisons that were judged together come before those one by one.
    ordered = sorted(comparisons, key=lambda row: (row["check"], not row["primary"]))
    groups = [list(rows) for _, rows in groupby(ordered, key=kind)]
    for group in groups:
        _add_strips(group)
    return groups


def _add_strips(rows: list[Row]) -> None:
    """Add strips on a scale that holds every effect, also the printed ones.

    Intervals end at three times the largest effect, so that a wide one does not flatten the others.
    """
    effects = _list_known(rows, "effect", "effect_published")
    most = 3 * max(map(abs, effects), default=0.0) or 1.0
    reach = _list_known(rows, "reference") + effects
    reach += [min(max(end, -most), most) for end in _list_known(rows, "low95", "high95")]
    pad = 0.06 * (max(reach) - min(reach)) or 1.0
    low, high = min(reach) - pad, max(reach) + pad

    def place(value: float | None) -> float | None:
        if value is None:
            return None
        return round(100 * (min(max(value, low), high) - low) / (high - low), 2)

    for row in rows:
        names = ("reference", "effect", "low95", "high95", "effect_published")
        margin = row["margin"] and [place(-abs(row["margin"])), place(abs(row["margin"]))]
        row["strip"] = {name: place(row[name]) for name in names} | {
            "margin": margin,
            "cut": any(not low <= end <= high for end in _list_known([row], "low95", "high95")),
        }
