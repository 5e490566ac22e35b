"""How tightly a path turns."""

import math

import numpy as np

from bezierplan.geometry.arc_length import evaluate
from bezierplan.geometry.curves import STANDSTILL, bezier_pieces
from bezierplan.kernels import compile_kernel
from bezierplan.workspaces.problem import Path

# Samples of a piece in which its largest curvature is sought: these for one piece, at least those
# for one of many; and how often they close in on it.
_MOST_SAMPLES, _LEAST_SAMPLES = 400, 16
_ZOOMS = 3

# A piece whose speed is a smaller share of the fastest one's is a point, and turns by rounding.
_POINT = 1e-9


def largest_curvature(path: Path) -> float:
    """Return the largest absolute curvature of a path, in 1/unit, corners between pieces left out.

    Each piece is sampled, and then more and more closely around its tightest sample. The curvature
    counts as 0 where a piece stands still (`STANDSTILL`).
    """
    pieces = bezier_pieces(path)
    degree = pieces.shape[1] - 1
    if degree == 1:
        return 0.0
    first = degree * np.diff(pieces, axis=1)
    return _find_largest(first, (degree - 1) * np.diff(first, axis=1))


@compile_kernel
def _find_largest(first: np.ndarray, second: np.ndarray) -> float:
    """Find the largest absolute curvature of pieces.

    first, second: control points (pieces, degree, 2) and (pieces, degree - 1, 2) of derivatives.
    """
    pieces = len(first)
    count = max(_LEAST_SAMPLES, _MOST_SAMPLES // pieces)
    low, high = np.zeros(pieces), np.ones(pieces)
    speed, bend = np.empty((pieces, count)), np.empty((pieces, count))
    largest = 0.0
    for _ in range(1 + _ZOOMS):
        for i in range(pieces):
            for k in range(count):
                t = low[i] + k * (high[i] - low[i]) / (count - 1)
                dx, dy = evaluate(first[i], t)
                ddx, ddy = evaluate(second[i], t)
                speed[i, k] = math.hypot(dx, dy)
                bend[i, k] = abs(dx * ddy - dy * ddx)
        fastest = speed[:, :count].max()
        for i in range(pieces):
            # Of the piece, because an arc can be far shorter than the legs beside it.
            standstill = max(STANDSTILL * speed[i, :count].max(), _POINT * fastest)
            tightest, at = 0.0, 0
            for k in range(count):
                if speed[i, k] > standstill and bend[i, k] / speed[i, k] ** 3 > tightest:
                    tightest, at = bend[i, k] / speed[i, k] ** 3, k
            largest = max(largest, tightest)
            # The peak lies between the neighbours of the tightest sample; the next round looks
            # closer there.
            step = (high[i] - low[i]) / (count - 1)
            low[i], high[i] = low[i] + max(at - 1, 0) * step, low[i] + min(at + 1, count - 1) * step
        count = _LEAST_SAMPLES
    return largest
