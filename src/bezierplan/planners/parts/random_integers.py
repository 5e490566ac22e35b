"""Random integers in kernels: `rng.integers` in compiled code makes an array for each number."""

import numpy as np
from numba.np.random.random_methods import buffered_bounded_lemire_uint32

from bezierplan.kernels import allocation_free


@allocation_free
def draw_integer(rng: np.random.Generator, low: int, high: int) -> int:
    """Draw the number that `rng.integers(low, high)` gives (Lemire 2019, in numpy), many times
    faster.

    high - low must lie between 1 and 2**32 - 1.
    """
    # numpy draws nothing if there is no choice.
    return (
        low + np.int64(buffered_bounded_lemire_uint32(rng.bit_generator, high - low - 1))
        if high - low > 1
        else low
    )


@allocation_free
def draw_below(rng: np.random.Generator, count: int) -> int:
    """Draw a uniform integer below `count` from a single random number of `rng.random`."""
    return int(rng.random() * count)
