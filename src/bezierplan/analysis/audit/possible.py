"""Which printed statistics any data could have: closed forms, in exact arithmetic.

A printed number stands for every value that rounds to it: up to half a unit of its last digit on
either side, both ends included, because papers round halves up as well as to even. So every test is
lenient: a number that fails it belongs to no data at all.

Source: Bhatia and Davis (2000), "A better bound on the variance", American Mathematical Monthly
107, 353.
"""

import math
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from typing import NamedTuple


class Printed(NamedTuple):
    """A printed number, and half a unit of its last digit."""

    value: Fraction
    half: Fraction

    @property
    def low(self) -> Fraction:
        """Return the least value that rounds to the printed one."""
        return self.value - self.half

    @property
    def high(self) -> Fraction:
        """Return the greatest value that rounds to the printed one."""
        return self.value + self.half


def read_printed(text: str) -> Printed:
    """Read a number with the digits that are printed, such as `7.30`. Raises ValueError if the text
    is no number.
    """
    return Printed(Fraction(text), Fraction(10) ** -find_last_place(text) / 2)


def find_last_place(text: str) -> int:
    """Return the decimal place of a printed number's last digit: 2 for `7.30`, -2 for `1.5e3`."""
    return -int(Decimal(text).as_tuple().exponent)


def convert_end(end: float | str) -> Fraction | None:
    """Convert an end of a range to a number; None if it is infinite or the name of a column."""
    return None if isinstance(end, str) or math.isinf(end) else Fraction(end)


def is_in_order(first: Printed, second: Printed) -> bool:
    """Return whether the number behind one can be at most that behind another. Rounding to equal
    digits keeps an order, so equal digits are compared without an allowance.
    """
    return first.value <= second.value if first.half == second.half else first.low <= second.high


def compute_mean_limits(least: Printed, most: Printed, n: int) -> tuple[Fraction, Fraction]:
    """Compute the limits of the mean of n values, given the least and the largest of them; for n
    below 2, the limits for any number of values.
    """
    if n < 2:
        return least.low, most.high
    return ((n - 1) * least.low + most.low) / n, (least.high + (n - 1) * most.high) / n


def compute_std_limits(least: Printed, most: Printed, n: int) -> tuple[float, float]:
    """Compute the limits of the sample standard deviation of n values with this range; for n below
    2, the limits for any number of values.

    It is lowest if all but the two ends lie midway, and highest if half of them lie at either end:
    range / 2 x sqrt(n / (n - 1)).
    """
    narrow, wide = max(most.low - least.high, Fraction(0)), most.high - least.low
    if n < 2:
        return 0.0, float(wide) / math.sqrt(2)
    return float(narrow) / math.sqrt(2 * (n - 1)), float(wide) / 2 * math.sqrt(n / (n - 1))


def compute_largest_std(mean: Printed, n: int, low: Fraction, high: Fraction | None) -> float:
    """Compute the largest sample standard deviation of n values (at least 2) with this mean, none
    below `low` or above `high` (Bhatia and Davis 2000).

    If `high` is None, n - 1 values lie at `low` and one makes up for them: (mean - low) x sqrt(n).
    """
    if high is None or mean.high - low <= (high - low) / n:
        return float(mean.high - low) * math.sqrt(n)
    # The largest within the printed mean's own range: the product is highest where the mean lies
    # midway.
    middle = min(max((low + high) / 2, mean.low), mean.high)
    return math.sqrt(float((high - middle) * (middle - low)) * n / (n - 1))


def can_be_ranks(numbers: Sequence[Printed]) -> bool:
    """Return whether printed numbers can be the mean ranks of as many rows: up to rounding they add
    to k (k + 1) / 2.
    """
    total = len(numbers) * (len(numbers) + 1) // 2
    return sum(each.low for each in numbers) <= total <= sum(each.high for each in numbers)
