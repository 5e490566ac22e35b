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
    loaded = {name_part(name): load_module(name) for name in code}
    return {"marks": drawings.list_marks} | list_public(loaded.get("functions"))


def load_audit(code: Iterable[str]) -> Callable[[dict[str, pd.DataFrame]], list[dict]]:
    """Load the audit of a study's printed numbers: its own, or the rules that its file lists."""
    own = [name for name in code if name_part(name) == "audit"]
    if own:
        return load_module(own[0]).audit
    return lambda published: rules.check_rules(published) if "rules" in published else []


def load_part(code: list[str]) -> dict[str, Callable[..., Any]]:
    """Load the public functions of a module that a study may have, given as a list of one
    or none.
    """
    return list_public(load_module(code[0]) if code else None)


def list_public(of: Any) -> dict[str, Callable[..., Any]]:
    """List the public functions of a module by name; none for None."""
    return {
        name: value
        for name, value in (vars(of) if of else {}).items()
        if not name.startswith("_")
        and callable(value)
        # Names that a module imports are not its own.
        and getattr(value, "__module__", None) == of.__name__
    }
