"""Keep compiled kernels of this package in the user's cache, for all clones: one folder for each
state of the code from which a kernel is compiled. If several processes need the same kernel at the
same time, one compiles it, and the others wait for it.

Only functions that `bezierplan.kernels` decorates are kept here. numba's own classes and settings
stay as they are, so other libraries in the same process keep their compiled functions where they
always do.
"""

import contextlib
import fcntl
import gc
import inspect
import logging
import math
import platform
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any, ClassVar

import llvmlite
import numba
from numba.core.caching import (
    CompileResultCacheImpl,
    FunctionCache,
    IndexDataCacheFile,
    NullCache,
    _CacheLocator,
)
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher
from numba.core.types import unliteral

from bezierplan.machine.digest import name_state
from bezierplan.places import find_cache_folder, find_user_cache_folder

_VERSIONS = (platform.python_version(), numba.__version__, llvmlite.__version__)
FOLDERS = [
    find_user_cache_folder() / "-".join(["kernels", *_VERSIONS]),
    find_cache_folder() / "kernels",
]
"""Folders for the compiled kernels of all modules; the first that can be written is used."""
MOST_BYTES = 500_000_000
_DAY = 86_400.0

# Seconds between two looks at whether another process still compiles, and how long a process waits
# that holds a lock itself. A kernel calls kernels of modules that its own imports, so locks are
# taken in one order; but a kernel can also be given any function as an argument, and then two
# processes could wait for each other: one of them then stops waiting, and compiles a kernel for the
# second time.
LOOK = 0.05
PATIENCE = 60.0

# Thresholds of garbage collection while a kernel is compiled: new objects, and collections of new
# ones before older ones are collected. numba makes millions of objects that stay until the end;
# with Python's own thresholds, collections take a tenth of the time.
COLLECTION_THRESHOLDS = (100_000, 10, 10)


class _Locator(_CacheLocator):
    """Keeps a kernel in a folder named after the digest of its module and of all modules of this
    package that it imports.

    By itself, numba notices edits only in the kernel's own file, although constants and kernels of
    other modules are compiled into it; and it recompiles after an edit of a comment.
    """

    def __init__(self, py_func: FunctionType, folder: Path) -> None:
        self._py_file = inspect.getfile(py_func)
        self._folder = folder
        # Nested functions can share a name.
        self._disambiguator = (
            str(py_func.__code__.co_firstlineno) if "<locals>" in py_func.__qualname__ else "0"
        )

    def get_cache_path(self) -> str:
        """Return the folder."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Return what identifies the source of a cached kernel: the folder's name alone, wherever
        the folder lies.
        """
        return self._folder.name

    def get_disambiguator(self) -> str:
        """Return what tells apart functions with the same name."""
        return self._disambiguator


class _File(IndexDataCacheFile):
    """A file of the cache. A damaged one counts as missing, so the kernel is compiled and written
    again; numba would end the process.
    """

    def _load_index(self) -> dict:
        """Read the index, empty if it is damaged."""
        try:
            return super()._load_index()
        except Exception:  # a damaged pickle raises almost anything
            return {}

    def load(self, key: Any) -> Any:
        """Load a kernel, or return None if its file is damaged."""
        try:
            return super().load(key)
        except Exception:
            return None


class _Implementation(CompileResultCacheImpl):
    """The cache's rule for naming a kernel's files, for a folder that is given, in place of one
    that numba looks for.
    """

    def __init__(self, py_func: FunctionType, folder: Path) -> None:
        self._lineno = py_func.__code__.co_firstlineno
        self._locator = _Locator(py_func, folder)
        name = f"{Path(inspect.getfile(py_func)).stem}.{py_func.__qualname__}"
        self._filename_base = self.get_filename_base(name, "")


