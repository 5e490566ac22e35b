"""The style of every figure of the project.

Colours differ in lightness as well as in hue, and items that could be confused in a grey print also
differ in line style, width or mark. A method has one look, in all figures of all studies.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from bezierplan.analysis import naming

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

# Widths of sheets of one and of two text columns of a journal, in inches.
WIDTHS = {"one": 85 / 25.4, "two": 170 / 25.4}

SMALLEST_TEXT = 7  # points

SETTINGS = {
    "font.family": "DejaVu Sans",  # ships with matplotlib, so it is the same everywhere
    "font.size": SMALLEST_TEXT,
    # So that a text is as wide in every file, whatever its dots per inch, as where it was laid out.
    "text.hinting": "no_hinting",
    "axes.titlesize": SMALLEST_TEXT,
    "axes.titlelocation": "left",
    "axes.labelsize": SMALLEST_TEXT,
    "xtick.labelsize": SMALLEST_TEXT,
    "ytick.labelsize": SMALLEST_TEXT,
    "legend.fontsize": SMALLEST_TEXT,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "axes.axisbelow": True,
    # An offset above the axis would stand in the title, and hide what is shown.
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


def build_mark_style(shape: str, size: float, colour: str, **more: Any) -> dict[str, Any]:
    """Return the style of marks without a line; more: properties of matplotlib."""
    return {"color": colour, "linestyle": "", "marker": shape, "markersize": size, **more}


RED, BLUE, BLACK, AMBER = "#DD3322", "#004488", "#000000", "#E69F00"
LIGHT_BLUE = "#B7CDE6"
COLOURS = {"red": RED, "blue": BLUE, "black": BLACK}

# Dashes of lines.
DASHED, DOTTED, DASH_DOT, DASH_DOTS = (
    (0, (5, 1.5)),
    (0, (2, 1)),
    (0, (6, 1.5, 1, 1.5)),
    (0, (8, 1, 1, 1, 1, 1)),
)

# Published values and ours: the same style in all figures of all papers.
PUBLISHED = {"color": BLACK, "linestyle": (0, (5, 2)), "linewidth": 1.1}
OURS = {"color": BLUE, "linestyle": "-", "linewidth": 1.3}

# The one run that a panel shows, and the proven limit that no path can beat.
RUN_SHOWN = {"color": RED, "linestyle": "-", "linewidth": 1.8}
REFERENCE = {"color": BLACK, "linestyle": DASH_DOT, "linewidth": 0.8}
BOUND = {"color": BLACK, "linestyle": (0, (1, 1.2)), "linewidth": 1.0}

# How methods look in every figure: colour, dashes of lines, mark. All colours are at least three
# times as dark as paper, and those that a reader may confuse, whatever his eyes, differ in dashes
# and marks.
LOOKS = {
    "black": ("#000000", DASH_DOT, "s"),
    "vermilion": ("#D55E00", "-", "o"),
    "blue": ("#0072B2", DASHED, "^"),
    "green": ("#008F68", DOTTED, "D"),
    "pink": ("#B8578E", DASH_DOTS, "v"),
    "amber": ("#B97800", (0, (4, 1, 1, 1)), "P"),
    "purple": ("#4B0055", DASHED, "X"),
    "sky": ("#2F8FCB", DASH_DOT, "<"),
    "brown": ("#8C510A", DOTTED, ">"),
    "grey": ("#7A7A7A", (0, (1, 1)), "p"),
    "olive": ("#6B7000", DASH_DOTS, "h"),
    "violet": ("#7E67D6", DOTTED, "d"),
}
# What a planner looks like in all studies, unless a study gives its method another look (`looks` in
# artefacts.yaml).
LOOK_OF_PLANNER = {
    "rounded_shortest_path": "black",
    "shortest_path": "purple",
    "shortest_cell_path": "purple",
    "straight_line": "grey",
    "prm": "olive",
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
SCALE, _LIGHTEST = "viridis", 0.58

FREE, OCCUPIED, SURPLUS = "#FFFFFF", "0.66", "0.94"

PUBLISHED_MARK = build_mark_style("D", 4.5, BLACK, markerfacecolor=FREE, markeredgewidth=0.9)

# In the legend, an interval as a bar or as a band: of no method's colour, because all have one.
INTERVAL = {"color": "0.35", "linewidth": 0.8, "label": "95 % interval"}

# In the legend, the mark of a statistic to which not all runs contribute.
HOLLOW = build_mark_style("o", 3.5, BLACK, markerfacecolor=FREE)
HOLLOW_LABEL = "hollow: some runs are not feasible"

# How labels begin that stand last in a legend, because they are about all others.
LAST = (INTERVAL["label"], "hollow", "published")
CELL_LINE = "0.85"
SURPLUS_HATCH = {"hatch": "/////", "hatchcolor": "0.7"}

# Height of a panel with two unlike axes, as a share of its width.
PANEL_HEIGHT = 0.7

# An axis shows at least this share of its values: what differs by less looks equal.
_LEAST_SPAN = 0.003

# Up to this size, values on a symmetric logarithmic axis are linear.
_LINEAR = 1e-3


def choose_looks(planners: Mapping[str, str], own: Mapping[str, str]) -> dict[str, str]:
    """Return the name of the look of each method in all figures.

    It is the declared one, else its planner's, else one that few other methods have. planners:
    method -> planner. own: method -> declared look.
    """
    looks = {
        method: own.get(method) or LOOK_OF_PLANNER.get(planner, "")
        for method, planner in planners.items()
    }
    for method, look in looks.items():
        if not look:
            looks[method] = min(LOOKS, key=[*looks.values()].count)
    return looks


def choose_line_styles(values: Sequence[Any], looks: Mapping[str, str]) -> list[dict[str, Any]]:
    """Return a style of line for each of some values side by side.

    Numbers get colours of a scale, methods their looks, and other values looks in order. looks:
    method -> the name of its look. If another value has a look already, the next free one replaces
    it.
    """
    import matplotlib as mpl

    names: list[str] = []
    black, *others = LOOKS  # black last: it is the baseline's
    for value in values:
        free = (name for name in (looks.get(value), *others) if name and name not in names)
        names.append(next(free, black))
    colours = [LOOKS[name][0] for name in names]
    if len(values) > 1 and not isinstance(values[0], str):
        scale = mpl.colormaps[SCALE](np.linspace(0, _LIGHTEST, len(values)))
        colours = [mpl.colors.to_hex(colour) for colour in scale]
    return [
        {
            "color": colour,
            "linestyle": LOOKS[name][1],
            "marker": LOOKS[name][2],
            "linewidth": 1.1,
            "markersize": 3.5,
        }
        for colour, name in zip(colours, names)
    ]


def list_groups(
    frame: pd.DataFrame, column: str, options: Any, scene: Any
) -> list[tuple[Any, pd.DataFrame, dict[str, Any]]]:
    """Return the values of a column in the order of a panel, each with its rows and its style.

    The style has the printed name of the value as its label.
    """
    values = naming.list_in_order(frame[column], options.where)
    return [
        (
            value,
            frame[frame[column] == value],
            look | {"label": naming.format_value(value, column, scene.labels)},
        )
        for value, look in zip(values, choose_line_styles(values, scene.looks))
    ]


def draw_parts(axes: Axes, frame: pd.DataFrame, looks: Mapping[str, dict], **more: Any) -> None:
    """Draw the points of each part of a panel in its look, in the order of the looks."""
    for part, look in looks.items():
        own = frame[frame["part"] == part]
        if len(own):
            axes.plot(own["x"], own["y"], **more | look)


def scale_axis(axis: Any, scale: str, unit: str) -> None:
    """Scale an axis of measured values and print plain numbers along it, lengths of time with their
    unit.

    The axis spans at least `_LEAST_SPAN` of its values.
    """
    from matplotlib.ticker import EngFormatter, FuncFormatter, LogLocator, NullFormatter

    name = axis.axis_name
    linear = {"linthresh": _LINEAR} if scale == "symlog" else {}
    getattr(axis.axes, f"set_{name}scale")(scale, **linear)
    low, high = axis.get_view_interval()
    least = _LEAST_SPAN * max(abs(low), abs(high))
    if scale == "linear" and high - low < least:
        middle = (low + high) / 2
        getattr(axis.axes, f"set_{name}lim")(middle - least / 2, middle + least / 2)
    if scale == "log":
        # Only few decades leave room for ticks within them.
        decades = np.log10(high / low)
        axis.set_major_locator(LogLocator(subs=(1.0,) if decades > 2 else (1.0, 2.0, 5.0)))
        axis.set_minor_formatter(NullFormatter())
    if unit == "s":
        axis.set_major_formatter(EngFormatter(unit))
    elif scale != "linear":
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.10g}"))


def name_places(axes: Axes, names: Sequence[str], label: str) -> None:
    """Name the x axis and the places 0, 1, ... along it; words are slanted so that none touch."""
    slant = {"rotation": 35, "ha": "right", "rotation_mode": "anchor"}
    axes.set_xticks(range(len(names)), names, **slant if max(map(len, names)) > 3 else {})
    axes.tick_params(axis="x", length=0)
    axes.set_xlabel(label)
    axes.grid(visible=True, axis="y")
