"""Limits on the coordinates of a workspace, whatever kind of file they come from."""

from collections.abc import Iterable

import numpy as np

Place = tuple[float, float]
"""x and y, in units."""

Bounds = tuple[float, float, float, float]
"""Lowest and highest x, lowest and highest y, in units."""

LARGEST = 1e5
"""Largest size of a coordinate, in units: beyond it the checker could not keep its tolerance."""

MOST_CELLS = 16_000_000
"""Most cells or pixels of a map: 4,000 x 4,000."""

SMALLEST_GAP = 1e-7
"""Between obstacles, or an obstacle and the border, a smaller gap, in units, is meant to be closed:
the checker could not tell.
"""

SMALLEST_FEATURE = 1e-6
"""Least thickness of an obstacle, side of a cell and radius of a circle, in units: the checker's
tolerance passes thinner ones.
"""

SMALLEST_ANGLE = 1e-3
"""Least angle at a corner of an obstacle, in radians: the tip of a sharper one is thinner than the
checker's tolerance for long.
"""


def check_numbers(values: np.ndarray, where: str) -> None:
    """Raise ValueError, beginning with the location, unless all values are finite and at most
    `LARGEST` in absolute value.
    """
    # Written so that nan fails as well.
    wrong = values[~(np.abs(values) <= LARGEST)]
    if wrong.size:
        raise ValueError(
            f"{where}: {wrong[0]:g} is not a coordinate; expected finite numbers of at most "
            f"{LARGEST:g} in size"
        )


def check_cells(rows: int, columns: int) -> None:
    """Raise ValueError for more than `MOST_CELLS` cells."""
    if rows * columns > MOST_CELLS:
        raise ValueError(f"{rows:,} x {columns:,} cells; expected at most {MOST_CELLS:,}")


def bounds_of(entries: Iterable[float]) -> Bounds:
    """Read the bounds that a description gives.

    Raises ValueError like `check_bounds`.
    """
    x_low, x_high, y_low, y_high = map(float, entries)
    bounds = x_low, x_high, y_low, y_high
    check_bounds(bounds)
    return bounds


def check_bounds(bounds: Bounds) -> None:
    """Raise ValueError unless bounds are x low, x high, y low, y high in this order, coordinates
    within the limits, with low below high by `SMALLEST_FEATURE`.
    """
    check_numbers(np.array(bounds, float), "bounds")
    if not (len(bounds) == 4 and bounds[0] < bounds[1] and bounds[2] < bounds[3]):
        raise ValueError(
            f"bounds: {list(bounds)}; expected [x low, x high, y low, y high] with low below high"
        )
    check_thickness(
        min(bounds[1] - bounds[0], bounds[3] - bounds[2]), f"bounds: {list(bounds)}: side"
    )


def check_thickness(size: float, where: str) -> None:
    """Raise ValueError, beginning with the location, for a side, radius or thickness, in units,
    below `SMALLEST_FEATURE`.
    """
    if size < SMALLEST_FEATURE:
        raise ValueError(f"{where} {size:g}; expected at least {SMALLEST_FEATURE:g}")


def check_count(obstacles: int, circles: int) -> None:
    """Raise ValueError for more obstacles than a layout has circles."""
    if obstacles > circles:
        raise ValueError(
            f"obstacles: {obstacles}: expected at most {circles}, the circles of a layout"
        )


def check_gaps(gaps: np.ndarray, where: str) -> None:
    """Raise ValueError, beginning with the location, for a gap, in units, that is neither closed
    nor open.
    """
    if np.any((gaps > 0) & (gaps < SMALLEST_GAP)):
        raise ValueError(
            f"{where}: a gap below {SMALLEST_GAP:g} beside it; close it or make it wider"
        )
