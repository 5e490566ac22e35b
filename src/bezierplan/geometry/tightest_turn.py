"""How tightly a path turns."""

import numpy as np

from bezierplan.geometry.curves import bezier_pieces, curvatures
from bezierplan.workspaces.problem import Path

# Samples of a piece in which its largest curvature is sought: these for one piece, at least those
# for one of many; and how often they close in on it.
_MOST_SAMPLES, _LEAST_SAMPLES = 400, 16
_ZOOMS = 3


def largest_curvature(path: Path) -> float:
    """Return the largest absolute curvature of a path, in 1/unit, corners between pieces left out.

    Each piece is sampled, and then more and more closely around its tightest sample. The curvature
    counts as 0 where the curve stands still (`STANDSTILL`).
    """
    pieces = bezier_pieces(path)
    first = max(_LEAST_SAMPLES, _MOST_SAMPLES // len(pieces))
    low, high = np.zeros(len(pieces)), np.ones(len(pieces))
    rows, largest = np.arange(len(pieces)), 0.0
    # The peak lies between the neighbours of the tightest sample; each round looks closer there.
    for count in (first, *[_LEAST_SAMPLES] * _ZOOMS):
        t = np.linspace(low, high, count, axis=1)
        kappa = np.nan_to_num(np.abs(curvatures(pieces.repeat(count, axis=0), t.ravel())[0]))
        tightest = kappa.reshape(t.shape).argmax(axis=1)
        largest = max(largest, float(kappa.max()))
        low = t[rows, np.maximum(tightest - 1, 0)]
        high = t[rows, np.minimum(tightest + 1, count - 1)]
    return largest
