"""Decorators for kernels, the functions that numba compiles: `compiled`, and `allocation_free` for those that create no arrays."""

from collections.abc import Callable
from typing import Any

from numba import njit

# Kept on disk, and without the entry point that numba adds for callers written in C, which takes about a tenth of the time to compile.
_OPTIONS = {"cache": True, "no_cfunc_wrapper": True}


def compiled(kernel: Callable[..., Any]) -> Callable[..., Any]:
    """`njit` with the options of all kernels."""
    return njit(**_OPTIONS)(kernel)


def allocation_free(kernel: Callable[..., Any]) -> Callable[..., Any]:
    """`compiled` for a kernel that creates no array or list, returns none, and calls only kernels like it.

    Otherwise numba counts the references to every array that is passed to a kernel, with instructions that lock memory: in small kernels
    that takes most of the time, and much of the time to compile them. numba refuses to compile a kernel that creates an array all the same.
    """
    # The flag, which numba documents in `numba.extending.register_jitable`, leaves out its run-time library, which allocates and counts.
    return njit(**_OPTIONS, _nrt=False)(kernel)
