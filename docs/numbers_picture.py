"""One picture of all printed numbers: each beside our range, a strip per table."""

from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

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


def scale_numbers(numbers: pd.DataFrame) -> np.ndarray:
    """Return the places (n,) of printed numbers on a scale from the low end of our range (-1) to
    the high end (1), with ours at 0.
    """
    ours, printed = numbers["value_ours_scaled"], numbers["value_published"]
    below = printed < ours
    ends = np.where(below, ours - numbers["low95_predicted"], numbers["high95_predicted"] - ours)
    with np.errstate(divide="ignore", invalid="ignore"):
        places = np.nan_to_num((printed - ours) / ends)
    # A number that its digits put inside is drawn there, and another outside.
    inside = numbers["position"] == "inside"
    places = np.where(inside, np.clip(places, -1, 1), places)
    outside = np.sign(places) * np.maximum(np.abs(places), 1 + STEP)
    return np.clip(np.where(inside, places, outside), -FAR, FAR)


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


def draw(numbers: pd.DataFrame, names: Mapping[str, str], width: float) -> Figure:
    """Draw all printed numbers, a strip per table.

    numbers: rows of `numbers.csv` that count. names: study -> name of the paper. width: in inches.
    """
    ranged = numbers[numbers["low95_predicted"].notna() & numbers["position"].notna()]
    strips = [(place, own) for place, own in ranged.groupby(["study", "table"], sort=False)]
    dots = [stack_dots(scale_numbers(own)) for _, own in strips]
    heights = [max(3.0, np.ptp(levels) + 3) * HEIGHT for _, levels in dots]
    wide = width > TALL
    total = sum(heights) + (1.0 if wide else 1.4)
    with mpl.rc_context({"font.size": 8 if wide else 7}):
        figure = Figure(figsize=(width, total))
        left, share = (0.23, 0.4) if wide else (0.34, 0.4)
        axes = figure.add_axes((left, 0.55 / total, share, sum(heights) / total))
        top, last = sum(heights), ""
        for (place, own), (x, levels), height in zip(strips, dots, heights, strict=True):
            middle = top - height / 2
            _draw_strip(axes, own, x, middle + levels * HEIGHT)
            study, table = place
            told = own[~own["wide"].astype(bool)]
            inside = int((told["position"] == "inside").sum())
            off = 100 * np.median(compute_deviations(own))
            _write(axes, -0.03, middle, table.replace("table", "Table "), "right")
            _write(axes, 1.04, middle, f"{inside} of {len(told)}" if len(told) else "–", "left")
            _write(axes, 1.2 if wide else 1.4, middle, f"{off:.2g} %", "left")
            if wide:
                why = describe_reasons(told["reason"]) if len(told) else "too wide to tell"
                _write(axes, 1.38, middle, why, "left")
            if study != last:
                _write(axes, -0.5 if wide else -0.84, middle, names[study], "left", weight="bold")
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
        axes.set(xlim=(-FAR - 0.6, FAR + 1.2), ylim=(0, sum(heights)), yticks=[])
        axes.set_xticks([-FAR, 0, FAR], ["far below\nour range", "ours", "far above\nour range"])
        axes.spines[:].set_visible(False)
        axes.tick_params(length=0)
        _write(axes, 1.04, sum(heights) + 0.12, "inside", "left")
        _write(axes, 1.2 if wide else 1.4, sum(heights) + 0.12, "off by,\nmedian", "left")
        if wide:
            _write(axes, 1.38, sum(heights) + 0.12, "why they prove nothing", "left")
        axes.legend(
            handles=[_build_dots([0], [0], *look)[0] for look in LOOKS.values()],
            labels=list(LOOKS),
            loc="lower center",
            bbox_to_anchor=(0.5, 1.0 + 0.2 / sum(heights)),
            ncols=len(LOOKS) if wide else 1,
            frameon=False,
            handletextpad=0.1,
            columnspacing=0.8,
        )
    return figure


def describe_reasons(reasons: pd.Series) -> str:
    """Say why the numbers of a table that can be tested prove nothing, and of how many that is so
    unless of all.
    """
    counts = reasons.value_counts()
    return "\n".join(
        reason if count == len(reasons) else f"{count} of {len(reasons)}: {reason}"
        for reason, count in counts.items()
    )


LOOKS = {
    "inside our range": (style.BLUE, style.BLUE),
    "outside": (style.BLUE, "white"),
    "pale: too wide to tell": ("0.65", "0.8"),
}
"""Meaning of a dot -> colours of its edge and its face."""


def _draw_strip(axes: Axes, own: pd.DataFrame, places: np.ndarray, heights: np.ndarray) -> None:
    """Draw the dots of a table, filled inside our range and pale where it is too wide to tell."""
    wide, inside = own["wide"].astype(bool), own["position"] == "inside"
    for chosen, (edge, face) in (
        (~wide & inside, LOOKS["inside our range"]),
        (~wide & ~inside, LOOKS["outside"]),
        (wide & inside, ("0.65", "0.8")),
        (wide & ~inside, ("0.65", "white")),
    ):
        axes.add_line(_build_dots(places[chosen], heights[chosen], edge, face)[0])


def _build_dots(x: object, y: object, edge: str, face: str) -> list[mpl.lines.Line2D]:
    """Build round marks at places, with colours of edge and face."""
    look = {"marker": "o", "linestyle": "", "markersize": 4.6, "markeredgewidth": 0.9}
    return [mpl.lines.Line2D(x, y, markeredgecolor=edge, markerfacecolor=face, **look)]


def _write(axes: Axes, x: float, y: float, text: str, align: str, **look: str) -> None:
    """Write beside the strips: x as a share of their width, y in inches."""
    place = axes.get_yaxis_transform()
    axes.text(x, y, text, ha=align, va="center", transform=place, clip_on=False, **look)


def compute_deviations(numbers: pd.DataFrame) -> np.ndarray:
    """Compute |ours - published| / |published| of numbers, infinite beside a 0.

    Ours are scaled to the paper's number of runs. Quantities that the paper does not define say
    nothing, and are left out.
    """
    numbers = numbers[numbers["reason"] != comparison.UNDEFINED]
    published, ours = (
        numbers[name].to_numpy(dtype=float) for name in ("value_published", "value_ours_scaled")
    )
    off = np.abs(ours - published)
    return np.divide(
        off, np.abs(published), out=np.where(off > 0, np.inf, 0.0), where=published != 0
    )


def save(numbers: pd.DataFrame, names: Mapping[str, str], folder: Path) -> None:
    """Save the picture for screens and that for phones."""
    counted = numbers[numbers["counted"].astype(bool)]
    for name, width in (("numbers", WIDE), ("numbers_tall", TALL)):
        picture = draw(counted, names, width)
        picture.savefig(folder / f"{name}.png", dpi=150, metadata={"Software": None})
