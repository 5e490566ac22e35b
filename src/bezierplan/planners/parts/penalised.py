"""The length of a particle's curve among circles, and the penalty for the circles it meets; a particle holds the free control points."""

from typing import Literal, NamedTuple

import numpy as np
from numba import njit

Penalty = Literal["multiply", "add", "death"]
_MULTIPLY, _ADD, _DEATH = range(3)

# A path is feasible if its violation does not exceed this: a converging swarm ends tangent to a circle, a rounding error deep.
FEASIBLE = 1e-9


class Objective(NamedTuple):
    """The fitness of a path, for the kernels.

    ends: (2, samples), x and y contributions of start and target to the samples. free: (n, samples), the weights of the free control
    points. circles: (obstacles, 3), x, y and radius, in units. penalty: the rule's number. beta: its factor.
    """

    ends: np.ndarray
    free: np.ndarray
    circles: np.ndarray
    penalty: int
    beta: float


@njit(cache=True)
def fitness(length: float, violation: float, objective: Objective) -> float:
    """Length of a path combined with the penalty for its violation (tharwat2018, eq. 22, which leaves the penalty open)."""
    if objective.penalty == _MULTIPLY:
        return length * (1.0 + objective.beta * violation)
    if objective.penalty == _ADD:
        return length + objective.beta * violation
    return objective.beta if violation > FEASIBLE else length


@njit(cache=True)
def least_fitness(length: float, objective: Objective) -> float:
    """The lowest fitness that a path of this length can have, whatever it meets."""
    return min(length, objective.beta) if objective.penalty == _DEATH else length


@njit(cache=True)
def length(z: np.ndarray, objective: Objective, x: np.ndarray, y: np.ndarray, chords: np.ndarray) -> float:
    """Length of the polyline through the samples of a particle's curve (tharwat2018, eq. 19).

    z: (2 n,), the particle. x, y: (samples,), the samples; overwritten. chords: (samples,) scratch.
    """
    ends, free = objective.ends, objective.free
    n, samples = free.shape
    for s in range(samples):
        x[s], y[s] = ends[0, s], ends[1, s]
    # Three control points at a time, so that each sample is read and written fewer times.
    threes = n // 3 * 3
    for k in range(0, threes, 3):
        ax, bx, cx = z[k], z[k + 1], z[k + 2]
        ay, by, cy = z[n + k], z[n + k + 1], z[n + k + 2]
        for s in range(samples):
            x[s] = x[s] + ax * free[k, s] + bx * free[k + 1, s] + cx * free[k + 2, s]
            y[s] = y[s] + ay * free[k, s] + by * free[k + 1, s] + cy * free[k + 2, s]
    for k in range(threes, n):
        zx, zy = z[k], z[n + k]
        for s in range(samples):
            x[s] += zx * free[k, s]
            y[s] += zy * free[k, s]
    # The square roots are vectorised if their sum is separate; its four partial sums need not wait for each other.
    for s in range(samples - 1):
        dx, dy = x[s + 1] - x[s], y[s + 1] - y[s]
        chords[s] = np.sqrt(dx * dx + dy * dy)
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    fours = (samples - 1) // 4 * 4
    for s in range(0, fours, 4):
        a += chords[s]
        b += chords[s + 1]
        c += chords[s + 2]
        d += chords[s + 3]
    for s in range(fours, samples - 1):
        a += chords[s]
    return (a + b) + (c + d)


@njit(cache=True)
def violation(x: np.ndarray, y: np.ndarray, circles: np.ndarray, squares: np.ndarray) -> tuple[float, int]:
    """Violation of a path, and its number of samples in circles, both summed over the circles.

    The violation of a circle is the mean over the samples of their depth below its edge, as a share of its radius (tharwat2018, eqs. 20 and
    21; the paper prints control points where only points of the path make sense).

    x, y: (samples,). circles: (obstacles, 3). squares: (samples,) scratch.
    """
    samples = len(x)
    total, colliding = 0.0, 0
    for o in range(len(circles)):
        x_centre, y_centre, radius = circles[o, 0], circles[o, 1], circles[o, 2]
        square = radius * radius
        inside = 0
        for s in range(samples):
            dx, dy = x[s] - x_centre, y[s] - y_centre
            squares[s] = dx * dx + dy * dy
            inside += squares[s] < square
        if inside:
            depth = 0.0
            for s in range(samples):
                # Few samples are inside, so their square roots are taken one by one.
                if squares[s] < square:
                    depth += max(1.0 - np.sqrt(squares[s]) / radius, 0.0)
            total += depth / samples
            colliding += inside
    return total, colliding