class KernelCache(FunctionCache):
    """The compiled forms of one kernel, in the folder of its module."""

    def __init__(self, py_func: FunctionType, folder: Path) -> None:
        self._name, self._py_func = repr(py_func), py_func
        self._impl = _Implementation(py_func, folder)
        self._cache_path = str(folder)
        self._cache_file = _File(self._cache_path, self._impl.filename_base, folder.name)
        self.enable()

    def keeps(self, signature: Any, codegen: Any) -> bool:
        """Return whether the kernel is kept for a signature."""
        return self._index_key(signature, codegen) in self._cache_file._load_index()


@cache
def _prepare_folder(folder: Path) -> bool:
    """Make a folder if necessary, and return whether files can be created in it."""
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        # numba's own test: a folder can have the mode of one that can be written, and be none.
        import tempfile

        tempfile.TemporaryFile(dir=folder).close()
        return True
    return False


class Kernel(CPUDispatcher):
    """A compiled function that is kept in this cache. Where no folder can be written, each process
    compiles it.
    """

    locks: ClassVar[list[Path]] = []
    """Folders in which this process compiles, each for a kernel of the one before."""

    def enable_caching(self) -> None:
        """Keep compiled forms of this kernel."""
        state = name_state(self.py_func.__module__, inspect.getfile(self.py_func))
        for folder in FOLDERS:
            if _prepare_folder(folder / state):
                self._cache = KernelCache(self.py_func, folder / state)
                return

    def compile(self, sig: Any) -> Any:
        """Load the kernel, or compile and keep it; only one process at a time compiles it."""
        with global_compiler_lock:
            if isinstance(sig, tuple):
                # numba would compile a kernel once more for each constant that another kernel
                # passes.
                sig = tuple(map(unliteral, sig))
            if isinstance(self._cache, NullCache):
                with _collect_garbage_rarely():
                    return super().compile(sig)
            if sig in self.overloads or self._cache.keeps(sig, self.targetctx.codegen()):
                return super().compile(sig)
            _tell()
            folder = Path(self._cache.cache_path)
            with contextlib.suppress(OSError):  # another process may remove them too
                remove_old(folder.parent, MOST_BYTES)
            with _lock_alone(folder, self.locks), _collect_garbage_rarely():
                return super().compile(sig)


@cache
def remove_old(folder: Path, most: int) -> None:
    """Remove kernels, oldest first, until a folder has at most so many bytes; those of the last day
    stay.
    """
    sizes = {
        state: sum(file.stat().st_size for file in state.iterdir())
        for state in sorted(folder.iterdir(), key=lambda state: state.stat().st_mtime)
    }
    total = sum(sizes.values())
    # What was compiled within a day may be in use by another process.
    for state, size in sizes.items():
        if total > most and time.time() - state.stat().st_mtime > _DAY:
            shutil.rmtree(state, ignore_errors=True)
            total -= size


@cache
def _tell() -> None:
    """Say once why the first calls after an installation take so long."""
    logging.getLogger(__name__).warning("compiling kernels, once: this takes some seconds")


@contextmanager
def _collect_garbage_rarely() -> Iterator[None]:
    """Collect garbage less often in a block."""
    before = gc.get_threshold()
    gc.set_threshold(*COLLECTION_THRESHOLDS)
    try:
        yield
    finally:
        gc.set_threshold(*before)


@contextmanager
def _lock_alone(folder: Path, locks: list[Path]) -> Iterator[None]:
    """Hold the lock of a folder of kernels in a block. The operating system releases it if this
    process is killed.

    locks: folders in which this process compiles, each for a kernel of the one before. On a file
    system without locks, and after `PATIENCE` seconds, the block goes on without the lock: then
    each process that needs a kernel compiles it.
    """
    if folder in locks:
        yield
        return
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "lock", "w") as lock:
        until = time.monotonic() + (PATIENCE if locks else math.inf)
        while not _try_lock(lock) and time.monotonic() < until:
            time.sleep(LOOK)
        locks.append(folder)
        try:
            yield
        finally:
            locks.pop()


def _try_lock(lock: Any) -> bool:
    """Try to lock a file without waiting; return False only if another process holds the lock."""
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True
