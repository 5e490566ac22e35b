"""Which printed statistics any data could have: closed forms, in exact arithmetic.

A printed number stands for every value that rounds to it: up to half a unit of its last digit on
either side, both ends included, because papers round halves up as well as to even. So every test is
lenient: a number that fails it belongs to no data at all.

Source: Bhatia and Davis (2000), "A better bound on the variance", American Mathematical Monthly
107, 353.
"""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple


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


def finite(end: float | str) -> Fraction | None:
    """An end of a range as a number; None if it is infinite or the name of a column."""
    return None if isinstance(end, str) or math.isinf(end) else Fraction(end)


def in_order(first: Printed, second: Printed) -> bool:
    """Whether the number behind one can be at most that behind another; rounding to equal digits
    keeps an order.
    """
    return first.value <= second.value if first.half == second.half else first.low <= second.high


def mean_limits(least: Printed, most: Printed, n: int) -> tuple[Fraction, Fraction]:
    """Between which numbers the mean of n values lies, one of which is the least and one the
    largest; that of any number of values if n is below 2.
    """
    if n < 2:
        return least.low, most.high
    return ((n - 1) * least.low + most.low) / n, (least.high + (n - 1) * most.high) / n


def std_of_range(least: Printed, most: Printed, n: int) -> tuple[float, float]:
    """Between which numbers the sample standard deviation of n values with this range lies; that of
    any number of values if n is below 2.

    The lowest if all but the two ends lie midway, the highest if half of them lie at either end:
    range / 2 x sqrt(n / (n - 1)).
    """
    narrow, wide = max(most.low - least.high, Fraction(0)), most.high - least.low
    if n < 2:
        return 0.0, float(wide) / math.sqrt(2)
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


def are_ranks(numbers: Sequence[Printed]) -> bool:
    """Whether printed numbers can be the mean ranks of as many rows: up to rounding
    they add to k (k + 1) / 2.
    """
    total = len(numbers) * (len(numbers) + 1) // 2
    return sum(each.low for each in numbers) <= total <= sum(each.high for each in numbers)
