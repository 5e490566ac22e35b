"""How every figure of the project looks.

Colours differ in lightness as well as in hue, and what could be mistaken in a grey print differs in line style, width or mark too.
"""

# Widths of one and of two text columns of a journal, in inches.
NARROW, WIDE = 85 / 25.4, 174 / 25.4

SMALLEST_TEXT = 7  # points
TITLE_TEXT = 8

SETTINGS = {
    "font.family": "DejaVu Sans",  # comes with matplotlib, so that it is the same everywhere
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
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "lines.solid_capstyle": "butt",
    "hatch.linewidth": 0.4,
    "legend.frameon": False,
    "legend.handlelength": 2.2,
    "legend.labelspacing": 0.6,
    "svg.fonttype": "none",  # words stay words: they can be searched, and read aloud
    "svg.hashsalt": "bezierplan",  # equal drawings get equal identifiers
}

RED, BLUE, BLACK = "#DD3322", "#004488", "#000000"
LIGHT_BLUE = "#B7CDE6"

# What a paper prints, and what is found here: the same in all figures of all papers.
PUBLISHED = {"color": BLACK, "linestyle": (0, (5, 2)), "linewidth": 1.1}
OURS = {"color": BLUE, "linestyle": "-", "linewidth": 1.3}

# The one run that a panel shows, and the proven limit that no path can beat.
RUN_SHOWN = {"color": RED, "linestyle": "-", "linewidth": 1.8}
BOUND = {"color": BLACK, "linestyle": (0, (1, 1.2)), "linewidth": 1.0}

FREE, OCCUPIED, SURPLUS = "#FFFFFF", "0.66", "0.94"
CELL_LINE = "0.85"
SURPLUS_HATCH = {"hatch": "/////", "hatchcolor": "0.7"}

# Height of a panel with two unlike axes, as a share of its width, and room between panels in inches.
PANEL_HEIGHT = 0.62
GAP = 0.1
