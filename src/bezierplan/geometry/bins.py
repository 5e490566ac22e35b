"""Edges by place: a raster of square bins, so that a segment is compared with near edges only."""

import math
from typing import NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_inline, compile_kernel

# Bins are no smaller, in units, so that their margins are wider than the checker's tolerance.
_LEAST_SIDE = 1e-4


class Bins(NamedTuple):
    """Edges by the bins that they pass through.

    low: (2,) the lower left corner of all bins.
    side: side of a bin, in units.
    columns, rows: number of bins.
    first: (columns rows + 1,) where the members of each bin, column by column, begin in `members`.
    members: numbers of edges.
    """

    low: np.ndarray
    side: float
    columns: int
    rows: int
    first: np.ndarray
    members: np.ndarray


def sort_into_bins(edges: np.ndarray) -> Bins:
    """Sort edges (n, 4) into bins, about as many as there are edges."""
    ends = edges.reshape(-1, 2) if len(edges) else np.zeros((1, 2))
    low = ends.min(axis=0)
    width, height = (ends.max(axis=0) - low).tolist()
    # As many squares of this side as there are edges fill their box.
    side = max(math.sqrt(width * height / max(1, len(edges))), _LEAST_SIDE)
    empty = np.zeros(0, np.int64)
    # One column and one row more: an edge on the upper side of the box lies in the next bin.
    bins = Bins(low, side, math.ceil(width / side) + 1, math.ceil(height / side) + 1, empty, empty)
    first, members = _sort(edges, bins)
    return bins._replace(first=first, members=members)


@compile_kernel
def _sort(edges: np.ndarray, bins: Bins) -> tuple[np.ndarray, np.ndarray]:
    """Return where the members of each bin begin, and the numbers of its edges, ascending."""
    count = bins.columns * bins.rows
    first, members = np.zeros(count + 1, np.int64), np.empty(0, np.int64)
    # A counting sort, since numpy's takes seconds to compile: each bin's edges are counted, then
    # put there. Within a bin they keep their order, so searches find the same one first.
    taken = np.zeros(count, np.int64)
    for is_counted in (False, True):
        for e in range(len(edges)):
            begin, end = columns_between(edges[e, 0], edges[e, 2], bins)
            for column in range(begin, end + 1):
                low, high = rows_between(edges[e, :2], edges[e, 2:], column, bins)
                for number in range(column * bins.rows + low, column * bins.rows + high + 1):
                    if is_counted:
                        members[first[number] + taken[number]] = e
                    taken[number] += 1
        if not is_counted:
            for number in range(count):
                first[number + 1] = first[number] + taken[number]
                taken[number] = 0
            members = np.empty(first[count], np.int64)
    return first, members


@allocation_free
def columns_between(x: float, other: float, bins: Bins) -> tuple[int, int]:
    """Return the first and the last column of bins between two abscissas."""
    begin = int((min(x, other) - bins.low[0]) // bins.side)
    end = int((max(x, other) - bins.low[0]) // bins.side)
    return max(begin, 0), min(end, bins.columns - 1)


@allocation_free
def rows_near(low: float, high: float, bins: Bins) -> tuple[int, int]:
    """Return the first and the last row of bins between two ordinates, the smaller one first.

    Beside all bins the last row is the one before the first, so `list_members` finds none.
    """
    begin = int((low - bins.low[1]) // bins.side)
    end = int((high - bins.low[1]) // bins.side)
    return min(max(begin, 0), bins.rows), max(min(end, bins.rows - 1), -1)


@allocation_free
def rows_between(a: np.ndarray, b: np.ndarray, column: int, bins: Bins) -> tuple[int, int]:
    """Return the first and the last row of bins that a segment passes within a column, a little
    more rather than less.
    """
    low, high = min(a[1], b[1]), max(a[1], b[1])
    # Rounding of the crossings stays far below this.
    margin = 1e-3 * bins.side
    step = b[0] - a[0]
    if abs(step) > margin:
        left = bins.low[0] + column * bins.side
        enter, leave = (left - a[0]) / step, (left + bins.side - a[0]) / step
        y, other = a[1] + enter * (b[1] - a[1]), a[1] + leave * (b[1] - a[1])
        low, high = max(low, min(y, other)), min(high, max(y, other))
    return rows_near(low - margin, high + margin, bins)


@compile_inline
def list_members(column: int, low: int, high: int, bins: Bins) -> np.ndarray:
    """List the edges in the bins of a column from one row to another; an edge that passes through
    several of them is listed as often.
    """
    # Bins are stored column by column, so their members follow each other.
    first = bins.first[column * bins.rows + low]
    return bins.members[first : bins.first[column * bins.rows + high + 1]]
