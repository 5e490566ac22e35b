"""The style of every figure of the project.

Colours differ in lightness as well as in hue, and items that could be confused in a grey print also
differ in line style, width or mark. A method has one look, in all figures of all studies.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

# Widths of one and of two text columns of a journal, in inches.
NARROW, WIDE = 85 / 25.4, 174 / 25.4

SMALLEST_TEXT = 7  # points
TITLE_TEXT = 8

SETTINGS = {
    "font.family": "DejaVu Sans",  # ships with matplotlib, so it is the same everywhere
    "font.size": SMALLEST_TEXT,
    # So that a text is as wide in every file, whatever its dots per inch, as where it was laid out.
    "text.hinting": "no_hinting",
    "axes.titlesize": TITLE_TEXT,
    "axes.labelsize": SMALLEST_TEXT,
    "xtick.labelsize": SMALLEST_TEXT,
    "ytick.labelsize": SMALLEST_TEXT,
    "legend.fontsize": SMALLEST_TEXT,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "axes.grid": False,
    "axes.axisbelow": True,
    # An offset above the axis would stand in the subtitle, and hide what is shown.
    "axes.formatter.useoffset": False,
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "lines.solid_capstyle": "butt",
    "hatch.linewidth": 0.4,
    "legend.frameon": False,
    "legend.handlelength": 2.2,
    "legend.labelspacing": 0.6,
    "pdf.fonttype": 42,  # TrueType: journals accept no other embedded kind
    "svg.fonttype": "none",  # text stays text: searchable, and readable by screen readers
    "svg.hashsalt": "bezierplan",  # equal drawings get equal identifiers
}


def mark(shape: str, size: float, colour: str, **more: Any) -> dict[str, Any]:
    """The style of marks without a line; more: of matplotlib's properties."""
    return {"color": colour, "linestyle": "", "marker": shape, "markersize": size, **more}


RED, BLUE, BLACK, AMBER = "#DD3322", "#004488", "#000000", "#E69F00"
LIGHT_BLUE = "#B7CDE6"

# Published values and ours: the same style in all figures of all papers.
PUBLISHED = {"color": BLACK, "linestyle": (0, (5, 2)), "linewidth": 1.1}
OURS = {"color": BLUE, "linestyle": "-", "linewidth": 1.3}

# The one run that a panel shows, and the proven limit that no path can beat.
RUN_SHOWN = {"color": RED, "linestyle": "-", "linewidth": 1.8}
REFERENCE = {"color": BLACK, "linestyle": (0, (6, 1.5, 1, 1.5)), "linewidth": 0.8}
BOUND = {"color": BLACK, "linestyle": (0, (1, 1.2)), "linewidth": 1.0}

# How methods look in every figure: colour, dashes of lines, mark. All colours are at least three
# times as dark as paper, and those that a reader may confuse, whatever his eyes, differ in dashes
# and marks.
LOOKS = {
    "black": ("#000000", (0, (6, 1.5, 1, 1.5)), "s"),
    "vermilion": ("#D55E00", "-", "o"),
    "blue": ("#0072B2", (0, (5, 1.5)), "^"),
    "green": ("#008F68", (0, (2, 1)), "D"),
    "pink": ("#B8578E", (0, (8, 1, 1, 1, 1, 1)), "v"),
    "amber": ("#B97800", (0, (4, 1, 1, 1)), "P"),
    "purple": ("#4B0055", (0, (5, 1.5)), "X"),
    "sky": ("#2F8FCB", (0, (6, 1.5, 1, 1.5)), "<"),
    "brown": ("#8C510A", (0, (2, 1)), ">"),
    "grey": ("#7A7A7A", (0, (1, 1)), "p"),
    "olive": ("#6B7000", (0, (8, 1, 1, 1, 1, 1)), "h"),
    "violet": ("#7E67D6", (0, (2, 1)), "d"),
}
# What a planner looks like in all studies, unless a study gives its method another look (`looks` in
# artefacts.yaml).
LOOK_OF_PLANNER = {
    "rounded_shortest_path": "black",
    "shortest_path": "purple",
    "shortest_cell_path": "purple",
    "straight_line": "grey",
    "prm": "brown",
    "binary_genetic": "blue",
    "bca": "green",
    "node_genetic": "pink",
    "modified_genetic": "vermilion",
    "chaotic_pso": "amber",
    "abc_ep": "amber",
    "ant_colony": "amber",
    "grid_genetic": "sky",
    "lattice_genetic": "sky",
    "ant_colony_genetic": "blue",
    "fish_swarm_genetic": "purple",
}
# Numbers take their colours from a scale, the higher the lighter, without its lightest end, which
# is invisible on paper.
SCALE, _DARKEST, _LIGHTEST = "viridis", 0.0, 0.58

