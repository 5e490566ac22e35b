"""Decorators for kernels, the functions that numba compiles: `compile_kernel`, `allocation_free`
for those that create no arrays, and `compile_inline` for those that are always part of their
caller.
"""

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit
from numba.core import config

from bezierplan.machine.kernel_cache import Kernel

# Options of `njit` as numba sets them itself, and without the entry point that it adds for callers
# written in C, which takes about a tenth of the time to compile.
_OPTIONS = {"nopython": True, "boundscheck": None, "no_cfunc_wrapper": True}

# A kernel keeps the signature of its function.
K = TypeVar("K", bound=Callable[..., Any])


def compile_kernel(function: K, **options: Any) -> K:
    """Compile a function as `njit` does, with the options of all kernels and some more, and keep it
    in this package's own cache.

    Where numba compiles nothing, return the function itself.
    """
    if config.DISABLE_JIT:
        return function
    kernel = Kernel(function, targetoptions=_OPTIONS | options)
    kernel.enable_caching()
    return kernel


def allocation_free(kernel: K) -> K:
    """Compile a kernel that creates no array or list, returns none, and calls only kernels like it.

    Otherwise numba counts the references to every array that is passed to a kernel, with
    instructions that lock memory: in small kernels that takes most of the time, and much of the
    time to compile them. numba refuses to compile a kernel that creates an array all the same.
    """
    # The flag, which numba documents in `numba.extending.register_jitable`, leaves out its run-time
    # library, which allocates and counts.
    return compile_kernel(kernel, _nrt=False)


def compile_inline(kernel: K) -> K:
    """Compile a kernel as part of each of its callers, and keep it with them."""
    return njit(inline="always")(kernel)
