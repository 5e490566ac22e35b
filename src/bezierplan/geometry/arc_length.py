"""Arc length of Bézier pieces and of polylines."""

import math

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel

_NODES_8, _WEIGHTS_8 = np.polynomial.legendre.leggauss(8)
_NODES_16, _WEIGHTS_16 = np.polynomial.legendre.leggauss(16)


def measure_lengths(points: np.ndarray) -> np.ndarray:
    """Return the length (n,) of a polyline (n, 2) up to each of its points."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def find_places(points: np.ndarray, at: np.ndarray, values: np.ndarray | float) -> np.ndarray:
    """Interpolate linearly between points (n, 2): return the places (..., 2) at some values.

    at: (n,) the value at each point.
    """
    return np.stack([np.interp(values, at, points[:, axis]) for axis in range(2)], axis=-1)


@allocation_free
def evaluate(points: np.ndarray, t: float) -> tuple[float, float]:
    """Return x and y of a Bézier piece (degree + 1, 2) at a parameter, by Horner's rule."""
    n = len(points) - 1
    s = 1.0 - t
    first = s if n else 1.0
    x, y = points[0, 0] * first, points[0, 1] * first
    factor = 1.0
    binomial = 1.0
    for i in range(1, n):
        factor *= t
        binomial *= (n - i + 1) / i
        x = (x + factor * binomial * points[i, 0]) * s
        y = (y + factor * binomial * points[i, 1]) * s
    if n:
        factor *= t
        x += factor * points[n, 0]
        y += factor * points[n, 1]
    return x, y


@allocation_free
def _integrate_speed(
    differences: np.ndarray, low: float, high: float, nodes: np.ndarray, weights: np.ndarray
) -> float:
    """Integrate the speed between two parameters by Gauss-Legendre quadrature.

    differences: (degree, 2), of control points. nodes, weights: (n,), on -1 to 1.
    """
    total = 0.0
    for node, weight in zip(nodes, weights):
        x, y = evaluate(differences, 0.5 * ((high - low) * node + high + low))
        total += weight * (len(differences) * math.hypot(x, y))
    return 0.5 * (high - low) * total


@compile_kernel
def measure_piece(piece: np.ndarray) -> float:
    """Return the arc length of one Bézier piece (degree + 1, 2), in its unit, to a relative 1e-10.

    Its speed is integrated by adaptive Gauss-Legendre quadrature. Orders 8 and 16 are compared on
    each interval, which is halved if they differ; a cusp costs only about twenty halvings.
    """
    if len(piece) == 2:
        return math.hypot(piece[1, 0] - piece[0, 0], piece[1, 1] - piece[0, 1])
    differences = piece[1:] - piece[:-1]
    scale = 0.0
    for i in range(len(differences)):
        scale += math.hypot(differences[i, 0], differences[i, 1])
    total = 0.0
    stack = [(0.0, 1.0)]
    while stack:
        low, high = stack.pop()
        coarse = _integrate_speed(differences, low, high, _NODES_8, _WEIGHTS_8)
        fine = _integrate_speed(differences, low, high, _NODES_16, _WEIGHTS_16)
        # A tenth of the promised error, in proportion to the interval; short ones, as at a cusp,
        # may err more, and the last halving ends there.
        if abs(coarse - fine) <= 1e-11 * scale * max(high - low, 1e-4) or high - low < 1e-12:
            total += fine
        else:
            middle = 0.5 * (low + high)
            stack.append((middle, high))
            stack.append((low, middle))
    return total