BOX = {"facecolor": LIGHT_BLUE, "edgecolor": BLUE, "linewidth": 0.7}
FREE, OCCUPIED, SURPLUS = "#FFFFFF", "0.66", "0.94"

PUBLISHED_MARK = mark("D", 4.5, BLACK, markerfacecolor=FREE, markeredgewidth=0.9)

# In the legend, an interval as a bar or as a band: of no method's colour, because all have one.
INTERVAL = {"color": "0.35", "linewidth": 0.8, "label": "95 % interval"}
INTERVAL_BAND = {
    "facecolor": "0.88",
    "edgecolor": "0.35",
    "linewidth": 0.4,
    "label": "95 % interval",
}

# In the legend, the mark of a statistic to which not all runs contribute.
HOLLOW = mark("o", 3.5, BLACK, markerfacecolor=FREE)
CELL_LINE = "0.85"
SURPLUS_HATCH = {"hatch": "/////", "hatchcolor": "0.7"}

# A panel narrower than this, in inches, shows only the shortest notes, and names its axes only at
# the edge of the sheet.
NARROW_PANEL = 2.0

# Intervals of more lines than this in one panel are drawn as bars at their points or at their ends:
# more bands on top of each other hide the lines.
MOST_BANDS = 5

# A figure all of whose lengths of time are shorter than this, in seconds, shows them in
# milliseconds. Values that differ by more than this factor are drawn on a logarithmic axis. An axis
# shows at least this share of its values.
_SHORT, _WIDE_RANGE, _LEAST_SPAN = 0.1, 10.0, 0.01

# An axis that is logarithmic down to near 0 shows so many decades below that of its largest value,
# if its smallest one is less than this share of the largest.
_DECADES, _NEAR_ZERO = 2, 1e-6

# Height of a panel with two unlike axes, as a share of its width: by default, and if names beside
# it need height and leave little width. Room between panels, in inches.
PANEL_HEIGHT = 0.62
HIGH_PANEL_HEIGHT = 0.9
GAP = 0.1


def ground(share: float) -> str:
    """The colour of terrain at a share of the range from the lowest to the highest: pale, so that
    lines stand out.
    """
    import matplotlib as mpl

    return mpl.colors.to_hex(mpl.colormaps["Purples"](0.6 * share))


def interval_band(colour: str) -> dict[str, Any]:
    """The style of a line's interval: pale in the line's colour, with an edge that stays visible
    where bands overlap.
    """
    return {"facecolor": (colour, 0.12), "edgecolor": (colour, 0.5), "linewidth": 0.4}


def looks_of(planners: Mapping[str, str], declared: Mapping[str, str]) -> dict[str, str]:
    """Method -> the name of its look in every figure: the declared one, else its planner's, else
    one that few other methods have.

    planners: method -> planner.
    """
    looks = {
        method: declared.get(method) or LOOK_OF_PLANNER.get(planner)
        for method, planner in planners.items()
    }
    for method, look in looks.items():
        if look is None:
            counts = Counter(filter(None, looks.values()))
            looks[method] = min(LOOKS, key=lambda name: counts[name])
    return {method: str(look) for method, look in looks.items()}


def lines(
    values: list[Any], looks: Mapping[str, str] = MappingProxyType({})
) -> list[dict[str, Any]]:
    """Styles of lines for values side by side, one each: a colour scale for numbers; for methods
    their looks; else looks in order.

    looks: method -> the name of its look. A look that another of the values has already is replaced
    by the next one that is free.
    """
    import matplotlib as mpl

    if len(values) > 1 and not isinstance(values[0], str):
        scale = mpl.colormaps[SCALE]
        colours = [
            mpl.colors.to_hex(scale(_DARKEST + (_LIGHTEST - _DARKEST) * i / (len(values) - 1)))
            for i in range(len(values))
        ]
        parts = [
            (colour, *list(LOOKS.values())[i % len(LOOKS)][1:]) for i, colour in enumerate(colours)
        ]
    else:
        names: list[str] = []
        for value in values:
            own = looks.get(value)
            free = [name for name in LOOKS if name not in names] or list(LOOKS)
            names.append(own if own is not None and own not in names else free[0])
        parts = [LOOKS[name] for name in names]
    return [
        {"color": colour, "linestyle": dashes, "marker": mark, "linewidth": 1.1, "markersize": 3.5}
        for colour, dashes, mark in parts
    ]


