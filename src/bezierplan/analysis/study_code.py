"""The code of a study: metrics, functions and an audit of its own (`machine.modules`)."""

from collections.abc import Callable, Iterable
from typing import Any

import pandas as pd

from bezierplan.analysis import drawings
from bezierplan.analysis import metrics as metrics  # whose names no study declares anew
from bezierplan.analysis.audit import rules
from bezierplan.machine.modules import load_module


def name_part(name: str) -> str:
    """Name the part of a study that a module is: `metrics`, `functions` and so on."""
    return name.removesuffix(".py").replace("/", ".").rpartition(".")[2]


def load_functions(code: Iterable[str]) -> dict[str, Callable[..., Any]]:
    """Load the code of a study, so that its metrics are known; return its functions by name, with
    those that every study has.
    """
    for name in code:
        load_module(name)
    return {"marks": drawings.list_marks} | load_part(code, "functions")


def load_audit(code: Iterable[str]) -> Callable[[dict[str, pd.DataFrame]], list[dict]]:
    """Load the audit of a study's printed numbers: its own, or the rules that its file lists."""
    return load_part(code, "audit").get("audit", rules.check_rules)


def load_part(code: Iterable[str], part: str) -> dict[str, Callable[..., Any]]:
    """Load the public functions of a part from a study's code; none if it has no such module."""
    own = [name for name in code if name_part(name) == part]
    return {
        name: value
        for module in map(load_module, own)
        for name, value in vars(module).items()
        if not name.startswith("_")
        and callable(value)
        # Names that a module imports are not its own.
        and getattr(value, "__module__", None) == module.__name__
    }
