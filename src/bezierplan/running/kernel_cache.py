"""Where numba keeps compiled kernels: one folder for each state of the code from which a kernel is compiled. Of several processes that need
the same kernel at the same time, one compiles it, and the others wait for it.

numba finds the class by the name set in `digest.point_numba_cache`.
"""

import fcntl
import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FunctionType
from typing import Any

from numba.core.caching import Cache, IndexDataCacheFile, UserProvidedCacheLocator
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher
from numba.core.types import unliteral

from bezierplan.running import effort
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


# Seconds between two looks at whether another process still compiles, and how long a process waits that holds a lock itself. A kernel calls
# kernels of modules that its own imports, so locks are taken in one order; but a kernel can also be given any function as an argument, and
# then two processes could wait for each other: one of them ends that, and compiles a kernel for the second time.
LOOK = 0.05
PATIENCE = 60.0

_held: list[Path] = []
"""Folders in which this process compiles, each for a kernel of the one before."""


def compile_once(compiled: Callable[[Dispatcher, Any], Any]) -> Callable[[Dispatcher, Any], Any]:
    """numba's method that loads a kernel or compiles and keeps it, for one process at a time where it has to compile."""

    def compile_alone(self: Dispatcher, signature: Any) -> Any:
        with global_compiler_lock:
            cache = self._cache
            ours = isinstance(cache, Cache) and isinstance(cache._impl.locator, KernelCacheLocator)
            if ours and isinstance(signature, tuple):
                # numba would compile a kernel once more for each constant that another kernel passes.
                signature = tuple(map(unliteral, signature))
            if not ours or signature in self.overloads or _is_kept(cache, signature, self.targetctx.codegen()):
                with effort.spending("loading kernels"):
                    return compiled(self, signature)
            with effort.spending("compiling"), _alone(Path(cache.cache_path)):
                return compiled(self, signature)

    return compile_alone


def _is_kept(cache: Cache, signature: Any, codegen: Any) -> bool:
    return cache._index_key(signature, codegen) in cache._cache_file._load_index()


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder of kernels; the operating system releases it if this process is killed.

    Without the lock, kernels are compiled by each process that needs them: on a file system without locks, and after `PATIENCE` seconds.
    """
    if folder in _held:
        yield
        return
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "lock", "w") as lock:
        start = time.monotonic()
        until = start + (PATIENCE if _held else math.inf)
        while not _locked(lock) and time.monotonic() < until:
            time.sleep(LOOK)
        effort.spent["waiting"] += time.monotonic() - start
        _held.append(folder)
        try:
            yield
        finally:
            _held.pop()


def _locked(lock: Any) -> bool:
    """Whether a file is locked now by this process, or cannot be locked at all."""
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


Dispatcher.compile = compile_once(Dispatcher.compile)
