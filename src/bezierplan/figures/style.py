"""The style of every figure of the project.

Colours differ in lightness as well as in hue, and items that could be confused in a grey print also differ in line style, width or mark.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

# Widths of one and of two text columns of a journal, in inches.
NARROW, WIDE = 85 / 25.4, 174 / 25.4

SMALLEST_TEXT = 7  # points
TITLE_TEXT = 8

SETTINGS = {
    "font.family": "DejaVu Sans",  # ships with matplotlib, so it is the same everywhere
    "font.size": SMALLEST_TEXT,
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
    "axes.formatter.useoffset": False,  # an offset above the axis would stand in the subtitle, and hide what is shown
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "lines.solid_capstyle": "butt",
    "hatch.linewidth": 0.4,
    "legend.frameon": False,
    "legend.handlelength": 2.2,
    "legend.labelspacing": 0.6,
    "svg.fonttype": "none",  # text stays text: searchable, and readable by screen readers
    "svg.hashsalt": "bezierplan",  # equal drawings get equal identifiers
}

RED, BLUE, BLACK, AMBER = "#DD3322", "#004488", "#000000", "#E69F00"
LIGHT_BLUE = "#B7CDE6"

# Published values and ours: the same style in all figures of all papers.
PUBLISHED = {"color": BLACK, "linestyle": (0, (5, 2)), "linewidth": 1.1}
OURS = {"color": BLUE, "linestyle": "-", "linewidth": 1.3}

# The one run that a panel shows, and the proven limit that no path can beat.
RUN_SHOWN = {"color": RED, "linestyle": "-", "linewidth": 1.8}
REFERENCE = {"color": BLACK, "linestyle": (0, (6, 1.5, 1, 1.5)), "linewidth": 0.8}
BOUND = {"color": BLACK, "linestyle": (0, (1, 1.2)), "linewidth": 1.0}

# Lines side by side, by name: the colours of Okabe and Ito first. Two that share their dashes (every fifth) differ in lightness.
_COLOURS = ("#000000", "#D55E00", "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#4B0055", "#56B4E9", "#8C510A", "#B5B5B5")
_DASHES = ("-", (0, (5, 1.5)), (0, (2, 1)), (0, (6, 1.5, 1, 1.5)), (0, (8, 1, 1, 1, 1, 1)))
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p")
# Bars side by side: neighbours differ in lightness and in hatching.
_FILLS = ("#DCE6F2", "#8FB0D6", "#D55E00", "#F7DDB5", "#0072B2", "#FFFFFF", "#333333", "#BDBDBD")
_HATCHES = ("", "////", "", "\\\\\\\\", "", "....", "", "xxxx")
# Numbers take their colours from a scale, the higher the lighter, without its lightest end, which is invisible on paper.
SCALE, _LIGHTEST = "viridis", 0.8

BOX = {"facecolor": LIGHT_BLUE, "edgecolor": BLUE, "linewidth": 0.7}
PUBLISHED_MARK = {"color": BLACK, "linestyle": "", "marker": "D", "markersize": 4.5, "markerfacecolor": "#FFFFFF", "markeredgewidth": 0.9}

FREE, OCCUPIED, SURPLUS = "#FFFFFF", "0.66", "0.94"
CELL_LINE = "0.85"
SURPLUS_HATCH = {"hatch": "/////", "hatchcolor": "0.7"}

# A panel narrower than this, in inches, shows only the shortest notes, and names its axes only at the edge of the sheet.
NARROW_PANEL = 2.0

# Height of a panel with two unlike axes, as a share of its width: by default, and if names beside it need height and leave little width.
# Room between panels, in inches.
PANEL_HEIGHT = 0.62
HIGH_PANEL_HEIGHT = 0.9
GAP = 0.1


def ground(share: float) -> str:
    """The colour of terrain at a share of the range from the lowest to the highest: pale, so that lines stand out."""
    import matplotlib as mpl

    return mpl.colors.to_hex(mpl.colormaps["Purples"](0.6 * share))


def interval_band(colour: str) -> dict[str, Any]:
    """The style of a line's interval: pale in the line's colour, with an edge that stays visible where bands overlap."""
    return {"facecolor": (colour, 0.12), "edgecolor": (colour, 0.5), "linewidth": 0.4}


def lines(values: list[Any]) -> list[dict[str, Any]]:
    """Styles of lines for values side by side, one each: a colour scale for numbers, distinct colours for names; with dashes and marks."""
    import matplotlib as mpl

    if len(values) > 1 and not isinstance(values[0], str):
        scale = mpl.colormaps[SCALE]
        colours = [mpl.colors.to_hex(scale(_LIGHTEST * i / (len(values) - 1))) for i in range(len(values))]
    else:
        colours = [_COLOURS[i % len(_COLOURS)] for i in range(len(values))]
    return [
        {
            "color": colour,
            "linestyle": _DASHES[i % len(_DASHES)],
            "marker": _MARKERS[i % len(_MARKERS)],
            "linewidth": 1.1,
            "markersize": 3.5,
        }
        for i, colour in enumerate(colours)
    ]


def bars(count: int) -> list[dict[str, Any]]:
    """Styles of the given number of bars side by side."""
    return [
        {"facecolor": _FILLS[i % len(_FILLS)], "hatch": _HATCHES[i % len(_HATCHES)], "edgecolor": BLACK, "linewidth": 0.5}
        for i in range(count)
    ]


def in_order(values: pd.Series, panel: dict) -> list[Any]:
    """The distinct values of a column: those in the panel's `where`, in its order, then the others, sorted."""
    wanted = panel.get("where", {}).get(values.name)
    listed = wanted if isinstance(wanted, list) else []
    present = values.dropna().unique().tolist()
    return [value for value in listed if value in present] + sorted(set(present) - set(listed))


def printed(value: Any, column: str, labels: dict[str, str]) -> str:
    """How a value of a column is printed: a name as its label, a number after the column's label."""
    return labels.get(value, value) if isinstance(value, str) else f"{column_name(column, labels)} = {value:g}"


def column_name(column: str, labels: dict[str, str]) -> str:
    """How a column or a metric is printed."""
    return labels.get(column, column.replace("_", " "))
