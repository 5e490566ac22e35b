"""Smooth robot paths by genetic algorithms, particle swarms and exact geometry, and the experiments
of five papers on them.

The public names are those of `__all__`; they are imported when they are first used.
"""

from importlib import import_module
from typing import Any

__version__ = "1.0.0"

__all__ = [  # names of `api`, found by `__getattr__`
    "Answer",
    "Circles",
    "Comparison",
    "Grid",
    "Judgement",
    "Path",
    "Polygons",
    "Problem",
    "check",
    "compare",
    "example_map",
    "methods",
    "plan",
    "plan_all",
    "problems",
    "read_map",
    "replay",
    "results",
    "shortest_path",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'bezierplan' has no attribute {name!r}")
    # Not an import statement: no module depends on the public names only because it lies in this
    # package.
    return getattr(import_module("bezierplan.api"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
