"""One picture of all printed numbers: each beside our range, a strip per table."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bezierplan.analysis.numbers import comparison
from bezierplan.figures import style

FAR = 3.0
"""Distance from ours beyond which dots are stacked; the end of our range is at 1."""
STEP = 0.2
"""Width of a dot on that scale."""
MOST = 9
"""Dots of a column."""
HEIGHT = 0.085
"""Height of a dot, in inches."""
WIDE, TALL = 8.8, 3.9
"""Widths of the pictures for screens and for phones, in inches."""
HEADS = ("inside", "off by,\nmedian", "why they prove nothing")
"""Above what stands beside the strips; the last one not on phones."""
LOOKS = {
    (False, True): (style.BLUE, style.BLUE),
    (False, False): (style.BLUE, "white"),
    (True, True): ("0.65", "0.8"),
    (True, False): ("0.65", "white"),
}
"""Is our range too wide to tell, is the number inside it? -> colours of a dot's edge and face."""
LEGEND = ("inside our range", "outside", "pale: too wide to tell")
"""Meanings of the first looks."""


def scale_numbers(numbers: pd.DataFrame) -> np.ndarray:
    """Return the places (n,) of printed numbers on a scale from the low end of our range (-1) to
    the high end (1), with ours at 0.
    """
    ours, printed = numbers["value_ours_scaled"], numbers["value_published"]
    below = printed < ours
    ends = np.where(below, ours - numbers["low95_predicted"], numbers["high95_predicted"] - ours)
    places = np.nan_to_num((printed - ours) / ends)
    # A number that its digits put inside is drawn there, and another outside.
    outside = np.sign(places) * np.clip(np.abs(places), 1 + STEP, FAR)
    return np.where(numbers["position"] == "inside", np.clip(places, -1, 1), outside)


def stack_dots(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the places of dots, and their levels above or below the line, (n,) each, so that none
    hides another.
    """
    places, levels = places.copy(), np.zeros(len(places))
    columns = np.round(places / STEP)
    for column in np.unique(columns):
        own = np.flatnonzero(columns == column)
        # Those that are far away stand in several columns.
        count, order = np.divmod(np.arange(len(own)), MOST)
        places[own] += np.sign(column) * count * STEP
        levels[own] = (order + 1) // 2 * np.where(order % 2, 1, -1)
    return places, levels


def draw(numbers: pd.DataFrame, width: float) -> Figure:
    """Draw all printed numbers, a strip per table.

    numbers: rows of `numbers.csv` that count. width: in inches.
    """
    strips = [*numbers.groupby(["study", "table"], sort=False)]
    dots = [stack_dots(scale_numbers(own)) for _, own in strips]
    heights = [max(3.0, np.ptp(levels) + 3) * HEIGHT for _, levels in dots]
    wide, whole = width > TALL, sum(heights)
    total = whole + (1.0 if wide else 1.4)
    columns = (1.04, 1.2, 1.38) if wide else (1.04, 1.4)
    with mpl.rc_context({"font.size": 8 if wide else 7}):
        figure = Figure(figsize=(width, total))
        axes = figure.add_axes((0.23 if wide else 0.34, 0.55 / total, 0.4, whole / total))
        top, last = whole, ""
        for ((study, table), own), (x, levels), height in zip(strips, dots, heights, strict=True):
            middle = top - height / 2
            _draw_strip(axes, own, x, middle + levels * HEIGHT)
            _write(axes, -0.03, middle, table.replace("table", "Table "), "right")
            for place, text in zip(columns, describe_strip(own)):
                _write(axes, place, middle, text)
            if study != last:
                _write(axes, -0.5 if wide else -0.84, middle, study, weight="bold")
                axes.axhline(
                    top,
                    color="0.85",
                    linewidth=0.6,
                    xmin=-0.5 if wide else -0.8,
                    xmax=1.7,
                    clip_on=False,
                )
            top, last = top - height, study
        axes.axvspan(-1, 1, color="0.92", zorder=0)
        axes.axvline(0, color="white", zorder=0.5)
        axes.set(xlim=(-FAR - 0.6, FAR + 1.2), ylim=(0, whole), yticks=[])
        axes.set_xticks([-FAR, 0, FAR], ["far below\nour range", "ours", "far above\nour range"])
        axes.spines[:].set_visible(False)
        axes.tick_params(length=0)
        for place, text in zip(columns, HEADS):
            _write(axes, place, whole + 0.12, text)
        axes.legend(
            handles=[_build_dots([0], [0], *look) for _, look in zip(LEGEND, LOOKS.values())],
            labels=LEGEND,
            loc="lower center",
            bbox_to_anchor=(0.5, 1.0 + 0.2 / whole),
            ncols=len(LEGEND) if wide else 1,
            frameon=False,
            handletextpad=0.1,
            columnspacing=0.8,
        )
    return figure


def describe_strip(numbers: pd.DataFrame) -> tuple[str, str, str]:
    """Say of how many numbers of a table that can be tested lie inside our range, how far off all
    are, and why they prove nothing: of how many that is so unless of all.
    """
    told = numbers[~numbers["wide"].astype(bool)]
    off = f"{100 * np.median(compute_deviations(numbers)):.2g} %"
    if told.empty:
        return "–", off, "too wide to tell"
    inside, count = (told["position"] == "inside").sum(), len(told)
    why = "\n".join(
        reason if own == count else f"{own} of {count}: {reason}"
        for reason, own in told["reason"].value_counts().items()
    )
    return f"{inside} of {count}", off, why


def _draw_strip(axes: Axes, own: pd.DataFrame, places: np.ndarray, heights: np.ndarray) -> None:
    """Draw the dots of a table, filled inside our range and pale where it is too wide to tell."""
    for (wide, inside), look in LOOKS.items():
        chosen = (own["wide"] == wide) & ((own["position"] == "inside") == inside)
        axes.add_line(_build_dots(places[chosen], heights[chosen], *look))


def _build_dots(x: object, y: object, edge: str, face: str) -> Line2D:
    """Build round marks at places, with colours of edge and face."""
    look = {"marker": "o", "linestyle": "", "markersize": 4.6, "markeredgewidth": 0.9}
    return Line2D(x, y, markeredgecolor=edge, markerfacecolor=face, **look)


def _write(axes: Axes, x: float, y: float, text: str, align: str = "left", **look: str) -> None:
    """Write beside the strips: x as a share of their width, y in inches."""
    place = axes.get_yaxis_transform()
    axes.text(x, y, text, ha=align, va="center", transform=place, clip_on=False, **look)


def compute_deviations(numbers: pd.DataFrame) -> np.ndarray:
    """Compute |ours - published| / |published| of numbers, infinite beside a 0.

    Ours are scaled to the paper's number of runs. Quantities that the paper does not define say
    nothing, and are left out.
    """
    numbers = numbers[numbers["reason"] != comparison.UNDEFINED]
    published = numbers["value_published"]
    off = (numbers["value_ours_scaled"] - published).abs() / published.abs()
    # Both are 0.
    return off.fillna(0.0).to_numpy()


def save(numbers: pd.DataFrame, folder: Path) -> None:
    """Save the picture for screens and that for phones."""
    counted = numbers[numbers["counted"].astype(bool)]
    for name, width in (("numbers", WIDE), ("numbers_tall", TALL)):
        picture = draw(counted, width)
        picture.savefig(folder / f"{name}.png", dpi=150, metadata={"Software": None})
