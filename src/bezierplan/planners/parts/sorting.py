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
