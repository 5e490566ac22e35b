"""Which printed statistics any data could have: closed forms, in exact arithmetic.

A printed number stands for every value that rounds to it: up to half a unit of its last digit on
either side, both ends included, because papers round halves up as well as to even. So every test is
lenient: a number that fails it belongs to no data at all. `step` is the distance between possible
values of one run: 1 for counts.

Sources: Brown and Heathers (2017), "The GRIM test", Social Psychological and Personality Science 8,
363; Anaya (2016), "The GRIMMER test", PeerJ Preprints 4:e2400v1, in the closed form of Allard
(2018), "Analytic-GRIMMER"; Bhatia and Davis (2000), "A better bound on the variance", American
Mathematical Monthly 107, 353.
"""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np


class Printed(NamedTuple):
    """A printed number, and half a unit of its last digit."""

    value: Fraction
    half: Fraction

    @property
    def low(self) -> Fraction:
        """The least value that rounds to the printed one."""
        return self.value - self.half

    @property
    def high(self) -> Fraction:
        """The greatest value that rounds to the printed one."""
        return self.value + self.half


def printed(text: str) -> Printed:
    """A number with the digits that are printed, such as `7.30`. Raises ValueError if the text is
    no number.
    """
    return Printed(Fraction(text), Fraction(10) ** -decimals(text) / 2)


def decimals(text: str) -> int:
    """How many digits stand after the point; in `1.5e3`, where the last one stands for hundreds,
    -2.
    """
    digits, _, power = text.strip().lower().partition("e")
    return len(digits.partition(".")[2]) - int(power or 0)


# Means and standard deviations of values that are multiples of a step


def sums(mean: Printed, n: int, step: Fraction) -> range:
    """The sums of n values, in steps, whose mean is printed so (GRIM): empty if there is none."""
    return range(math.ceil(mean.low * n / step), math.floor(mean.high * n / step) + 1)


def grim_decides(mean: Printed, n: int, step: Fraction) -> bool:
    """Whether some number with as many digits is the mean of no n values: possible means lie
    further apart than printed numbers.
    """
    return step / n > 2 * mean.half


def nearest_mean(mean: Printed, n: int, step: Fraction) -> Fraction:
    """The possible mean of n values that is nearest to a printed one."""
    return round(mean.value * n / step) * step / n


def least_squares(total: int, n: int) -> int:
    """The least sum of squares of n whole numbers with a sum: that of numbers as equal as
    possible.
    """
    each, more = divmod(total, n)
    return more * (each + 1) ** 2 + (n - more) * each**2


def grimmer(mean: Printed, std: Printed, n: int, step: Fraction) -> tuple[int, int] | None:
    """A sum and a sum of squares of n values, in steps, that give both printed numbers, or None if
    there are none (GRIMMER).

    The standard deviation is that of a sample (n - 1). A sum of squares is a whole number, as odd
    or even as the sum, and not less than that of values as equal as possible. These conditions are
    necessary, not sufficient. n is at least 2.
    """
    low, high = max(std.low, Fraction(0)) / step, std.high / step
    for total in sums(mean, n, step):
        own = Fraction(total**2, n)
        first = max(math.ceil((n - 1) * low**2 + own), least_squares(total, n))
        first += (first - total) % 2
        if first <= (n - 1) * high**2 + own:
            return total, first
    return None


def grimmer_decides(mean: Printed, std: Printed, n: int, step: Fraction) -> bool:
    """Whether some number in the place of the standard deviation is impossible: either no mean
    fits, or sums of squares lie apart.
    """
    low, high = max(std.low, Fraction(0)) / step, std.high / step
    return grim_decides(mean, n, step) or (n - 1) * (high**2 - low**2) < 2


# Statistics of any numbers


def in_order(first: Printed, second: Printed) -> bool:
    """Whether the number behind one can be at most that behind another; rounding to equal digits
    keeps an order.
    """
    return first.value <= second.value if first.half == second.half else first.low <= second.high


def mean_limits(least: Printed, most: Printed, n: int) -> tuple[Fraction, Fraction]:
    """Between which numbers the mean of n values lies, one of which is the least and one the
    largest; n is at least 2.
    """
    return ((n - 1) * least.low + most.low) / n, (least.high + (n - 1) * most.high) / n


def std_of_range(least: Printed, most: Printed, n: int) -> tuple[float, float]:
    """Between which numbers the sample standard deviation of n values with this range lies; n is at
    least 2.

    The lowest if all but the two ends lie midway, the highest if half of them lie at either end:
    range / 2 x sqrt(n / (n - 1)).
    """
    narrow, wide = max(most.low - least.high, Fraction(0)), most.high - least.low
    return float(narrow) / math.sqrt(2 * (n - 1)), float(wide) / 2 * math.sqrt(n / (n - 1))


def std_of_mean(mean: Printed, n: int, low: Fraction, high: Fraction | None) -> float:
    """The largest sample standard deviation of n values with this mean, none below `low` or above
    `high` (Bhatia and Davis 2000).

    Without `high` it is that of n - 1 values at `low` and one that makes up for them: (mean - low)
    x sqrt(n). n is at least 2.
    """
    if high is None or mean.high - low <= (high - low) / n:
        return float(mean.high - low) * math.sqrt(n)
    # The largest within the printed mean's own range: the product is highest where the mean lies
    # midway.
    middle = min(max((low + high) / 2, mean.low), mean.high)
    return math.sqrt(float((high - middle) * (middle - low)) * n / (n - 1))


# Last digits


def last_digits(texts: list[str]) -> list[int]:
    """The last digits of printed numbers, at the commonest number of decimals: shorter ones have
    lost zeros.
    """
    commonest = max(
        sorted({decimals(text) for text in texts}), key=[decimals(text) for text in texts].count
    )
    return [int(abs(Fraction(text)) * Fraction(10) ** commonest) % 10 for text in texts]


def digits_p(counts: list[int]) -> float:
    """The exact probability that counts of equally likely categories are as uneven as these, by
    their sum of squares, as in Pearson's test.

    Counted category by category: the chance of each number of items placed so far with each sum of
    squares below that of the counts.
    """
    total, limit = sum(counts), sum(count**2 for count in counts)
    chances = np.zeros((total + 1, limit))  # items placed, their sum of squares
    chances[0, 0] = 1.0
    for left in range(len(counts), 0, -1):
        more = np.zeros_like(chances)
        for placed in range(total + 1):
            rest = total - placed
            for count in range(rest + 1) if left > 1 else [rest]:
                if count**2 >= limit:
                    break
                chance = (
                    math.comb(rest, count) * (1 / left) ** count * (1 - 1 / left) ** (rest - count)
                )
                more[placed + count, count**2 :] += chance * chances[placed, : limit - count**2]
        chances = more
    return min(1.0, max(0.0, 1.0 - chances.sum()))


# Mean ranks


def rank_sum(count: int) -> int:
    """What the mean ranks of so many rows add to."""
    return count * (count + 1) // 2


def are_ranks(numbers: Sequence[Printed]) -> bool:
    """Whether printed numbers can be the mean ranks of as many rows: they add to `rank_sum`, up to
    rounding.
    """
    return (
        sum(each.low for each in numbers)
        <= rank_sum(len(numbers))
        <= sum(each.high for each in numbers)
    )
