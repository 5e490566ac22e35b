"""The specification curve of a study: interpretations in the order of what they explain, and which
choices each of them makes.

After Simonsohn, Simmons and Nelson (2020), "Specification curve analysis", Nature Human Behaviour
4, 1208.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from bezierplan.figures import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ROW, _ABOVE = 0.115, 2.0  # height of a row of choices, and of the curve with its labels, in inches


def draw(interpretations: pd.DataFrame, choices: list[str]) -> Figure:
    """interpretations: as interpretations.csv, the best first. choices: the columns that hold
    choices; those that no interpretation changes are left out.
    """
    with mpl.rc_context(style.SETTINGS):
        ordered = interpretations.iloc[::-1].reset_index(drop=True)
        rows = [
            (choice, value)
            for choice in choices
            for value in sorted(set(ordered[choice].dropna().astype(str)) - {""})
            if (ordered[choice].fillna("") != "").any()
        ]
        height = _ABOVE + _ROW * max(len(rows), 1) + 0.5
        figure = Figure(figsize=(style.WIDE, height), layout="constrained")
        above, below = figure.subplots(
            2, 1, sharex=True, height_ratios=[_ABOVE, max(_ROW * len(rows), _ROW)]
        )
        _draw_curve(above, ordered)
        _draw_choices(below, ordered, rows)
    return figure


def _draw_curve(axes: Axes, ordered: pd.DataFrame) -> None:
    place = np.arange(len(ordered))
    found = style.OURS | {"marker": "o", "markersize": 2.5}
    axes.plot(place, ordered["in_range"], label="in range", **found)
    label = "expected with the printed numbers permuted"
    axes.plot(place, ordered["by_chance"], label=label, **style.REFERENCE)
    axes.axhline(ordered["numbers"].iloc[0], label="all", **style.BOUND)
    default = ordered.index[ordered["interpretation"] == "default"]
    label, in_range = "the default interpretation", ordered["in_range"][default]
    axes.plot(default, in_range, label=label, **style.PUBLISHED_MARK)
    axes.set_ylim(bottom=0)
    axes.set_ylabel("published numbers")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), borderaxespad=0.2, ncols=2)


def _draw_choices(axes: Axes, ordered: pd.DataFrame, rows: list[tuple[str, str]]) -> None:
    for row, (choice, value) in enumerate(rows):
        made = np.flatnonzero(ordered[choice].fillna("").astype(str) == value)
        axes.plot(made, np.full(len(made), row), **style.mark("|", 5, style.BLACK))
    axes.set_yticks(range(len(rows)), [f"{choice} = {value}" for choice, value in rows])
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xlabel("interpretation, from the least to the most likely; the last ones by more runs")
