"""A path as a robot follows it: points along it, with heading and curvature."""

import math
from numbers import Real
from typing import NamedTuple

import numpy as np

from bezierplan.geometry import curves
from bezierplan.workspaces.problem import Path

# Intervals of a piece's parameter on which arc length is summed, by quadrature of this order; then
# Newton's method refines each parameter: a guess along a straight line has about three digits
# within so short an interval, and each step doubles them.
_INTERVALS = 64
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_NEWTON_STEPS = 4
# Most samples of a path: more come from a slip in the step, and would fill the memory.
_MOST = 10_000_000


class Samples(NamedTuple):
    """Points along a path, each field (n,).

    distance: along the path from its start, in the path's unit.
    x, y: in that unit.
    heading: direction of travel, in radians from the x-axis.
    curvature: signed, positive to the left, in 1/unit; 0 where the curve stands still or turns on
    the spot.
    """

    distance: np.ndarray
    x: np.ndarray
    y: np.ndarray
    heading: np.ndarray
    curvature: np.ndarray


def sample_along(path: Path, n: int | None = None, step: float | None = None) -> Samples:
    """Sample a path at equal distances, both ends included.

    Parameters
    ----------
    path : Path
    n : int, optional
        Number of samples, at least 2.
    step : float, optional
        Largest distance between two samples, in the path's unit. Exactly one of `n` and `step` is
        given.

    Returns
    -------
    Samples

    Raises
    ------
    ValueError
        If neither or both are given, or one is out of range.

    Examples
    --------
    >>> corner = Path("polyline", np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 1.0]]))
    >>> samples = sample_along(corner, step=1.0)
    >>> samples.x.round(9).tolist(), samples.y.round(9).tolist()
    ([0.0, 1.0, 2.0, 3.0, 3.0], [0.0, 0.0, 0.0, 0.0, 1.0])
    """
    if (n is None) == (step is None):
        raise ValueError("expected either n, a number of samples, or step, a distance between two")
    pieces = curves.bezier_pieces(path)
    knots = np.arange(_INTERVALS) / _INTERVALS
    low = np.tile(knots, len(pieces))
    speeds = _integral(np.repeat(pieces, _INTERVALS, axis=0), low, low + 1 / _INTERVALS)
    cumulative = np.concatenate([[0.0], np.cumsum(speeds)])
    length = cumulative[-1]
    if step is not None:
        if not isinstance(step, Real) or not 0 < step < math.inf:
            raise ValueError(f"step: {step!r}; expected a number above 0")
        # A length that is a multiple of the step up to rounding gets no sample more. Of a tiny step
        # the quotient may be infinite.
        n = max(2, math.ceil(min(float(length) / step, _MOST) * (1 - 1e-12)) + 1)
    if not isinstance(n, int | np.integer) or n < 2:
        raise ValueError(f"n: {n!r}; expected a whole number of at least 2")
    if n > _MOST:
        given = f"n: {n}" if step is None else f"step: {step}"
        raise ValueError(f"{given}; expected at most {_MOST} samples")
    distance = np.linspace(0.0, length, n)
    interval = np.clip(np.searchsorted(cumulative, distance, side="right") - 1, 0, len(speeds) - 1)
    piece, low = interval // _INTERVALS, knots[interval % _INTERVALS]
    rest = distance - cumulative[interval]
    width = 1.0 / _INTERVALS
    share = np.divide(rest, speeds[interval], out=np.zeros(n), where=speeds[interval] > 0)
    t = low + width * share
    for _ in range(_NEWTON_STEPS):
        ran = _integral(pieces[piece], low, t)
        rate = _speed(pieces[piece], t)
        change = np.divide(rest - ran, rate, out=np.zeros(n), where=rate > 0)
        t = np.clip(t + change, low, low + width)
    # Both ends to the last bit, whatever Newton's method leaves.
    t[0], t[-1] = 0.0, 1.0
    points = curves.evaluate_pieces(pieces[piece], t)
    points[0], points[-1] = pieces[0, 0], pieces[-1, -1]
    return Samples(
        distance,
        points[:, 0],
        points[:, 1],
        _headings(pieces[piece], t),
        _curvatures(pieces[piece], t),
    )


def _integral(pieces: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the arc length (n,) of pieces (n, degree + 1, 2) between two parameters each (n,)."""
    half = (high - low) / 2
    total = np.zeros(len(low))
    for node, weight in zip(_NODES, _WEIGHTS, strict=True):
        total += weight * _speed(pieces, low + half * (node + 1))
    return half * total


def _speed(pieces: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the speeds (n,) of pieces (n, degree + 1, 2) at one parameter each (n,)."""
    return np.hypot(*curves.differentiate_pieces(pieces, t).T)


def _headings(pieces: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the direction of travel (n,).

    Where the curve stands still, it is the direction to a point just ahead, or at a piece's end
    from one just behind.
    """
    direction = curves.differentiate_pieces(pieces, t)
    size = np.abs(np.diff(pieces, axis=1)).max(axis=(1, 2))
    still = np.hypot(*direction.T) <= curves.STANDSTILL * size
    if still.any():
        ahead = np.where(t < 0.5, t + 1e-3, t)
        behind = np.where(t < 0.5, t, t - 1e-3)
        between = curves.evaluate_pieces(pieces, ahead) - curves.evaluate_pieces(pieces, behind)
        direction[still] = between[still]
        direction[size == 0] = 0.0  # the whole piece is one place: no rounding error is a heading
    return np.arctan2(direction[:, 1], direction[:, 0])


def _curvatures(pieces: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the signed curvature (n,), 0 where it is not defined."""
    if pieces.shape[1] == 2:
        return np.zeros(len(t))
    return np.nan_to_num(curves.curvatures(pieces, t)[0])
