"""A decorator for kernels that create no arrays."""

from collections.abc import Callable
from typing import Any

from numba import njit


def allocation_free(kernel: Callable[..., Any]) -> Callable[..., Any]:
    """`njit(cache=True)` for a kernel that creates no array or list, returns none, and calls only kernels like it.

    Otherwise numba counts the references to every array that is passed to a kernel, with instructions that lock memory: in small kernels
    that takes most of the time, and much of the time to compile them. numba refuses to compile a kernel that creates an array all the same.
    """
    # The flag, which numba documents in `numba.extending.register_jitable`, leaves out its run-time library, which allocates and counts.
    return njit(cache=True, _nrt=False)(kernel)
