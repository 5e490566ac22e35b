"""Where numba keeps compiled kernels: one folder for each state of the code from which a kernel is compiled.

numba finds the class by the name set in `digest.point_numba_cache`.
"""

from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any

from numba.core.caching import IndexDataCacheFile, UserProvidedCacheLocator

from bezierplan.running.digest import kernel_folder


class KernelCacheLocator(UserProvidedCacheLocator):
    """Keeps a kernel in a folder named after the digest of its module and of all modules of this package that it imports.

    By itself, numba notices edits only in the kernel's own file, although constants and kernels of other modules are compiled into it; and
    it recompiles after an edit of a comment.
    """

    def __init__(self, py_func: FunctionType, py_file: str) -> None:
        super().__init__(py_func, py_file)
        self._cache_path = str(kernel_folder(py_func.__module__, py_file))
        # Nested functions can share a name.
        self._disambiguator = str(self._lineno) if "<locals>" in py_func.__qualname__ else "0"

    def get_source_stamp(self) -> str:
        """The source of a cached kernel: the folder's name alone identifies it, wherever the folder lies."""
        return Path(self._cache_path).name

    def get_disambiguator(self) -> str:
        """Distinguishes functions with the same name."""
        return self._disambiguator


def _or_else(read: Callable[..., Any], missing: Callable[[], Any]) -> Callable[..., Any]:
    """A method that reads a file of the cache; a damaged file counts as a missing one, so the kernel is compiled and written again."""

    def read_or_else(self: IndexDataCacheFile, *given: Any) -> Any:
        try:
            return read(self, *given)
        except Exception:  # a damaged pickle raises almost anything
            return missing()

    return read_or_else


# numba ends the process in both cases.
IndexDataCacheFile._load_index = _or_else(IndexDataCacheFile._load_index, dict)
IndexDataCacheFile.load = _or_else(IndexDataCacheFile.load, lambda: None)
