"""Stable sorting in kernels."""

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel


@compile_kernel
def ascending(values: np.ndarray) -> np.ndarray:
    """Return the indices (n,) that sort values in ascending order, ties in their original order.

    This is numpy's stable argsort, which takes far longer to compile.

    >>> ascending(np.array([3.0, 1.0, 2.0, 1.0])).tolist()
    [1, 3, 2, 0]
    """
    order = np.arange(len(values))
    sort(order, values)
    return order


@allocation_free
def sort(indices: np.ndarray, values: np.ndarray) -> None:
    """Sort indices (n,), in place, by their values in ascending order, ties in their original
    order.

    An insertion sort is as fast as any for a few values, and for sorted survivors before offspring.
    """
    for k in range(1, len(indices)):
        i, place = indices[k], k
        while place > 0 and values[indices[place - 1]] > values[i]:
            indices[place] = indices[place - 1]
            place -= 1
        indices[place] = i


@allocation_free
def find_first_above(values: np.ndarray, limit: float) -> int:
    """Find the place of the first of ascending values that lies above a limit, or their number:
    numpy's `searchsorted` on the right side.

    >>> find_first_above(np.array([1.0, 2.0, 2.0, 3.0]), 2.0)
    3
    """
    low, high = 0, len(values)
    while low < high:
        middle = (low + high) // 2
        if values[middle] > limit:
            high = middle
        else:
            low = middle + 1
    return low


@allocation_free
def find_largest(values: np.ndarray) -> float:
    """Find the largest of values (n,), n at least 1."""
    largest = values[0]
    for value in values[1:]:
        largest = max(largest, value)
    return largest