def is_wide(values: Iterable[float]) -> bool:
    """Whether values that an axis shows need a logarithmic scale: all positive, with a large ratio
    of the largest to the smallest.
    """
    import numpy as np

    known = np.array([value for value in values if np.isfinite(value)])
    return len(known) > 1 and bool(known.min() > 0 and known.max() > _WIDE_RANGE * known.min())


def fit(
    axis: Any,
    values: Iterable[float],
    middles: Iterable[float],
    *,
    near_zero: bool = False,
    wide: bool = False,
) -> None:
    """Scale an axis of measured values: logarithmic, with plain numbers, if what is compared
    differs widely; otherwise no closer than a hundredth of the values, so that what differs by less
    looks equal.

    middles: a typical value of each method or group that is compared. near_zero: whether a wide
    axis of values that reach 0 is linear there and logarithmic beyond. wide: whether they count as
    differing widely in any case.
    """
    import numpy as np
    from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter

    known = np.array([value for value in values if np.isfinite(value)])
    set_limits = axis.axes.set_xlim if axis.axis_name == "x" else axis.axes.set_ylim
    set_scale = axis.axes.set_xscale if axis.axis_name == "x" else axis.axes.set_yscale
    wide = len(known) > 0 and (wide or is_wide(middles))
    if wide and near_zero and -_NEAR_ZERO < known.min() / known.max() < _NEAR_ZERO:
        least = 10.0 ** (np.floor(np.log10(known.max())) - _DECADES)
        set_scale("symlog", linthresh=least, linscale=0.6)
        set_limits(-0.15 * least, known.max() * 1.5)
        decades = least * 10.0 ** np.arange(_DECADES + 2)
        axis.set_major_locator(FixedLocator([0.0, *decades[decades <= known.max() * 1.5]]))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.10g}"))
        return
    if wide and known.min() > 0:
        set_scale("log")
        set_limits(known.min() / 1.5, known.max() * 1.5)
        axis.set_major_locator(
            LogLocator(subs=(1.0,) if known.max() > 300 * known.min() else (1.0, 3.0))
        )
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.10g}"))
        axis.set_minor_formatter(NullFormatter())
        return
    low, high = axis.get_view_interval()
    least = _LEAST_SPAN * np.abs(known).max() if len(known) else 0.0
    if high - low < least:
        middle = (low + high) / 2
        set_limits(middle - least / 2, middle + least / 2)


def are_short(seconds: Iterable[float]) -> bool:
    """Whether all lengths of time that are known are better printed in milliseconds."""
    import numpy as np

    known = [value for value in seconds if np.isfinite(value)]
    return bool(known) and max(known) < _SHORT


def in_milliseconds(axis: Any) -> None:
    """Print an axis in milliseconds if it is one of seconds."""
    from matplotlib.ticker import FuncFormatter

    if axis.get_label_text().endswith("(s)"):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{1000 * value:,.6g}"))
        axis.set_label_text(f"{axis.get_label_text().removesuffix('(s)')}(ms)")


def name_rows(axes: Axes, names: Sequence[str], room: float = 0.5) -> None:
    """Name rows at heights 0, 1, ..., the first on top, with so much room beyond the outer ones."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 1 + room, -room)
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=True, axis="x")


def separate_rows(axes: Axes, rows: int) -> None:
    """Draw thin lines between rows at heights 0, 1, ..."""
    import numpy as np

    thin = {"color": "0.8", "linewidth": 0.5, "zorder": 0.5}
    axes.hlines(np.arange(rows - 1) + 0.5, 0, 1, transform=axes.get_yaxis_transform(), **thin)


def in_order(values: pd.Series, where: dict[str, Any]) -> list[Any]:
    """The distinct values of a column: those in a panel's `where`, in its order, then the others,
    sorted.
    """
    wanted = where.get(values.name)
    listed = wanted if isinstance(wanted, list) else []
    present = values.dropna().unique().tolist()
    return [value for value in listed if value in present] + sorted(set(present) - set(listed))


def printed(value: Any, column: str, labels: dict[str, str]) -> str:
    """How a value of a column is printed: a name as its label, a number after the column's
    label.
    """
    return (
        labels.get(value, value)
        if isinstance(value, str)
        else f"{column_name(column, labels)} = {value:g}"
    )


def column_name(column: str, labels: dict[str, str]) -> str:
    """How a column or a metric is printed."""
    return labels.get(column, column.replace("_", " "))
