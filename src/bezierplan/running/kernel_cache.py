"""Where numba keeps compiled kernels: a folder for each state of the code that a kernel is compiled from.

numba finds the class here by the name that `digest.point_numba_cache` gives it.
"""

from types import FunctionType

from numba.core.caching import UserProvidedCacheLocator

from bezierplan.running.digest import kernel_folder


class KernelCacheLocator(UserProvidedCacheLocator):
    """Keeps a kernel in a folder named by the digest of its module and of all modules of this package that this one imports.

    By itself numba notices an edit in the kernel's own file only, although constants and kernels of other modules are compiled into it; and
    it compiles again after an edit of a comment.
    """

    def __init__(self, py_func: FunctionType, py_file: str) -> None:
        super().__init__(py_func, py_file)
        self._cache_path = str(kernel_folder(py_func.__module__, py_file))
        # Functions inside functions can share a name.
        self._disambiguator = str(self._lineno) if "<locals>" in py_func.__qualname__ else "0"

    def get_source_stamp(self) -> str:
        """What a kept kernel was compiled from: the folder says it all."""
        return self._cache_path

    def get_disambiguator(self) -> str:
        """What tells apart functions of one name."""
        return self._disambiguator
