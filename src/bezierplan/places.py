"""Locations: this package, the tree of studies and workflow, and the folder of caches."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PACKAGE = Path(__file__).parent
"""The folder of this package."""

CHECKOUT = PACKAGE.parent.name == "src" and (PACKAGE.parents[1] / "config" / "studies").is_dir()
"""True if this package runs from a clone; an installed one holds a copy of the tree."""

TREE = PACKAGE.parents[1] if CHECKOUT else PACKAGE / "tree"
"""The folder with `config`, `workflow`, `profiles` and `docs/outcome`."""

STUDIES = TREE / "config" / "studies"
"""The studies of this project."""

OUTCOME = TREE / "docs" / "outcome"
"""The tables of what many runs say of these studies."""

EXTRA = frozenset(("jinja2", "pyarrow", "seaborn", "snakemake"))
"""Libraries of the extra `workflow`, which run whole studies."""


@contextmanager
def require_extra() -> Iterator[None]:
    """Guard a block that imports libraries of the extra `workflow`. Raises ModuleNotFoundError that
    says how to install them.
    """
    try:
        yield
    except ModuleNotFoundError as missing:
        if missing.name not in EXTRA:
            raise
        raise ModuleNotFoundError(
            f"needs {missing.name}, which is not installed; install it with: pip install "
            "'bezierplan[workflow]'",
            name=missing.name,
        ) from None


# Parts of numpy for processors beyond x86-64-v3, as old and new versions name them.
_LATER_FEATURES = "AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL AVX512_SPR X86_V4"


def find_cache_folder() -> Path:
    """Return the folder for what can be made again: `.cache` in a clone that can be written,
    otherwise the user's cache.
    """
    return TREE / ".cache" if CHECKOUT and os.access(TREE, os.W_OK) else find_user_cache_folder()


def find_user_cache_folder() -> Path:
    """Return the folder that the platform names for a user's caches."""
    usual = "Library/Caches" if sys.platform == "darwin" else ".cache"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / usual) / "bezierplan"


def choose_machine_code() -> None:
    """Let this process and those that it starts use machine code for a whole family of processors
    instead of code for this one, so that kernels can be shared and all last bits are equal.
    """
    flags = Path("/proc/cpuinfo")
    words = flags.read_text(encoding="utf-8").split() if flags.is_file() else []
    # Every processor of the kind x86-64-v3 has these, and older ones lack some.
    is_v3 = {"avx2", "bmi1", "bmi2", "f16c", "fma", "movbe"} <= {*words}
    # numba and numpy read these when they are imported.
    os.environ.setdefault("NUMBA_CPU_NAME", "x86-64-v3" if is_v3 else "generic")
    os.environ.setdefault("NUMBA_CPU_FEATURES", "")
    if is_v3:
        os.environ.setdefault("OPENBLAS_CORETYPE", "Haswell")
        os.environ.setdefault("NPY_DISABLE_CPU_FEATURES", _LATER_FEATURES)


def shorten_path(path: Path) -> str:
    """Return a path relative to the working folder if it lies inside, so that a moved tree still
    finds its results; otherwise unchanged.
    """
    here = os.path.relpath(path)
    return str(path) if here.startswith("..") else here
