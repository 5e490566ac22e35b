"""One-dimensional chaotic maps: sequences of numbers in [0, 1] used instead of random ones
(tharwat2018, Section 3.3, eqs. 9 to 16).

Two formulas are misprinted. Eq. 9 prints 1 / (x mod 1) for the Gauss map and explains it as 1/x -
floor(1/x), which is `gauss`; the printed form is `gauss_printed`, whose values exceed 1. In eq. 12
"mod 1" applies to the whole right-hand side. `constant` is a baseline: it stays where it starts.
"""

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel

Map = IntEnum(
    "Map",
    "gauss singer tent circle logistic sine piecewise sinusoidal gauss_printed constant",
)
MAPS = tuple(Map.__members__)

# tharwat2018: eqs. 10 and 11, the two constants of eq. 12, and the text below eq. 13.
SINGER_X4 = 13.3
TENT_PEAK = 0.7
CIRCLE_A, CIRCLE_B = 0.5, 0.2
LOGISTIC_A = 4.0
# What the paper leaves open: a of eq. 14, below 4, P of eq. 15, a of eq. 16.
SINE_A, PIECEWISE_P, SINUSOIDAL_A = 3.99, 0.4, 2.3

# Values closer than this count as equal: a sequence that moves less has collapsed.
STANDSTILL = 1e-12

# Smaller numbers have no finite reciprocal; they count as 0.
_LEAST = 1e-300

# A random start must keep its sequence alive for the first number of steps; the second is the
# number of starts tried.
_TRIAL_STEPS = 60
_MOST_STARTS = 1000


class Sequence(NamedTuple):
    """Values (length,) of a map, how many were clipped to [0, 1], and the index (from 1) at which
    the sequence collapsed, or 0.
    """

    values: np.ndarray
    clips: int
    collapsed_at: int


def compute_sequence(name: str, start: float, length: int, singer_mu: float) -> Sequence:
    """Compute a map's values from a start in [0, 1], which is the first of them.

    Values that leave [0, 1] are clipped, and the sequence continues from there; values of
    `gauss_printed` are left as they are. A sequence has collapsed at the point from which it stands
    still until its end.

    singer_mu: mu of eq. 10, between 0.9 and 1.08.

    Raises ValueError for an unknown map and for a start outside [0, 1].

    >>> compute_sequence("tent", 0.35, length=3, singer_mu=1.07).values.round(6).tolist()
    [0.35, 0.5, 0.714286]
    """
    if not 0 <= start <= 1:
        raise ValueError(f"start: {start}; a chaotic sequence starts from 0 to 1")
    return Sequence(*_compute_sequence(_get_number(name), start, length, singer_mu))


def draw_start(rng: np.random.Generator, name: str, singer_mu: float) -> float:
    """Draw a uniform start in (0, 1) from which a map's sequence stays alive.

    It is redrawn while the sequence dies at 0 or at a fixed point.

    Raises ValueError for an unknown map and if no start stays alive.
    """
    number = _get_number(name)
    for _ in range(_MOST_STARTS):
        start = rng.random()
        if _is_alive(number, start, singer_mu):
            return start
    raise ValueError(
        f"chaotic map {name}: none of {_MOST_STARTS} random starts lives with mu = {singer_mu}"
    )


def _get_number(name: str) -> int:
    """Return the number of a map; raises ValueError for an unknown one."""
    if name not in MAPS:
        raise ValueError(f"unknown chaotic map {name!r}; known: {', '.join(MAPS)}")
    return Map[name].value


@compile_kernel
def _compute_sequence(number, start, length, singer_mu):
    """Compute a map's values, how often they were clipped, and where they came to a standstill (0:
    nowhere).
    """
    values = np.empty(length)
    clips = 0
    collapsed_at = 0
    x = start
    for k in range(length):
        if k > 0:
            x = _apply_map(number, x, singer_mu)
            if number != Map.gauss_printed and not 0.0 <= x <= 1.0:
                x = min(max(x, 0.0), 1.0)
                clips += 1
            # A sequence that moves again had not collapsed.
            if abs(x - values[k - 1]) >= STANDSTILL:
                collapsed_at = 0
            elif collapsed_at == 0:
                collapsed_at = k
        values[k] = x
    return values, clips, collapsed_at


@allocation_free
def _is_alive(number, start, singer_mu):
    """Tell whether a sequence without clipping is neither at (or below) 0 nor at a fixed point
    after `_TRIAL_STEPS` steps.
    """
    before = x = start
    for _ in range(_TRIAL_STEPS):
        before, x = x, _apply_map(number, x, singer_mu)
    return x >= STANDSTILL and abs(x - before) >= STANDSTILL


@allocation_free
def _apply_map(number, x, singer_mu):
    """Return x_{k+1} of a map from x_k (tharwat2018, eqs. 9 to 16)."""
    if number == Map.gauss:
        return _take_fraction(1.0 / x) if x > _LEAST else 0.0
    if number == Map.singer:
        return singer_mu * x * (7.86 + x * (-23.31 + x * (28.75 - SINGER_X4 * x)))
    if number == Map.tent:
        return x / TENT_PEAK if x < TENT_PEAK else 10.0 / 3.0 * (1.0 - x)
    if number == Map.circle:
        return _take_fraction(
            x + CIRCLE_B - CIRCLE_A / (2.0 * math.pi) * math.sin(2.0 * math.pi * x)
        )
    if number == Map.logistic:
        return LOGISTIC_A * x * (1.0 - x)
    if number == Map.sine:
        return SINE_A / 4.0 * math.sin(math.pi * x)
    if number == Map.piecewise:
        nearer = min(x, 1.0 - x)  # the map is symmetric about 0.5
        if nearer <= PIECEWISE_P:
            return nearer / PIECEWISE_P
        return (nearer - PIECEWISE_P) / (0.5 - PIECEWISE_P)
    if number == Map.sinusoidal:
        return SINUSOIDAL_A * x * x * math.sin(math.pi * x)
    if number == Map.gauss_printed:
        return 1.0 / _take_fraction(x) if _take_fraction(x) > _LEAST else 0.0
    return x


@allocation_free
def _take_fraction(x):
    """Return x mod 1, the part behind the point."""
    return x - math.floor(x)
